"""Settings of videos and of the viewer: the shown rows of a run, and their time scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.trace.columns import Array

RATE = 25
"""Pictures in a second."""
NEAR = 0.1
"""Deviation from real time that is shown as nearly real time."""
LONGEST = 3600.0
"""Maximum playback time, s."""


@dataclass(frozen=True)
class ReplayOptions:
    """Settings of a video or of the viewer: size in pixels, playback time and part of the run in s.

    `begin` and `end` are None for the whole run, an empty `camera` is that of `Renderer`. `enlarge` are texts
    `COORDINATE=FACTOR`; without them the enlargement is automatic.
    """

    size: tuple[int, int] = (640, 480)
    seconds: float = 8.0
    begin: float | None = None
    end: float | None = None
    camera: str = ""
    enlarge: tuple[str, ...] = ()


@dataclass(frozen=True)
class TimeScale:
    """Row of each picture, and the ratio of simulated time to playback time (above 1: time-lapse)."""

    rows: NDArray[np.intp]
    speed: float

    @property
    def text(self) -> str:
        """Text of the playback speed."""
        if abs(self.speed - 1.0) < NEAR:
            return "real time" if abs(self.speed - 1.0) < 1e-3 else f"nearly real time: {self.speed:.2f} x"
        if self.speed > 1.0:
            return f"time-lapse: {self.speed:.3g} x faster"
        return f"slow motion: {1.0 / self.speed:.3g} x slower"


def check_seconds(seconds: float) -> None:
    """Check that the playback time is positive and at most `LONGEST`."""
    if not 0.0 < seconds <= LONGEST:
        raise CosimError(f"`--seconds` is `{seconds:g}`, it must be above 0 and at most {LONGEST:g}")


def time_scale(
    times: Array, seconds: float, begin: float | None = None, end: float | None = None
) -> TimeScale:
    """Rows for the time from `begin` to `end` (s; default: the whole run) in a playback time in s."""
    check_seconds(seconds)
    first = float(times[0]) if begin is None else begin
    last = float(times[-1]) if end is None else end
    if not times[0] <= first < last <= times[-1]:
        problem = f"`--from` = `{first:g}` s to `--to` = `{last:g}` s is outside of the run"
        raise CosimError(problem, f"Choose a part of {times[0]:g} s to {times[-1]:g} s.")
    shown = np.linspace(first, last, max(2, round(RATE * seconds)))
    # the row that held at that time
    rows = np.searchsorted(times, shown, side="right") - 1
    return TimeScale(rows, (last - first) / seconds)
