"""The table of the clients, at the end of a run that tried some: which client did what with which FMU."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

OUTCOMES = {"passed": "yes", "failed": "FAILED", "error": "FAILED", "skipped": "not here"}
ORDER = ["FAILED", "not here", "yes"]
"""Report the worst of several tests of one kind."""


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Note what a test marked `client(name, what)` tries, where the report of any process carries it."""
    for marker in item.iter_markers("client"):
        parameters = getattr(item, "callspec", None)
        found = {} if parameters is None else parameters.params
        fmu = marker.kwargs.get("fmu") or found.get("fmu") or found.get("loop") or found.get("name")
        item.user_properties.append(("client", [*marker.args, str(fmu).removeprefix("fmu-")]))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Print the table."""
    cells: dict[tuple[str, str], dict[str, str]] = {}
    for outcome, shown in OUTCOMES.items():
        for report in terminalreporter.stats.get(outcome, []):
            for client, what, fmu in tried(report):
                row = cells.setdefault((client, what), {})
                row[fmu] = min(row.get(fmu, shown), shown, key=ORDER.index)
    if cells:
        terminalreporter.section("clients")
        for line in table(cells):
            terminalreporter.write_line(line)


def tried(report: Any) -> Iterable[list[str]]:
    """Return the clients that a report is about: none for a test without the mark."""
    return [reported for name, reported in getattr(report, "user_properties", []) if name == "client"]


def table(cells: dict[tuple[str, str], dict[str, str]]) -> list[str]:
    """Lines of a table with a row for each thing that a client did and a column for each FMU."""
    fmus = sorted({fmu for row in cells.values() for fmu in row})
    lines = [["client", "what it did", *fmus]]
    lines += [[*key, *(row.get(fmu, "") for fmu in fmus)] for key, row in sorted(cells.items())]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    padded = [[cell.ljust(width) for cell, width in zip(line, widths, strict=True)] for line in lines]
    return ["  ".join(line).rstrip() for line in padded]
