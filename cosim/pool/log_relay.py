"""Log lines of runs in other processes: logged here with the name of the run, limited in number."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable

MAX_LINES = 20
"""Maximum log lines of one run, and of all runs together, without `-v`."""
HIDDEN = "further log lines are hidden; show all with `-v`"
EVENTS = logging.INFO
"""Log level of FMU events; a log at this level is not limited."""

Line = tuple[str, int, str]
"""Name of a logger, level and text."""
OnLine = Callable[[Line], None]

log = logging.getLogger("cosim")


def report(line: Line, run: str = "") -> None:
    """Log a line of another process, with the name of its run."""
    name, level, text = line
    logging.getLogger(name).log(level, "%s", f"{run}: {text}" if run else text)


class LogRelay:
    """Log of parallel runs: each text once, up to a limit; with `-v` all lines are logged."""

    def __init__(self) -> None:
        self.seen: set[str] = set()
        self.lock = threading.Lock()

    def report(self, run: str, line: Line) -> None:
        """Log a line if the limit permits it."""
        if log.isEnabledFor(EVENTS):
            report(line, run)
            return
        with self.lock:
            if line[2] in self.seen or len(self.seen) > MAX_LINES:
                return
            self.seen.add(line[2])
            if len(self.seen) > MAX_LINES:
                line, run = (log.name, logging.WARNING, HIDDEN), ""
        report(line, run)
