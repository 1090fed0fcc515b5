"""The site is built without a warning, has no broken links and needs no network."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest
from lxml import html

import cosim
from cosim.cli.app import app
from handbook.pages import ROOT, paths

from ..report import browser
from . import words

SEARCH = """(async () => {
  const until = async (found) => {
    for (let tries = 0; tries < 200 && !found(); tries++) await new Promise((done) => setTimeout(done, 100));
    return found();
  };
  const button = await until(() => document.querySelector(".md-search__button"));
  button.click();
  const inside = () => document.activeElement?.shadowRoot;
  const field = await until(() => inside()?.querySelector("input"));
  field.value = "repetitive";
  field.dispatchEvent(new Event("input", { bubbles: true }));
  await until(() => inside()?.querySelector("a"));
  return inside().querySelector("a").href;
})()"""

# one process builds the site, in the folder that the command writes
pytestmark = pytest.mark.xdist_group("site")


@pytest.fixture(scope="module")
def site() -> Path:
    """Folder of the new site."""
    shutil.rmtree(ROOT / "target/site", ignore_errors=True)
    line = [sys.executable, "-m", "handbook"]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return ROOT / "target/site"


def places(site: Path) -> dict[str, html.HtmlElement]:
    return {str(file.relative_to(site)): html.parse(file).getroot() for file in site.rglob("*.html")}


def test_every_link_of_the_site_has_a_target(site: Path) -> None:
    pages = places(site)
    anchors = {
        name: {part.get("id") for part in root.iter() if part.get("id")} for name, root in pages.items()
    }
    lost = []
    for name, root in pages.items():
        if name == "404.html":
            continue
        for link in root.xpath("//article//a/@href | //nav//a/@href | //article//img/@src"):
            place, _, anchor = unquote(link).partition("#")
            if ":" in place:
                continue
            target = (site / name).parent.joinpath(place).resolve() if place else site / name
            there = str(target.relative_to(site))
            if not target.is_file() or (anchor and there in anchors and anchor not in anchors[there]):
                lost.append(f"{name}: {link}")
    assert lost == []


def test_nothing_comes_from_a_network(site: Path) -> None:
    for name, root in places(site).items():
        loaded = root.xpath(
            "//script/@src | //link[@rel='stylesheet' or @rel='icon' or @rel='preload']/@href | //img/@src"
        )
        assert [link for link in loaded if link.startswith(("http", "//"))] == [], name


def test_the_generated_pages_are_complete(site: Path) -> None:
    pages = places(site)
    assert len(pages) == len(list(paths(words.NAV))) + 1
    commands = pages["reference/commands.html"].text_content()
    named = {
        command.name or command.callback.__name__ for command in app.registered_commands if command.callback
    }
    assert all(f"cosim {name.split('_')[0]}" in commands for name in named)
    python = pages["reference/python.html"].text_content()
    assert all(f"cosim.{name}" in python for name in cosim.__all__)
    scenario = pages["reference/scenario.html"].text_content()
    assert all(key in scenario for key in ("[[wire]]", "compute_delay", "stop_when", "[[criterion]]"))
    assert "stateDiagram" not in pages["fmu-dob/index.html"].text_content()


@pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium")
@browser.SCREENS
@pytest.mark.parametrize("page", ["index.html", "fmu-dob/index.html", "examples/sweep.html"])
def test_a_browser_shows_a_page_without_an_error(
    chromium: str, site: Path, page: str, width: int, theme: str
) -> None:
    assert browser.complaints(chromium, site / page, width, theme) == []


@pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium")
@pytest.mark.full
@browser.SCREENS
def test_a_browser_shows_every_page_without_an_error(
    chromium: str, site: Path, width: int, theme: str
) -> None:
    # a server shows the page 404, by addresses from its root
    pages = [name for name in places(site) if name != "404.html"]
    found = {name: browser.complaints(chromium, site / name, width, theme) for name in pages}
    assert len(pages) > 40
    assert {name: problems for name, problems in found.items() if problems} == {}


@pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium")
@pytest.mark.full
def test_the_search_finds_a_page_without_a_server(chromium: str, site: Path) -> None:
    answer, _, troubles = browser.visit(chromium, site / "index.html", 1400, "light", SEARCH)
    assert troubles == []
    assert "fmu-deburr/index.html" in answer
