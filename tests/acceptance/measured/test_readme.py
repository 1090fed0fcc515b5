"""The table of the README shows the stored numbers."""

from __future__ import annotations

import re

import pytest

from .store import ROOT, load

CELLS = {
    "centering": (
        "centering",
        "default, e0 0.1 to 0.6 mm",
        "within 2.5 um after {median:.1f} s at 20 rpm (median)",
    ),
    "deburr": ("deburr-new-robots", "default", "path error {median:.3f} mm on {robots:.0f} robots (median)"),
    "dob": ("dob-depth", "dob", "overtravel {median:.2f} um at 100 um/s (median)"),
    "fts": ("fts", "fts", "tracking error {rms:.2f} um rms"),
    "polish": ("polish", "polish", "{force_mean:.2f} N, standard deviation {force_std:.3f} N"),
}
"""For each controller the table and the row of its numbers, and the text of its cell."""


def shown() -> dict[str, str]:
    """Last cell of each controller in the README."""
    page = (ROOT / "README.md").read_text("utf-8")
    rows = re.findall(r"^\| !\[.*?\[`fmu-(\w+)`\].*\| (.+) \|$", page, re.MULTILINE)
    return dict(rows)


def test_the_readme_has_a_row_for_each_controller() -> None:
    assert shown().keys() == CELLS.keys()


@pytest.mark.parametrize("controller", CELLS)
def test_a_row_of_the_readme_shows_the_stored_numbers(controller: str) -> None:
    table, row, text = CELLS[controller]
    assert shown()[controller] == text.format(**load(table)[row])
