"""Progress without a terminal: periodic lines on stderr, for nohup, CI and batch queues."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from datetime import timedelta

TENTH, EVERY = 10.0, 60.0
"""Minimum time between two lines after another tenth, and maximum time otherwise, s."""


class ProgressLines:
    """Writes a line after another 10 % or a minute; nothing for short tasks.

    `title` is the start of every line, `clock` returns the time, s.
    """

    def __init__(
        self,
        title: str,
        write: Callable[[str], None] = lambda line: print(line, file=sys.stderr, flush=True),
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.title, self.write, self.clock = title, write, clock
        self.begin = self.last = clock()
        self.tenths = 0
        self.before: int | None = None

    def __call__(self, done: int, total: int, note: str = "") -> None:
        """Report the progress, followed by `note`."""
        now = self.clock()
        # what was done before the start says nothing of the speed
        self.before = done if self.before is None else self.before
        tenths = 10 * done // max(1, total)
        waited = now - self.last
        if waited >= EVERY or (waited >= TENTH and tenths > self.tenths):
            self.last, self.tenths = now, tenths
            self.write(self.line(done, total, now - self.begin) + (f", {note}" if note else ""))

    def line(self, done: int, total: int, elapsed: float) -> str:
        """Percentage, elapsed time and remaining time."""
        line = f"{self.title}: {100 * done // max(1, total)} % after {clock_text(elapsed)}"
        new = done - (self.before or 0)
        return f"{line}, about {clock_text(elapsed * (total - done) / new)} left" if new else line


def clock_text(seconds: float) -> str:
    """Duration as hours, minutes and seconds."""
    return str(timedelta(seconds=round(seconds)))
