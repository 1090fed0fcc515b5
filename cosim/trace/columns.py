"""Columns of a trace by name: in memory, or read on access."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Columns = Mapping[str, Array]
"""Columns by name in their order, each of shape (rows,); the time is `time`."""
ROUNDING = 1e-9
"""Tolerance of equal times, as a fraction of a step."""
BUCKETS = 400
"""Number of time intervals; the minimum and maximum of each is shown."""


class Held(dict[str, Array]):
    """Columns in memory: a structured array with one field per column."""

    def __init__(self, table: NDArray[Any]) -> None:
        super().__init__({name: table[name] for name in table.dtype.names or ()})
        self.table = table


class InOrder:
    """Columns by number for expressions, the time first, and values of computed metrics by name.

    Accessed columns stay in memory.
    """

    def __init__(self, columns: Columns, values: dict[str, Any] | None = None) -> None:
        self.columns = columns
        self.names = ["time", *(name for name in columns if name != "time")]
        self.known: dict[str, Array] = {}
        self.values: dict[str, Any] = {} if values is None else values

    def __getitem__(self, index: int) -> Array:
        name = self.names[index]
        if name not in self.known:
            self.known[name] = self.columns[name]
        return self.known[name]

    def kept(self, name: str, evaluate: Callable[[InOrder], Any]) -> Any:
        """Value of a metric, computed once; releases its columns afterwards."""
        if name not in self.values:
            self.values[name] = evaluate(InOrder(self.columns, self.values))
        return self.values[name]


def stepped(values: Array) -> bool:
    """Whether a column is piecewise constant (modes, flags, counters) and must not be interpolated.

    The values are in the unit of the trace: nanometers in m are not integers, those of an axis in nm are.
    """
    known = values[np.isfinite(values)]
    return bool(np.all(known == np.round(known)))


def rounding(times: Array) -> float:
    """Difference below which two times are equal, s."""
    return ROUNDING * float(np.median(np.diff(times))) if len(times) > 1 else 0.0


def interpolated(times: Array, values: Array, at: Array) -> Array:
    """Linear interpolation; exact at the time of a sample within rounding."""
    after = np.clip(np.searchsorted(times, at), 0, len(times) - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(at - times[before] < times[after] - at, times[before], times[after])
    at = np.where(np.abs(at - nearest) <= rounding(times), nearest, at)
    return np.interp(at, times, values)


def structured(table: Array, names: Sequence[str]) -> NDArray[Any]:
    """Make a table, shape (rows, columns), a structured array with a field per column, as FMPy takes it."""
    dtype = np.dtype([(name, np.float64) for name in names])
    return np.ascontiguousarray(table).view(dtype).reshape(len(table))


def whole(columns: Columns) -> NDArray[Any]:
    """Read all columns into one structured array."""
    if isinstance(columns, Held):
        return columns.table
    return structured(np.column_stack(list(columns.values())), list(columns))


def thinned(values: Array, buckets: int = BUCKETS) -> Array:
    """Minimum and maximum of each interval of a column, in their order, so that no peak is lost.

    A short column is unchanged.
    """
    return values[extremes(values, buckets)]


def extremes(values: Array, buckets: int) -> NDArray[np.int64]:
    """Rows of the minimum and maximum of each interval of a column; the first row if all are NaN.

    All rows of a short column.
    """
    if len(values) <= 2 * buckets:
        return np.arange(len(values))
    edges = np.linspace(0, len(values), buckets + 1).astype(int)
    found = np.empty((buckets, 2), dtype=np.int64)
    for i, (begin, end) in enumerate(itertools.pairwise(edges)):
        part = values[begin:end]
        known = np.flatnonzero(np.isfinite(part))
        ends = (known[np.argmin(part[known])], known[np.argmax(part[known])]) if known.size else (0, 0)
        found[i] = begin + min(ends), begin + max(ends)
    return found.ravel()
