"""Output of the commands: tables on stdout; progress, messages and errors on stderr."""

from __future__ import annotations

import contextlib
import io
import logging
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import timedelta
from typing import TYPE_CHECKING

from cosim.errors import readable

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from cosim.loop.reference import Progress

WIDTH_IN_FILES = 132
"""Width of tables that are not on a terminal."""
TENTH, EVERY = 10.0, 60.0
"""Minimum time between two lines of progress after another tenth, and maximum time otherwise, s."""

log = logging.getLogger("cosim")


class ReadableFormatter(logging.Formatter):
    """One line per message, without terminal codes in foreign texts."""

    def format(self, record: logging.LogRecord) -> str:
        """Text of a message, with its level in small letters."""
        lower = logging.makeLogRecord({**vars(record), "levelname": record.levelname.lower()})
        return readable(super().format(lower))


@contextlib.contextmanager
def progress_bar(title: str, quiet: bool) -> Iterator[Progress | None]:
    """Progress bar on stderr; periodic lines if that is not a terminal."""
    from cosim.show.bar import bar

    with bar(quiet, "{task.percentage:>3.0f} %") as shown:
        if shown is None:
            yield None if quiet else ProgressLines(title)
            return
        task = shown.add_task(title)
        yield lambda done, total: shown.update(task, completed=done, total=total)


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
        """Report percentage, elapsed and remaining time, followed by `note`."""
        now = self.clock()
        # what was done before the start says nothing of the speed
        self.before = done if self.before is None else self.before
        tenths = 10 * done // max(1, total)
        waited = now - self.last
        if waited >= EVERY or (waited >= TENTH and tenths > self.tenths):
            self.last, self.tenths = now, tenths
            elapsed, new = now - self.begin, done - self.before
            percent = f"{self.title}: {100 * done // max(1, total)} % after {clock_text(elapsed)}"
            left = f"about {clock_text(elapsed * (total - done) / new)} left" if new else ""
            self.write(", ".join(filter(None, (percent, left, note))))


def clock_text(seconds: float) -> str:
    """Duration as hours, minutes and seconds."""
    return str(timedelta(seconds=round(seconds)))


def output() -> Console:
    """Console on stdout; plain text with `NO_COLOR` and in pipes."""
    from cosim.show.bar import plain_console

    console = plain_console()
    if not console.is_terminal and "COLUMNS" not in os.environ:
        return plain_console(width=WIDTH_IN_FILES)
    return console


@dataclass(frozen=True)
class Sheet:
    """Properties of stdout: terminal or not, width and encoding."""

    terminal: bool
    width: int
    encoding: str = "utf-8"


class TextBuffer(io.StringIO):
    """Text in memory with the properties of a terminal or a file."""

    terminal = False
    encoding = "utf-8"

    def isatty(self) -> bool:
        """Whether it represents a terminal."""
        return self.terminal


def stdout() -> Sheet:
    """Present stdout."""
    terminal = sys.stdout.isatty()
    try:
        width = os.get_terminal_size(sys.stdout.fileno()).columns
    except (OSError, ValueError):
        width = 0
    return Sheet(terminal, width or WIDTH_IN_FILES, sys.stdout.encoding or Sheet.encoding)


def rendered(table: RenderableType, sheet: Sheet) -> str:
    """Text of a table; follows `COLUMNS`, `NO_COLOR` and `FORCE_COLOR`."""
    from cosim.show.bar import plain_console

    buffer = TextBuffer()
    buffer.terminal, buffer.encoding = sheet.terminal, sheet.encoding
    width = None if "COLUMNS" in os.environ else sheet.width
    plain_console(file=buffer, width=width).print(table)
    return buffer.getvalue()


def configure_logging(verbose: bool, quiet: bool) -> None:
    """Log to stderr, one line per message."""
    level = logging.DEBUG if verbose else (logging.ERROR if quiet else logging.WARNING)
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(ReadableFormatter("%(levelname)s: %(message)s"))
    log.handlers[:] = [handler]
    log.setLevel(level)
    log.propagate = False


def report(message: str, hint: str = "") -> None:
    """Print an error and its hint on stderr, never wrapped."""
    lines = [f"error: {readable(message)}", *([f"hint: {readable(hint)}"] if hint else [])]
    # if stderr is full or has no reader, the exit code still reports the error
    with contextlib.suppress(OSError):
        print(*lines, sep="\n", file=sys.stderr)
