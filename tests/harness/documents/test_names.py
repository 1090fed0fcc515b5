"""Names on the commissioning pages are those of the controller."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from handbook.pages import ROOT

from . import words

NAME = re.compile(r"`([A-Za-z_]\w*(?:\.[\w\[\]]+|\[[\d.]+\])*(?:\.\*)?)`")
NUMBER = re.compile(r"(?<=axis)\d+|(?<=\[)\d+(?=\])")
"""Number of an element of a repeated group or of an array."""


def names(text: str) -> set[str]:
    """Names on a page, with N for the number of an element; tables show a group once: `axis1..6.position`."""
    return {NUMBER.sub("N", name) for name in NAME.findall(re.sub(r"\b(axis|\[)\d+\.\.\d+", r"\1N", text))}


COMMISSIONING = [page for page in words.PAGES if page.endswith("doc/commissioning.md")]


@pytest.mark.parametrize("page", COMMISSIONING)
def test_a_page_names_variables_faults_and_items_that_exist(page: str) -> None:
    folder = Path(page).parent
    known = names(words.text(f"{folder}/variables.md")) | names(words.text(f"{folder}/faults.md"))
    unknown = {
        name
        for name in names(words.text(page)) - known
        if not any(other.startswith(name.removesuffix("*")) for other in known if name.endswith(".*"))
    }
    assert unknown == set()


def test_every_controller_has_its_page() -> None:
    crates = {folder.name for folder in ROOT.glob("fmu-*")}
    assert {Path(page).parts[0] for page in COMMISSIONING} == crates
