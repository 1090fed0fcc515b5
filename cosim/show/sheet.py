"""Tables as text, made in one process for the terminal of another."""

from __future__ import annotations

import io
import os
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cosim.show.console import WIDTH_IN_FILES

if TYPE_CHECKING:
    from rich.console import RenderableType


@dataclass(frozen=True)
class Sheet:
    """What stdout is: a terminal or not, and its columns."""

    terminal: bool
    width: int


class TextBuffer(io.StringIO):
    """Text in memory that is written as if it went to a terminal, or not."""

    terminal = False

    def isatty(self) -> bool:
        """Whether it stands for a terminal."""
        return self.terminal


def stdout() -> Sheet:
    """Present stdout."""
    terminal = sys.stdout.isatty()
    try:
        width = os.get_terminal_size(sys.stdout.fileno()).columns
    except (OSError, ValueError):
        width = 0
    return Sheet(terminal, width or WIDTH_IN_FILES)


def rendered(table: RenderableType, sheet: Sheet) -> str:
    """Text of a table; `COLUMNS`, `NO_COLOR` and `FORCE_COLOR` are kept as rich does."""
    from cosim.show.bar import plain_console

    page = TextBuffer()
    page.terminal = sheet.terminal
    width = None if "COLUMNS" in os.environ else sheet.width
    plain_console(file=page, width=width).print(table)
    return page.getvalue()
