"""Columns that are decimated to the visible resolution."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from cosim.trace.columns import Array

BUCKETS = 400
"""Number of time intervals; the minimum and maximum of each is shown."""


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
