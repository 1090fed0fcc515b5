"""The list of scenarios and its table style; does not import numpy."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text


def scenarios(entries: Iterable[tuple[str, str]]) -> Table:
    """Names and titles of scenarios."""
    rows = ((Text(name, style="bold"), Text(title)) for name, title in entries)
    return plain_table("name", "title", rows=rows)


def plain_table(*names: str, rows: Iterable[Iterable[RenderableType]] = ()) -> Table:
    """Table without lines; its last column takes the remaining width."""
    table = Table(box=None, show_edge=False, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for name in names:
        table.add_column(name, overflow="fold", no_wrap=name == "name")
    for row in rows:
        table.add_row(*row)
    return table
