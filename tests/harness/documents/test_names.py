"""Names on the pages about one's own machine are those of the controller."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from handbook.pages import ROOT

from . import words

NAME = re.compile(r"`([A-Za-z_]\w*(?:\.[\w\[\]]+|\[[\d.]+\])*(?:\.\*)?)`")


def names(text: str) -> set[str]:
    return set(NAME.findall(text))


@pytest.mark.parametrize(
    "page", [page for page in words.PAGES if re.fullmatch(r"docs/set-up/[a-z]+\.md", page)]
)
def test_a_page_names_variables_faults_and_items_that_exist(page: str) -> None:
    known = names(words.text(f"fmu-{Path(page).stem}/README.md"))
    unknown = {
        name
        for name in names(words.text(page)) - known
        if not any(other.startswith(name.removesuffix("*")) for other in known if name.endswith(".*"))
    }
    assert unknown == set()


def test_every_controller_has_its_page() -> None:
    crates = {folder.name.removeprefix("fmu-") for folder in ROOT.glob("fmu-*")}
    assert {Path(page).stem for page in words.PAGES if page.startswith("docs/set-up/")} == {*crates, "README"}
