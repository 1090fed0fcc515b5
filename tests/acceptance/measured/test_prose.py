"""The prose of a page about measurements has only measured numbers that are in a table of the page."""

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
    # confidence limits, rings, machines, limits of tests
    "docs/results/centering.md": (
        "50 93 95 96  0.05 0.30 0.3 45 0.75 0.7  0.15 0.225 1.1  35 42  28 52 0.9 500 30 15"
    ),
    # a pulse, spreads of the studies, test piece, limits of tables; errors of the paper
    "docs/results/deburr.md": "0.007 24 30 0.03  5.4 4.9  264 8 5 15",
    # the slide, a quantile, limits of tests, the machine of the study
    "docs/results/dob.md": "10.4 19.4 2e5 99  40 1.5 20  0.5 000 0.42 1.2",
    # machines, limits of tests, `limits.disturbance`, lens, torque of the path
    "docs/results/fts.md": (
        "31 2400 0.003 22 45  0.8  0.21 2.6  132.5 0.02 50 700 0.4 60 2.8 1.4 0.6  "
        "4.5 1.86 8.4 25 250 1500 1528"
    ),
    # advice on a parameter, machine, the paper, limits of tests
    "docs/results/polish.md": "2e3  178 0.2 0.178 15 0.056 4.75 205 60",
    # the year of a source, the slope of a lens, a mold, samples
    "plants/README.md": "1991 0.12  7 100",
}
"""Numbers in the prose of a page that were chosen, not measured, and are in no table of the page."""
ONCE = {
    # touches with a limit of the force, on machines with stiff flutes
    "docs/results/dob.md": "97 0.12 0.13 0.10 0.52 64",
    # error at the tool with a slow loop
    "docs/results/fts.md": "0.13",
    # smallest gain with and without the results of the commissioning run
    "docs/results/polish.md": "4.5 3.6",
}
"""Numbers that were measured once and that no test repeats."""
PAGES = [page for page in pages() if measurements(page, page.read_text("utf-8"))]


def unsupported(page: str, text: str) -> list[str]:
    """Numbers of the prose that no table of the page has and that were not set."""
    prose = NO_PROSE.sub(" ", TABLE.sub("", MARKED.sub("", measurements(ROOT / page, text))))
    known = {
        *NUMBER.findall(" ".join(TABLE.findall(text))),
        *SET.get(page, "").split(),
        *ONCE.get(page, "").split(),
    }
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
    assert unsupported("fmu-polish/README.md", text) == ["0.37", "2e3"]
