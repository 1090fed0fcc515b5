"""What runs in other processes log: told as if it were logged here, the run in front, and not without end."""

from __future__ import annotations

import logging
import math
import threading
from collections.abc import Callable

MOST = 20
"""Lines that one run, and all runs together, may log unless everything is wanted."""
EVENTS = logging.INFO
"""Level of the events of FMUs; a log that takes them takes everything."""

Line = tuple[str, int, str]
"""Name of a logger, level and text."""
Tell = Callable[[Line], None]

log = logging.getLogger("cosim")


def most() -> float:
    """Lines that one of many runs may log."""
    return math.inf if log.isEnabledFor(EVENTS) else MOST


def tell(line: Line, run: str = "") -> None:
    """Log a line of another process, with the run that it is about."""
    name, level, text = line
    logging.getLogger(name).log(level, "%s", f"{run}: {text}" if run else text)


class Lines:
    """Lines of many runs that are done at the same time: each text once, and the first few of them.

    With `-v` all of them are told.
    """

    def __init__(self) -> None:
        self.seen: set[str] = set()
        self.lock = threading.Lock()

    def tell(self, run: str, line: Line) -> None:
        """Log a line if it is wanted."""
        if log.isEnabledFor(EVENTS):
            tell(line, run)
            return
        with self.lock:
            if line[2] in self.seen or len(self.seen) > MOST:
                return
            self.seen.add(line[2])
            if len(self.seen) > MOST:
                line, run = (log.name, logging.WARNING, "the runs log more than this; `-v` shows all"), ""
        tell(line, run)
