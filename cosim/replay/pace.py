"""Which instants of a run are shown, and how fast it goes by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.trace.columns import Array

RATE = 25
"""Pictures in a second."""
NEAR = 0.1
"""Part by which the pace may differ from that of the run and is nearly the same."""
LONGEST = 3600.0
"""Longest time in which a run is shown, s."""


@dataclass(frozen=True)
class Pace:
    """Rows of a trace that are shown one after the other.

    Parameters
    ----------
    rows
        Row of each picture.
    speed
        Simulated time in the time of the show; above 1 it is a time-lapse.
    """

    rows: NDArray[np.intp]
    speed: float

    @property
    def words(self) -> str:
        """How the time of the show is to that of the run."""
        if abs(self.speed - 1.0) < NEAR:
            return "real time" if abs(self.speed - 1.0) < 1e-3 else f"nearly real time: {self.speed:.2f} x"
        if self.speed > 1.0:
            return f"time-lapse: {self.speed:.3g} x faster"
        return f"slow motion: {1.0 / self.speed:.3g} x slower"


def check(seconds: float) -> None:
    """Check the time in which a run is shown.

    Raises
    ------
    CosimError
        It is no time, or more than `LONGEST`.
    """
    if not 0.0 < seconds <= LONGEST:
        raise CosimError(f"`--seconds` is `{seconds:g}`, it must be above 0 and at most {LONGEST:g}")


def pace(times: Array, seconds: float, begin: float | None = None, end: float | None = None) -> Pace:
    """Show the time from `begin` to `end` (s; the whole run) in so many seconds.

    Raises
    ------
    CosimError
        There is nothing of the run in this time, or no time to show it in.
    """
    check(seconds)
    first = float(times[0]) if begin is None else begin
    last = float(times[-1]) if end is None else end
    if not times[0] <= first < last <= times[-1]:
        problem = f"`--from` = `{first:g}` s to `--to` = `{last:g}` s is no part of the run"
        raise CosimError(problem, f"it goes from {times[0]:g} s to {times[-1]:g} s")
    count = max(2, round(RATE * seconds))
    shown = np.linspace(first, last, count)
    # the row that held at that time
    rows = np.searchsorted(times, shown, side="right") - 1
    return Pace(rows, (last - first) / seconds)
