"""Prose about measurements names no number that was measured and is in no table of its page."""

import re

import pytest

from .store import ROOT
from .tables import MARKED, PAGES, told_of_measurements

TABLE = re.compile(r"^\|.*$", re.MULTILINE)
NO_PROSE = re.compile(
    r"```.*?```|<!--.*?-->|`[^`]*`|\]\([^)]*\)|\beq\. \d+(?: to \d+)?|\bFig\. \d+|\b0x\d", re.DOTALL
)
"""Code, marks, addresses, what of a paper is meant, and names of lenses."""
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e\d+)?(?!\d)")
SET = {
    # the paper's times; what a count of jobs is worth; machines, probe and lens that were chosen;
    # limits of tests
    "docs/results.md": "35 42  93 95 96  0.05 0.30 60 264 16 49 230 132.5 0.178 1.1 0.8",
    # what a count of rings is worth, the rings, limits of tests
    "fmu-centering/README.md": "50 93 95 96  0.30 45 0.75 0.7  0.225",
    # a pulse, spreads of the studies, limit of a table; the paper's errors
    "fmu-deburr/README.md": "0.007 24 30 0.03  5.4 4.9",
    # the slide, a quantile
    "fmu-dob/README.md": "10.4 19.4 2e5 99",
    # machines, limits of tests, `limits.disturbance`
    "fmu-fts/README.md": "31 2400 0.003 22 45  0.8  0.21 2.6",
    # advice on a parameter
    "fmu-polish/README.md": "2e3",
    # the year of a source, the slope of a lens
    "plants/README.md": "1991 0.12",
}
"""Numbers of a page's prose that were chosen and not measured, and are in no table of it."""


def untold(page: str, text: str) -> list[str]:
    """Numbers of the prose that no table of the page has and that are none of those that were set."""
    prose = NO_PROSE.sub(" ", TABLE.sub("", MARKED.sub("", told_of_measurements(text))))
    known = {*NUMBER.findall(" ".join(TABLE.findall(text))), *SET[page].split()}
    return [number for number in NUMBER.findall(prose) if number not in known]


@pytest.mark.parametrize("page", SET)
def test_prose_names_no_measured_number_but_those_of_tables(page: str) -> None:
    hint = "hint: put what was measured into a table of `tables.toml`, or what was set into `SET`"
    assert untold(page, (ROOT / page).read_text("utf-8")) == [], hint


def test_all_pages_of_measurements_are_looked_at() -> None:
    assert {page.relative_to(ROOT).as_posix() for page in PAGES} == set(SET)


def test_a_number_that_no_table_has_is_found() -> None:
    page = "fmu-polish/README.md"
    text = "## Measured\n\n| a |\n|---|\n| 5.01 N |\n\n"
    text += "The mean is 5.01 N, `4.7`, the rest 0.37 N; eq. 4 below 2e3.\n\n## Else\n\n9 N\n"
    assert untold(page, text) == ["0.37"]
