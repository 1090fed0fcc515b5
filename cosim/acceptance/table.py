"""The acceptance table: claim, measured value, limit and result of every criterion."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.table import Table

from cosim.acceptance.runner import Outcomes
from cosim.formatting.verdicts import NOTHING_DEMANDED, cells, columns
from cosim.loop.result import Result
from cosim.metrics.criteria import Verdict
from cosim.show.bar import plain_console
from cosim.show.display import pass_text
from cosim.show.listing import plain_table

BEGINNING = re.compile(rb"scenario\s+claim\s+(paper\s+)?measured\s+limit\s+(result|pass)")
"""Start of a file that holds the table."""
FOLDED = ("claim", "paper")
"""Columns that wrap on a narrow terminal."""
DIGITS = 3
"""Digits of measured values; `cosim run` shows more."""
WIDTH = 160
"""Width of the table in a file, in characters: few claims need two lines."""
COULD_NOT_RUN = "could not run"


def table(outcomes: Outcomes) -> RenderableType:
    """Table of all criteria, and the number that passed."""
    names = columns(verdicts_of(outcomes))
    shown = plain_table("scenario", *names)
    for column in shown.columns:
        column.no_wrap = column.header not in FOLDED
    for name, outcome in outcomes.items():
        if not isinstance(outcome, Result):
            shown.add_row(name, COULD_NOT_RUN)
        elif not outcome.criteria:
            shown.add_row(name, NOTHING_DEMANDED)
        else:
            add(shown, names, name, outcome)
    return Group(shown, closing_line(outcomes))


def add(shown: Table, names: Sequence[str], name: str, result: Result) -> None:
    """Add the criteria of a scenario; the first row has its name."""
    for index, verdict in enumerate(result.criteria):
        *parts, _ = cells(verdict, names, DIGITS)
        shown.add_row("" if index else name, *parts, pass_text(verdict))


def verdicts_of(outcomes: Outcomes) -> list[Verdict]:
    """Verdicts of all scenarios that gave a result."""
    results = [outcome for outcome in outcomes.values() if isinstance(outcome, Result)]
    return [verdict for result in results for verdict in result.criteria]


def closing_line(outcomes: Outcomes) -> str:
    """Return the number of passed criteria, and of scenarios that could not run."""
    verdicts = verdicts_of(outcomes)
    line = f"{sum(verdict.passed for verdict in verdicts)} of {len(verdicts)} criteria passed"
    lost = sum(not isinstance(outcome, Result) for outcome in outcomes.values())
    return line + (f", {lost} of {len(outcomes)} scenarios {COULD_NOT_RUN}" if lost else "")


def text(shown: RenderableType) -> str:
    """Table as plain text for a file."""
    page = io.StringIO()
    plain_console(file=page, width=WIDTH).print(shown)
    return "".join(f"{line.rstrip()}\n" for line in page.getvalue().splitlines())
