"""The page that `cargo xtask demo` made, in a browser: small enough, drawn, and without a complaint."""

from __future__ import annotations

import pytest

from handbook.pages import ROOT

from . import browser

PAGE = ROOT / "target/demo/report.html"
LARGEST = 15_000_000
"""Bytes of the page."""
QUESTION = """
(async () => {
  const wait = () => new Promise((go) => setTimeout(go, 50));
  for (let y = 0; y < document.documentElement.scrollHeight; y += 600) { scrollTo(0, y); await wait(); }
  const shown = [...document.images].filter((image) => image.getClientRects().length);
  await Promise.all(shown.map((image) => image.decode()));
  const rows = [...document.querySelectorAll("#table tbody tr")];
  const first = document.querySelector("video").getBoundingClientRect().top + scrollY;
  return {
    cards: document.querySelectorAll(".loop img").length,
    videos: document.querySelectorAll("video[poster]").length,
    rows: rows.filter((row) => !row.hidden).length, soon: first < 9 * innerHeight,
    drawn: document.querySelectorAll(".drawn .plot").length > 50,
    inside: document.documentElement.scrollWidth <= innerWidth,
  };
})()
"""


@pytest.mark.full
@pytest.mark.skipif(not PAGE.is_file(), reason="`cargo xtask demo` has not made it")
def test_the_page_is_small_enough_to_be_sent() -> None:
    assert PAGE.stat().st_size <= LARGEST


@pytest.mark.full
@pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium")
@pytest.mark.skipif(not PAGE.is_file(), reason="`cargo xtask demo` has not made it")
@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", [1400, 400])
def test_the_page_opens(chromium: str, width: int, theme: str) -> None:
    answer, _, troubles = browser.visit(chromium, PAGE, width, theme, QUESTION)
    assert troubles == []
    rows = answer.pop("rows")
    assert 20 < rows < 60
    assert answer == {"cards": 5, "videos": 5, "soon": True, "drawn": True, "inside": True}
