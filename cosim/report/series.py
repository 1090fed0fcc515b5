"""Columns of a trace in a report: two bytes per point."""

from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.trace.columns import Array

STEPS = 65534
"""Number of steps from the minimum to the maximum; the next number is NaN."""


def scaled(values: Array, log: bool) -> Array:
    """Values in axis coordinates: logarithms of positive values on a logarithmic axis."""
    return np.log10(np.where(values > 0.0, values, np.nan)) if log else values


def packed(values: Array) -> dict[str, Any]:
    """Values as text: 16 bits each between the minimum and the maximum.

    The error is at most 1 / 131068 of their span, which is less than a pixel of any screen.
    """
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    span = high - low or 1.0
    numbers: NDArray[np.uint16] = np.full(len(values), STEPS + 1, np.uint16)
    known = np.isfinite(values)
    numbers[known] = np.round((values[known] - low) / span * STEPS)
    text = base64.b64encode(numbers.astype("<u2").tobytes()).decode()
    return {"low": low, "span": span, "data": text}


def unpacked(entry: dict[str, Any]) -> Array:
    """Values of a text, as in the report script."""
    numbers = np.frombuffer(base64.b64decode(entry["data"]), "<u2").astype(float)
    return np.where(numbers > STEPS, math.nan, entry["low"] + entry["span"] * numbers / STEPS)
