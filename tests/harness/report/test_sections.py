"""Sections of a page: scenarios with their studies and documents, and texts as they are written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import html

from cosim.report import page
from cosim.sweep.summary import Summary, quantities


def section(name: str, *claims: dict[str, Any]) -> dict[str, Any]:
    return {"name": name, "loop": name.partition("/")[0], "claims": list(claims)}


def claim(name: str, number: bool = True, paper: str = "", passed: bool = True) -> dict[str, Any]:
    return {"claim": name, "number": number, "paper": paper, "passed": passed}


def test_a_loop_has_its_scenarios_its_studies_and_its_documents() -> None:
    scenarios = [
        section("lag", claim("a")),
        section("cart", claim("b")),
        section("lag/slow", claim("c", passed=False)),
    ]
    studies = [{"scenario": "cart/heavy", "name": "one"}, {"scenario": "crane", "name": "two"}]
    documents = [
        {"name": "Faults", "loop": "lag", "html": ""},
        {"name": "Others", "loop": "others", "html": ""},
    ]
    found = page.closed_loops(scenarios, studies, documents)
    assert [part.name for part in found] == ["lag", "cart", "crane"]
    lag, cart, crane = found
    assert [one["number"] for one in lag.scenarios] == [0, 2]
    assert [one["name"] for one in lag.documents] == ["Faults"]
    assert (lag.passed, len(lag.claims)) == (1, 2)
    # after the scenarios, as the data of the page
    assert [(one["name"], one["number"], one["index"]) for one in cart.studies] == [("one", 3, 1)]
    assert [(one["name"], one["number"]) for one in crane.studies] == [("two", 4)]
    assert crane.scenarios == cart.documents == []


@pytest.mark.parametrize(
    ("claims", "wanted"),
    [
        ([claim("done", number=False), claim("first"), claim("known", paper="1 um")], "known"),
        ([claim("done", number=False, paper="yes"), claim("first"), claim("second")], "first"),
        ([claim("done", number=False)], None),
    ],
)
def test_a_loop_is_reported_by_a_number_that_a_paper_knows(claims: list[dict[str, Any]], wanted: Any) -> None:
    (part,) = page.closed_loops(
        [section("lag", *claims), section("lag/b", claim("other", paper="x"))], (), ()
    )
    assert (part.headline or {}).get("claim") == wanted


def written(name: str, *claims: dict[str, Any]) -> dict[str, Any]:
    """Section of a run without plots."""
    texts = dict.fromkeys(("title", "command", "simulated", "plant", "verdict", "no_video"), "x")
    empty: dict[str, Any] = {
        key: []
        for key in ("description", "fmus", "metrics", "settings", "injected", "charts", "views", "undrawn")
    }
    reported = {"measured": "2 um", "limit": "<= 3 um", "source": "choice", "origin": "choice"}
    more = {**texts, **empty, "passed": True, "video": "", "picture": "eA==", "drawings": ["", ""]}
    return {**section(name, *({**reported, **claim} for claim in claims)), **more}


def test_a_page_begins_with_cards_and_the_nominal_scenarios() -> None:
    scenarios = [written("lag", claim("a `b`")), written("lag/slow", claim("c")), written("cart", claim("d"))]
    content = html.fromstring(page.text("Title", scenarios))
    cards = content.find_class("loop")
    assert [card.get("href") for card in cards] == ["#loop-lag", "#loop-cart"]
    assert "2 um a b (<= 3 um)" in " ".join(cards[0].text_content().split())
    assert "2 of 2 criteria passed in 2 scenarios" in " ".join(cards[0].text_content().split())
    # the picture is once in the page, in its section
    assert [image.get("data-picture") for card in cards for image in card.iter("img")] == [
        "scenario-0",
        "scenario-2",
    ]
    rows = content.get_element_by_id("table").xpath("tbody/tr")
    assert [(row.get("data-which"), "hidden" in row.attrib) for row in rows] == [
        ("nominal", False), ("", True), ("nominal", False),
    ]  # fmt: skip
    assert content.xpath("//select[@name='which']/option")[0].get("value") == "nominal"
    # variants are a click away
    assert [part.get("id") for part in content.xpath("//details[@class='variants']/details")] == [
        "scenario-1"
    ]
    alone = html.fromstring(page.text("Title", [written("lag", claim("a"))]))
    assert alone.xpath("//select[@name='which']") == []


def test_words_have_code_and_emphasis_and_neither_links_nor_html() -> None:
    reported = page.inline_markdown("`gain` is *large* [here](http://a.b) <b>x</b> and mu_static_max")
    assert reported == (
        "<code>gain</code> is <em>large</em> [here](http://a.b) &lt;b&gt;x&lt;/b&gt; and mu_static_max"
    )


def test_each_cell_of_a_document_shows_its_column(tmp_path: Path) -> None:
    file = tmp_path / "lag.md"
    file.write_text("# Faults\n\n| what | found |\n|---|---|\n| a `b` | c |\n\n| one |\n|---|\n| d |\n")
    found = page.document(file)
    assert (found["name"], found["loop"]) == ("Faults", "lag")
    content = html.fromstring(f"<div>{found['html']}</div>")
    assert [table.get("class") for table in content.iter("table")] == ["cards", "cards"]
    cells = [(cell.get("data-label"), cell.text_content()) for cell in content.iter("td")]
    assert cells == [("what", "a b"), ("found", "c"), ("one", "d")]


def test_a_yes_or_no_has_no_distribution() -> None:
    values = {"found": [0.0, 1.0], "never": [0.0, float("nan")], "depth": [0.0, 1.0], "share": [0.0, 0.5]}
    found = Summary(
        2,
        values={name: np.array(column) for name, column in values.items()},
        units={"found": "1", "never": "", "depth": "m", "share": "1"},
    )
    assert list(quantities(found)) == ["depth", "share"]
