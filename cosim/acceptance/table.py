"""The acceptance table: what was claimed, measured and demanded of every scenario, and whether it holds."""

from __future__ import annotations

import io
import re

from rich.console import Group, RenderableType
from rich.table import Table

from cosim.acceptance.runner import Outcomes
from cosim.formatting.verdicts import NOTHING_DEMANDED, row
from cosim.loop.result import Result
from cosim.show.bar import plain_console
from cosim.show.display import pass_text
from cosim.show.listing import plain_table

COLUMNS = ("scenario", "claim", "paper", "measured", "limit", "pass")
BEGINNING = re.compile(rb"\s+".join(map(str.encode, COLUMNS)))
"""How a file that holds the table begins."""
FOLDED = ("claim", "paper")
"""Columns that a narrow terminal shows on several lines."""
DIGITS = 3
"""Digits of what was measured: enough to compare, `cosim run` shows more."""
WIDTH = 160
"""Columns of the table in a file: few claims need two lines."""
COULD_NOT_RUN = "could not run"


def table(outcomes: Outcomes) -> RenderableType:
    """Table of all criteria, and below it how many of them hold."""
    shown = plain_table(*COLUMNS)
    for column in shown.columns:
        column.no_wrap = column.header not in FOLDED
    for name, outcome in outcomes.items():
        if not isinstance(outcome, Result):
            shown.add_row(name, COULD_NOT_RUN)
        elif not outcome.criteria:
            shown.add_row(name, NOTHING_DEMANDED)
        else:
            add(shown, name, outcome)
    return Group(shown, closing_line(outcomes))


def add(shown: Table, name: str, result: Result) -> None:
    """Add the criteria of a scenario, whose name stands once."""
    for index, verdict in enumerate(result.criteria):
        shown.add_row("" if index else name, *row(verdict, DIGITS)[:-1], pass_text(verdict))


def closing_line(outcomes: Outcomes) -> str:
    """How many criteria hold, and how many scenarios could not run."""
    results = [outcome for outcome in outcomes.values() if isinstance(outcome, Result)]
    verdicts = [verdict for result in results for verdict in result.criteria]
    line = f"{sum(verdict.passed for verdict in verdicts)} of {len(verdicts)} criteria hold"
    lost = len(outcomes) - len(results)
    return line + (f", {lost} of {len(outcomes)} scenarios {COULD_NOT_RUN}" if lost else "")


def text(shown: RenderableType) -> str:
    """Table as plain text for a file."""
    page = io.StringIO()
    plain_console(file=page, width=WIDTH).print(shown)
    return "".join(f"{line.rstrip()}\n" for line in page.getvalue().splitlines())
