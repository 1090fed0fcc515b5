"""Every fault of a matrix is detected by its name or is harmless, and the page shows the runs."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from . import matrix, page
from .matrix import DONE, Row
from .outcome import FAULT, Runner

ROWS_MIN = 20
"""Minimum number of rows of a matrix."""


def together(name: str) -> pytest.MarkDecorator:
    """Return the mark of tests that share the runs of a controller, so that one process runs them all."""
    return pytest.mark.xdist_group(f"faults-{name}")


NAMES = [pytest.param(name, marks=together(name)) for name in matrix.names()]
ROWS = [
    pytest.param(name, row, id=f"{name}: {row.name}", marks=together(name))
    for name in matrix.names()
    for row in matrix.load(name).rows
]


@pytest.fixture(scope="module")
def runners() -> Iterator[dict[str, Runner]]:
    """Runners by controller; a row runs once for all tests."""
    found = {name: Runner(matrix.load(name)) for name in matrix.names()}
    yield found
    for runner in found.values():
        runner.close()


@pytest.mark.parametrize(("name", "row"), ROWS)
def test_a_fault_is_detected_or_harmless(runners: dict[str, Runner], name: str, row: Row) -> None:
    assert runners[name].outcome(row).problems == ()


def test_each_page_has_its_matrix() -> None:
    assert {file.stem for file in page.FOLDER.glob("*.md")} == set(matrix.names())


@pytest.mark.parametrize("name", matrix.names())
def test_a_matrix_has_enough_rows_with_different_names(name: str) -> None:
    rows = [row.name for row in matrix.load(name).rows]
    assert len(set(rows)) == len(rows) >= ROWS_MIN


@pytest.mark.parametrize("name", NAMES)
def test_each_fault_of_the_controller_is_raised_in_a_row(runners: dict[str, Runner], name: str) -> None:
    runner = runners[name]
    raised = {fault for outcome in runner.outcomes() for fault in outcome.found}
    assert runner.session is not None
    assert set(runner.session.columns[FAULT] or ()) == raised | {DONE}


@pytest.mark.parametrize("name", NAMES)
def test_the_page_shows_the_results_of_the_runs(runners: dict[str, Runner], name: str) -> None:
    found = matrix.load(name)
    now = page.page(name, found, runners[name].outcomes())
    kept = page.file(name).read_text(encoding="utf-8")
    assert page.differences(kept, now) == [], f"`python -m tests.faults {name}` writes the page again"
