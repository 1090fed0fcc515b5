"""A progress bar on stderr."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.segment import Segment

from cosim.errors import readable

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import ConsoleOptions, RenderableType
    from rich.progress import Progress, ProgressColumn


class PlainConsole(Console):
    """Console on which foreign texts cannot move the cursor or color the terminal."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Render, with replaced control codes."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else Segment(readable(segment.text), segment.style)


def plain_console(**options: Any) -> Console:
    """Console without markup: `[m/s]` of an FMU is a unit."""
    return PlainConsole(highlight=False, markup=False, emoji=False, **options)


@contextlib.contextmanager
def bar(quiet: bool, *columns: str | ProgressColumn) -> Iterator[Progress | None]:
    """Bar with text or rich columns before the remaining time; None if stderr is not a terminal."""
    console = plain_console(stderr=True)
    if quiet or not console.is_terminal:
        yield None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    own = [TextColumn(column, markup=False) if isinstance(column, str) else column for column in columns]
    parts = (TextColumn("{task.description}", markup=False), BarColumn(), *own, TimeRemainingColumn())
    with Progress(*parts, console=console, transient=True) as shown:
        yield shown
