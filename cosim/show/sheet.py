"""Tables as text, rendered in one process for the terminal of another."""

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

    page = TextBuffer()
    page.terminal = sheet.terminal
    page.encoding = sheet.encoding
    width = None if "COLUMNS" in os.environ else sheet.width
    plain_console(file=page, width=width).print(table)
    return page.getvalue()
