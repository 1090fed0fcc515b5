"""The prose of a page about measurements names no measured number that is missing in the tables of the page."""

import re
from pathlib import Path

import pytest

from .store import ROOT
from .tables import MARKED, measurements, pages

TABLE = re.compile(r"^\|.*$", re.MULTILINE)
NO_PROSE = re.compile(
    r"```.*?```|<!--.*?-->|`[^`]*`|\]\([^)]*\)|\beq\. \d+(?: to \d+)?|\bFig\. \d+|\b0x\d", re.DOTALL
)
"""Code, marks, addresses, references to a paper, and names of lenses."""
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e\d+)?(?!\d)")
SET = {
    # times of the paper; confidence limits; machines, probe and lens; limits of tests
    "docs/results.md": "35 42  93 95 96  0.05 0.30 60 264 16 49 230 132.5 0.178 1.1 0.8",
    # confidence limits, rings, limits of tests, times of the paper, machines of the studies
    "docs/results/centering.md": "50 93 95 96  0.05 0.30 0.3 45 0.75 0.7  0.15 0.225 1.1  35 42  28 52 0.9 500 30 15",
    # a pulse, spreads of the studies, limit of a table; errors of the paper
    "docs/results/deburr.md": "0.007 24 30 0.03  5.4 4.9",
    # the slide, a quantile
    "docs/results/dob.md": "10.4 19.4 2e5 99",
    # machines, limits of tests, `limits.disturbance`
    "docs/results/fts.md": "31 2400 0.003 22 45  0.8  0.21 2.6",
    # advice on a parameter
    "docs/results/polish.md": "2e3",
    # the year of a source, the slope of a lens
    "plants/README.md": "1991 0.12",
}
"""Numbers in the prose of a page that were chosen, not measured, and are in no table of the page."""
PAGES = [page for page in pages() if measurements(page, page.read_text("utf-8"))]


def unsupported(page: str, text: str) -> list[str]:
    """Numbers of the prose that no table of the page has and that were not set."""
    prose = NO_PROSE.sub(" ", TABLE.sub("", MARKED.sub("", measurements(ROOT / page, text))))
    known = {*NUMBER.findall(" ".join(TABLE.findall(text))), *SET.get(page, "").split()}
    return [number for number in NUMBER.findall(prose) if number not in known]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_prose_names_only_measured_numbers_of_the_tables(page: Path) -> None:
    hint = "hint: put measured numbers into a table of `tables.toml`, and numbers that were set into `SET`"
    assert unsupported(page.relative_to(ROOT).as_posix(), page.read_text("utf-8")) == [], hint


def test_every_page_with_numbers_that_were_set_exists() -> None:
    assert set(SET) <= {page.relative_to(ROOT).as_posix() for page in PAGES}


def test_a_number_that_no_table_has_is_found() -> None:
    text = "## Measured\n\n| a |\n|---|\n| 5.01 N |\n\n"
    text += "The mean is 5.01 N, `4.7`, the rest 0.37 N; eq. 4 below 2e3.\n\n## Limits\n\n9 N\n"
    assert unsupported("plants/README.md", text) == ["0.37", "2e3"]
