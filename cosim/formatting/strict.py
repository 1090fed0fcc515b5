"""Strict JSON, as in every file and `--json` output of this program."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any


def text(content: Any) -> str:
    """Return indented strict JSON with a final newline."""
    return json.dumps(plain(content), indent=2, allow_nan=False) + "\n"


def line(content: Any) -> str:
    """Return one line of strict JSON without newline; types that JSON does not have become text."""
    return json.dumps(plain(content), allow_nan=False, default=str)


def plain(value: Any) -> Any:
    """Return data for strict JSON: `NaN`, `Infinity` and `-Infinity` become texts that `float` reads."""
    if isinstance(value, Mapping):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if not isinstance(value, float) or math.isfinite(value):
        return value
    return "NaN" if math.isnan(value) else ("Infinity" if value > 0 else "-Infinity")
