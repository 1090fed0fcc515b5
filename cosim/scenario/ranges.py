"""Ranges of the numbers in a file, as metadata of dataclass fields: what `tables.parse` checks."""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Mapping
from typing import Any

LARGEST = sys.float_info.max
NOT_NAN = {"minimum": -math.inf, "maximum": math.inf, "demand": "be a number"}
FINITE = {"minimum": -LARGEST, "maximum": LARGEST, "demand": "be finite"}
NOT_NEGATIVE = {"minimum": 0.0, "maximum": LARGEST, "demand": "be finite and not negative"}
POSITIVE = {"minimum": math.ulp(0.0), "maximum": LARGEST, "demand": "be positive and finite"}
COUNT = {"minimum": 1, "demand": "be at least 1"}
NOT_NEGATIVE_COUNT = {"minimum": 0, "demand": "not be negative"}


def limited(limits: Mapping[str, Any], default: Any = dataclasses.MISSING, unit: str = "") -> Any:
    """Field of a number with a range and a unit; required without a default."""
    return dataclasses.field(default=default, metadata={**limits, **({"unit": unit} if unit else {})})
