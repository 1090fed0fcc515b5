"""The tables on the pages show the stored numbers, and no other table shows measurements."""

import os
import re
from pathlib import Path

import pytest

from .store import FOLDER, ROOT, near
from .tables import MARKED, TABLES, measurements, pages, renewed, text

PAGES = pages()


def named(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_a_page_shows_the_stored_numbers(page: Path) -> None:
    found = page.read_text("utf-8")
    expected = renewed(found)
    if "BLESS" in os.environ:
        page.write_text(expected, "utf-8")
        return
    assert found == expected, (
        "hint: `BLESS=1 pytest tests/acceptance/measured/test_tables.py` renews the page"
    )


def test_every_table_is_on_a_page_and_every_file_belongs_to_a_table() -> None:
    names = {name for page in PAGES for _, name, _ in MARKED.findall(page.read_text("utf-8"))}
    assert names == set(TABLES)
    kept = {row.rpartition("#")[0] or name for name, table in TABLES.items() for row, _ in table["rows"]}
    assert kept == {file.stem for file in FOLDER.glob("*.json")}


@pytest.mark.parametrize("page", [page for page in PAGES if page.parent.name != "plants"], ids=named)
def test_measurements_are_in_no_other_table(page: Path) -> None:
    rest = MARKED.sub("", measurements(page, page.read_text("utf-8")))
    tables = re.findall(r"^\|.*\|\n\|[-| :]+\|\n((?:\|.*\|\n)+)", rest, re.MULTILINE)
    # a measurement has a unit
    cells = [re.sub(r"`[^`]*`|\]\([^)]*\)", "", table) for table in tables]
    assert [found for table in cells for found in re.findall(r"\d[\d.]* (?:um|nm|mm|N|s|h|%)\b", table)] == []


def test_the_tests_that_a_table_names_exist() -> None:
    for table in TABLES.values():
        modules = re.findall(r"-m (tests[\w.]+)", table.get("command", ""))
        files = re.findall(r"tests/\S+", table.get("tests", "")) or [
            f"{module.replace('.', '/')}.py" for module in modules
        ]
        assert files
        assert all((ROOT / file).exists() for file in files)


def test_numbers_are_near_within_a_tenth_and_counts_within_one() -> None:
    assert near(0.2, 0.219)
    assert not near(0.2, 0.223)
    assert near(3.0, 4.0)
    assert not near(3.0, 5.0)
    assert near(float("inf"), float("inf"))
    assert not near(float("inf"), 50.0)


def test_an_infinite_time_is_shown_as_never() -> None:
    assert re.search(r"one push by geometry \| 0 of \d+ \| never \|", text("centering-baselines"))
