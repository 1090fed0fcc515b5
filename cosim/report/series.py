"""Columns of a trace in a report: two bytes per point."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.trace.columns import Array

STEPS = 65534
"""Number of steps from the minimum to the maximum; the next number is NaN."""


def packed(values: Array, log: bool = False) -> dict[str, Any]:
    """Values as text: 16 bits each between the minimum and the maximum; logarithms on a logarithmic axis.

    The error is at most 1 / 131068 of their span, which is less than a pixel of any screen.
    """
    if log:
        values = np.log10(np.where(values > 0.0, values, np.nan))
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    span = high - low or 1.0
    numbers: NDArray[np.uint16] = np.full(len(values), STEPS + 1, np.uint16)
    known = np.isfinite(values)
    numbers[known] = np.round((values[known] - low) / span * STEPS)
    text = base64.b64encode(numbers.astype("<u2").tobytes()).decode()
    return {"low": low, "span": span, "data": text}
