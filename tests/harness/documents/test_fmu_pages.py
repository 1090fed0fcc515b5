"""The pages inside the FMUs on screens."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from handbook.pages import ROOT

from ..report import browser

BROKEN = """(() => {
  const broken = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const text = texts.currentNode;
    if (!text.parentElement.closest("td")) continue;
    // a line may end after a hyphen or a slash
    for (const word of text.data.matchAll(/[^\\s/-]+/g)) {
      const range = document.createRange();
      range.setStart(text, word.index);
      range.setEnd(text, word.index + word[0].length);
      const lines = new Set([...range.getClientRects()].map((part) => Math.round(part.bottom)));
      if (lines.size > 1) broken.push(word[0]);
    }
  }
  return broken;
})()"""

pytestmark = pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium")


@pytest.fixture(scope="module", params=sorted(ROOT.glob("target/fmu/*.fmu")), ids=lambda file: file.stem)
def page(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(request.param) as archive:
        archive.extractall(folder, [name for name in archive.namelist() if name.startswith("documentation/")])
    return folder / "documentation/index.html"


@browser.SCREENS
def test_a_browser_shows_the_page_of_an_fmu_without_a_complaint(
    chromium: str, page: Path, width: int, theme: str
) -> None:
    assert browser.complaints(chromium, page, width, theme) == []


def test_no_word_in_a_table_is_broken(chromium: str, page: Path) -> None:
    broken, _, _ = browser.visit(chromium, page, 1400, "light", BROKEN)
    assert broken == []
