"""Output of the commands: tables on stdout; progress, messages and errors on stderr."""

from __future__ import annotations

import contextlib
import logging
import os
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

from cosim.errors import readable

if TYPE_CHECKING:
    from rich.console import Console

    from cosim.loop.reference import Progress

WIDTH_IN_FILES = 132
"""Width of tables that are not on a terminal."""

log = logging.getLogger("cosim")


class ReadableFormatter(logging.Formatter):
    """One line per message, without terminal codes in foreign texts."""

    def format(self, record: logging.LogRecord) -> str:
        """Text of a message."""
        return readable(super().format(record))


@contextlib.contextmanager
def progress_bar(title: str, quiet: bool) -> Iterator[Progress | None]:
    """Progress bar on stderr; periodic lines if that is not a terminal."""
    from cosim.show.bar import bar
    from cosim.show.lines import ProgressLines

    with bar(quiet, "{task.percentage:>3.0f} %") as shown:
        if shown is None:
            yield None if quiet else ProgressLines(title)
            return
        task = shown.add_task(title)
        yield lambda done, total: shown.update(task, completed=done, total=total)


def output() -> Console:
    """Console on stdout; plain text with `NO_COLOR` and in pipes."""
    from cosim.show.bar import plain_console

    console = plain_console()
    if not console.is_terminal and "COLUMNS" not in os.environ:
        return plain_console(width=WIDTH_IN_FILES)
    return console


def configure_logging(verbose: bool, quiet: bool) -> None:
    """Log to stderr, one line per message."""
    level = logging.DEBUG if verbose else (logging.ERROR if quiet else logging.WARNING)
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(ReadableFormatter("%(levelname)s: %(message)s"))
    for number, name in (
        (logging.DEBUG, "debug"),
        (logging.INFO, "info"),
        (logging.WARNING, "warning"),
        (logging.ERROR, "error"),
    ):
        logging.addLevelName(number, name)
    log.handlers[:] = [handler]
    log.setLevel(level)
    log.propagate = False


def report(message: str, hint: str = "") -> None:
    """Print an error and its hint on stderr, never wrapped."""
    lines = [f"error: {readable(message)}", *([f"hint: {readable(hint)}"] if hint else [])]
    # if stderr is full or has no reader, the exit code still reports the error
    with contextlib.suppress(OSError):
        print(*lines, sep="\n", file=sys.stderr)
