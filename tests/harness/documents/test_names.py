"""Names on the commissioning pages are those of the controller."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from handbook.pages import ROOT

from . import words

NAME = re.compile(r"`([A-Za-z_]\w*(?:\.[\w\[\]]+|\[[\d.]+\])*(?:\.\*)?)`")


def names(text: str) -> set[str]:
    return set(NAME.findall(text))


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
