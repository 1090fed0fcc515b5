"""The acceptance table: claim, measured value, limit and result of every criterion."""

from __future__ import annotations

import io
import re

from rich.console import Group, RenderableType

from cosim.acceptance.runner import Outcomes
from cosim.formatting.verdicts import NOTHING_DEMANDED, cells, columns
from cosim.loop.result import Result
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
    """Table of all criteria, and the number that passed; the first row of a scenario has its name."""
    results = [outcome for outcome in outcomes.values() if isinstance(outcome, Result)]
    verdicts = [verdict for result in results for verdict in result.criteria]
    names = columns(verdicts)
    shown = plain_table("scenario", *names)
    for column in shown.columns:
        column.no_wrap = column.header not in FOLDED
    for name, outcome in outcomes.items():
        if not isinstance(outcome, Result):
            shown.add_row(name, COULD_NOT_RUN)
        elif not outcome.criteria:
            shown.add_row(name, NOTHING_DEMANDED)
        else:
            for index, verdict in enumerate(outcome.criteria):
                *parts, _ = cells(verdict, names, DIGITS)
                shown.add_row("" if index else name, *parts, pass_text(verdict))
    line = f"{sum(verdict.passed for verdict in verdicts)} of {len(verdicts)} criteria passed"
    if lost := len(outcomes) - len(results):
        line += f", {lost} of {len(outcomes)} scenarios {COULD_NOT_RUN}"
    return Group(shown, line)


def text(shown: RenderableType) -> str:
    """Table as plain text for a file."""
    page = io.StringIO()
    plain_console(file=page, width=WIDTH).print(shown)
    return "".join(f"{line.rstrip()}\n" for line in page.getvalue().splitlines())
