"""The tolerance tube around a signal.

A value `v` at time `t` is the value `r(s)` of the reference at some time `s` within `dt` of `t` as closely as
`numpy.isclose` demands: `|v - r(s)| <= atol + rtol |r(s)|`. For `rtol < 1` both ends of that interval,
`r - (atol + rtol |r|)` and `r + (atol + rtol |r|)`, grow with `r`. The hull of the intervals of all `s` in
`[t - dt, t + dt]` is therefore the interval from the lower end at `min r(s)` to the upper end at `max r(s)`.

Between its samples the reference is a straight line, which has its extremes at its ends: minimum and maximum
are those of the samples in the window and of the values at both ends of the window. A signal that is held has
the value at the start of the window and those of the samples in it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.trace.columns import Array, interpolated, rounding


@dataclass(frozen=True)
class Tube:
    """Minimum and maximum of the reference within `dt` of each time, and the permitted distance from them.

    `low` and `high` are NaN where the reference has only NaN, `nan` is true where it has any. `atol` is
    absolute, `rtol` relative to `low` or `high`.
    """

    low: Array
    high: Array
    nan: NDArray[np.bool_]
    atol: float
    rtol: float

    def deviation(self, values: Array) -> Array:
        """Distance of values from `low` .. `high`; infinite if only one side is NaN."""
        with np.errstate(invalid="ignore"):
            # equal infinities are no distance
            below = np.where(values == self.low, 0.0, self.low - values)
            above = np.where(values == self.high, 0.0, values - self.high)
            outside = np.maximum(0.0, np.maximum(below, above))
        absent = np.isnan(values)
        outside = np.where(absent | np.isnan(self.low), np.inf, outside)
        return np.where(absent & self.nan, 0.0, outside)

    def tolerance(self, values: Array) -> Array:
        """Permitted deviation at the end of `low` .. `high` that a value exceeds."""
        return self.width(np.where(values > self.high, self.high, self.low))

    @property
    def walls(self) -> tuple[Array, Array]:
        """Minimum and maximum permitted value."""
        return self.low - self.width(self.low), self.high + self.width(self.high)

    def width(self, values: Array) -> Array:
        """Tolerance at values of the reference."""
        return self.atol + self.rtol * np.where(np.isfinite(values), np.abs(values), 0.0)


def tube(
    times: Array,
    reference: Array,
    at: Array,
    atol: float,
    rtol: float,
    dt: float = 0.0,
    stepped: bool = False,
) -> Tube:
    """Tube around a reference at the times `at`; constant before its first and after its last row.

    `times` ascend. All times and the permitted time shift `dt` are in s. A `stepped` reference is held
    between its samples, not interpolated.
    """
    slack = rounding(times)
    last = np.searchsorted(times, at + dt + slack, side="right")
    ends: list[Array] = []
    if stepped:
        # from the sample that is held at the start of the window
        first = np.maximum(np.searchsorted(times, at - dt + slack, side="right") - 1, 0)
        last = np.maximum(last, first + 1)
    else:
        first = np.searchsorted(times, at - dt - slack, side="left")
        ends = [interpolated(times, reference, at - dt), interpolated(times, reference, at + dt)]
    low = extreme(np.fmin, reference, first, last)
    high = extreme(np.fmax, reference, first, last)
    nan = np.nan_to_num(extreme(np.fmax, np.isnan(reference).astype(np.float64), first, last)) > 0.0
    for end in ends:
        low, high, nan = np.fmin(low, end), np.fmax(high, end), nan | np.isnan(end)
    return Tube(low, high, nan, atol, rtol)


def extreme(function: Callable[..., Array], values: Array, first: Any, last: Any) -> Array:
    """Minimum or maximum of `values[first:last]` for each pair of bounds, NaN if empty.

    Two overlapping intervals whose length is a power of two cover an interval of any length. Their extremes
    follow from those of half the length (sparse table).
    """
    found = np.full(len(first), np.nan)
    length = last - first
    size, level = 1, values
    while np.any(length >= size):
        here = (length >= size) & (length < 2 * size)
        found[here] = function(level[first[here]], level[last[here] - size])
        level = function(level[:-size], level[size:])
        size *= 2
    return found
