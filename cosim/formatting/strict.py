"""Strict JSON: what every file and `--json` of this program is."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any


def text(content: Any) -> str:
    """Return lines of strict JSON, for people and programs; the last one ends."""
    return json.dumps(plain(content), indent=2, allow_nan=False) + "\n"


def line(content: Any) -> str:
    """Return one line of strict JSON, without its end; what JSON has no word for (a date) is its text."""
    return json.dumps(plain(content), allow_nan=False, default=str)


def plain(value: Any) -> Any:
    """Return what strict JSON can hold: `NaN`, `Infinity` and `-Infinity` are texts, which `float` reads."""
    if isinstance(value, Mapping):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if not isinstance(value, float) or math.isfinite(value):
        return value
    return "NaN" if math.isnan(value) else ("Infinity" if value > 0 else "-Infinity")
