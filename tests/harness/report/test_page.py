"""One page of a foreign machine, a broken scenario, a study and a document, taken apart."""

from __future__ import annotations

import base64
import gzip
import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import html

import cosim
from cosim.formatting.verdicts import row
from cosim.report import command as report
from cosim.report.page import library

from ..cli.commands import called
from ..cli.commands import cosim as command
from ..conftest import DATA, END, SCENARIO
from . import browser
from .traces import texts, unpacked

SCRIPT = "<script>document.title = 'taken'</script>"
LAG = (
    SCENARIO.replace('"Lag with a probe"', json.dumps(f"Lag {SCRIPT}"))
    + END
    + """
description = "A lag.\\n\\nIt ends."
[[criterion]]
id = "end"
claim = "it ends <b>near</b> zero"
paper = "first order & more"
metric = "end"
maximum = 0.7
[[criterion]]
id = "far"
claim = "it ends far away"
metric = "end"
minimum = 2.0
[[inject]]
to = "plant.u"
from_time = 0.02
value = 0.0
[[plot.charts]]
title = "Speed over position"
kind = "path"
x = "plant.x"
y = ["derivative(plant.x)"]
names = ["speed"]
[[plot.panels]]
title = "Place"
columns = ["plant.x"]
unit = "mm"
scale = 1e3
"""
)
STUDY = """
scenario = "lag.toml"
[design]
kind = "list"
[[case]]
"controller.gain" = -1.0
[[case]]
"controller.gain" = -2.0
[[charts]]
title = "End over the gain"
kind = "path"
x = "-controller.gain"
y = ["metric.end"]
names = ["end"]
x_label = "gain"
label = "end"
"""
DOCUMENT = f"# Faults of it\n\n| found | how |\n|---|---|\n| one | {SCRIPT} |\n"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory, probe: Path) -> Path:
    """Folder with the page."""
    folder = tmp_path_factory.mktemp("page")
    shutil.copy(probe, folder / "probe.fmu")
    shutil.copy(DATA / "probe_plants.py", folder)
    text = LAG.replace('description = "A lag.\\n\\nIt ends."\n', "")
    (folder / "lag.toml").write_text('description = "A lag.\\n\\nIt ends."\n' + text)
    (folder / "broken.toml").write_text(SCENARIO.replace("duration", "durration"))
    (folder / "study.toml").write_text(STUDY)
    (folder / "faults.md").write_text(DOCUMENT)
    words = ["lag.toml", "broken.toml", "--study", "study.toml", "--document", "faults.md", "-o", "page.html"]
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = command("report", *words, "-q", COSIM_CACHE=str(folder / "cache"))
    assert done.stdout == "wrote page.html\n", done.stderr
    # a scenario could not run, which counts more than a criterion that does not hold
    assert done.returncode == 2
    return folder


@pytest.fixture(scope="module")
def page(made: Path) -> Any:
    return html.fromstring((made / "page.html").read_text())


@pytest.fixture
def result(made: Path, monkeypatch: pytest.MonkeyPatch) -> cosim.Result:
    monkeypatch.chdir(made)
    return cosim.run(cosim.load("lag.toml"))


def cells(table: Any) -> list[list[str]]:
    return [[cell.text_content() for cell in line.findall("td")] for line in table.iter("tr")][1:]


def test_every_claim_is_in_the_table_as_it_was_measured(page: Any, result: cosim.Result) -> None:
    reported = [["lag", *row(verdict, 3)] for verdict in result.criteria]
    assert [line[-1] for line in reported] == ["passed", "FAILED"]
    known = ("prediction", "choice")
    wanted = [[*line[:-1], source, line[-1]] for line, source in zip(reported, known, strict=True)]
    assert cells(page.get_element_by_id("table")) == wanted
    sources = [line.get("data-source") for line in page.get_element_by_id("table").iter("tr")][1:]
    assert sources == ["prediction", "choice"]
    assert "1 of 2 criteria passed" in page.text_content()


def test_what_could_not_run_is_reported(page: Any) -> None:
    (reported,) = page.find_class("error")
    assert "broken could not run: " in reported.text_content()
    assert "durration" in reported.text_content()
    assert "hint: " in reported.text_content()


def test_texts_of_others_are_no_code(page: Any, made: Path) -> None:
    text = (made / "page.html").read_text()
    assert "document.title" in text
    assert SCRIPT not in text
    scripts = [part for part in page.iter("script") if part.get("type") != "text/plain"]
    assert len(scripts) == 1
    assert SCRIPT in page.get_element_by_id("documents").text_content()
    assert SCRIPT in page.get_element_by_id("scenario-0").text_content()


def test_the_page_loads_nothing(page: Any) -> None:
    links = [part.get(name) for part in page.iter() for name in ("src", "href") if part.get(name)]
    assert [link for link in links if not link.startswith(("data:", "#"))] == []
    (style,) = page.iter("style")
    assert not re.search(r"url\(|@import", style.text)


def test_a_page_is_small_next_to_the_library(made: Path) -> None:
    text = (made / "page.html").read_text()
    assert len(text) - len(library()) < 400_000


def test_the_command_gives_the_numbers_again(page: Any, made: Path, result: cosim.Result) -> None:
    (line,) = [code.text for code in page.iter("code") if code.text.startswith("cosim run ")]
    done = command(*line.split()[1:], "--json", "-", "-q", COSIM_CACHE=str(made / "cache"))
    again = json.loads(done.stdout)
    assert {name: entry["value"] for name, entry in again["metrics"].items()} == {
        name: metric.value for name, metric in result.metrics.items()
    }


def test_the_plots_hold_the_trace(page: Any, result: cosim.Result) -> None:
    data = json.loads(gzip.decompress(base64.b64decode(page.get_element_by_id("data").text)))
    ((view,), (chart,)) = data[0]["views"], data[0]["charts"]
    (panel,) = view["panels"]
    (line,) = panel["curves"]
    assert result.trace is not None
    wanted = 1e3 * result.trace["plant.x"]
    assert unpacked(line) == pytest.approx(wanted, abs=np.ptp(wanted) / 1e5)
    assert (panel["unit"], line["name"]) == ("mm", "plant.x")
    assert [each[1] for each in panel["limits"]] == ["end <= 700 mm", "far >= 2 m"]
    speed = unpacked(chart["lines"][0]["y"])
    assert (chart["title"], len(speed)) == ("Speed over position", len(wanted))
    assert view["events"] == [[pytest.approx(0.02), "fault injected: plant.u"]]
    first, second = page.get_element_by_id("scenario-0").find_class("printed")
    assert "Speed over position" in texts(first.get("src"))
    assert {"end <= 700 mm", "time (s), the whole run"} <= set(texts(second.get("src")))
    library = gzip.decompress(base64.b64decode(page.get_element_by_id("library").text))
    assert b"plotly.js" in library[:2000]


def test_a_plant_without_coordinates_has_no_video_and_says_why(page: Any) -> None:
    (note,) = page.find_class("note")
    assert "the plant probe_plants:Lag has no qpos" in note.text_content()


def test_what_does_not_hold_is_reported_first(page: Any) -> None:
    (missed,) = page.find_class("missed")
    reported = missed.text_content()
    assert reported.startswith("lag: it ends far away, ")
    assert reported.endswith("(limit >= 2 m)")
    assert missed.find("a").get("href") == "#scenario-0"


def test_a_study_and_a_document_are_on_the_page(page: Any) -> None:
    sweep = page.get_element_by_id("study-1")
    assert "2 of 2 runs: 2 failed" in sweep.text_content()
    criteria, metrics = (cells(table) for table in sweep.iter("table"))
    assert criteria[1] == ["far", "0 of 2", "it ends far away"]
    assert metrics[0][0] == "end"
    assert "End over the gain" in sweep.text_content()
    # the study is shown with its scenario, and its summary at the top
    assert sweep.getparent().get("id") == "loop-lag"
    (swept,) = page.find_class("summary")
    assert "study 0 of 2 runs pass" in swept.text_content()
    (document,) = page.find_class("document")
    assert [cells(table) for table in document.iter("table")] == [[["one", SCRIPT]]]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("lag.toml", "-o", "page.pdf"), "Use a name that ends in `.html`."),
        (("lag.toml", "-o", "lag.html"), "would overwrite a file that is not an HTML report"),
        (("lag.toml", "--document", "gone.md"), "cannot read `gone.md`"),
        (("lag.toml", "--study", "gone.toml"), "the study file `gone.toml` does not exist"),
        (("lag.toml", "--study", "typo.toml"), "`desing` is not a known key"),
    ],
)
def test_what_cannot_be_written_is_reported_before_a_run(
    words: tuple[str, ...], message: str, folder: Path
) -> None:
    # it would take longer than the test
    (folder / "lag.toml").write_text(SCENARIO.replace("duration = 0.05", "duration = 1e4"))
    (folder / "typo.toml").write_text(STUDY.replace("design", "desing"))
    mine = "<!doctype html>\n<html><head><title>cosim report</title></head></html>"
    (folder / "lag.html").write_text(mine)
    done = command("report", *words, "-q")
    assert done.returncode == 2
    assert message in done.stderr
    assert (folder / "lag.html").read_text() == mine


def test_what_cannot_be_drawn_is_reported_before_the_run(made: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(made)
    (made / "typo.toml").write_text(LAG.replace('columns = ["plant.x"]', 'columns = ["plant.xx"]'))
    for words in (("check",), ("report", "-o", "typo.html")):
        done = called(words[0], "typo.toml", *words[1:], "-q", COSIM_CACHE=str(made / "cache"))
        assert done.returncode == 2
        assert (
            "`typo.toml`: `plot.panels[0].columns` names `plant.xx`, which is not a column of the trace"
            in done.stderr
        )


def test_a_failed_drawing_loses_no_verdict(made: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(made)
    picked = LAG.replace('y = ["derivative(plant.x)"]', 'y = ["plant.x[time > 0.01]"]')
    picked += '\n[plot]\nzoom = "plant.x[time > 0.01] > plant.x"\n'
    (made / "picked.toml").write_text(picked)
    words = ("test", "picked.toml", "--no-plots", "-q", "--out", "picked", "--report", "picked.html")
    done = called(*words, COSIM_CACHE=str(made / "cache"))
    assert done.returncode == 1, done.stderr
    assert json.loads((made / "picked/picked.json").read_text())["passed"] is False
    page = html.fromstring((made / "picked.html").read_text())
    assert [note.text_content()[:47] for note in page.find_class("note")][1:] == [
        "Not plotted: plot.charts Speed over position = ",
        "Not plotted: plot.zoom = first_time(plant.x[tim",
    ]
    (picture,) = page.find_class("printed")
    assert "time (s), the whole run" in texts(picture.get("src"))


@pytest.mark.parametrize("option", ["--out", "--report"])
def test_an_earlier_page_may_be_written_over(made: Path, option: str) -> None:
    report.check(option, made / "page.html")


def test_the_page_is_made_of_the_runs_of_a_test(made: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(made)
    words = ("test", "lag.toml", "--no-plots", "-q")
    cache = {"COSIM_CACHE": str(made / "cache")}
    plain = called(*words, **cache)
    more = ("--report", "tested.html", "--document", "faults.md", "--study", "study.toml", "--out", "out")
    reported = called(*words, *more, **cache)
    assert (reported.returncode, reported.stdout) == (plain.returncode, plain.stdout) == (1, plain.stdout)
    assert (made / "out/acceptance.txt").read_text() == reported.stdout
    page = html.fromstring((made / "tested.html").read_text())
    assert cells(page.get_element_by_id("table"))[0][:2] == ["lag", "it ends <b>near</b> zero"]
    assert page.find_class("document")
    assert "2 of 2 runs: 2 failed" in page.get_element_by_id("study-1").text_content()
    for option, file in (("--document", "faults.md"), ("--study", "study.toml")):
        alone = called(*words, option, file)
        assert (alone.returncode, alone.stdout) == (2, "")
        assert f"`{option}` requires `--report`" in alone.stderr


QUESTION = """
(async () => {
  const wait = () => new Promise((go) => setTimeout(go, 100));
  document.querySelector(".view[data-view]").scrollIntoView();
  for (let n = 0; n < 300 && !document.querySelector(".view[data-view] path.js-line"); n++) await wait();
  const chart = document.querySelector("figure[data-chart]");
  chart.scrollIntoView();
  for (let n = 0; n < 300 && !chart.querySelector("path.js-line"); n++) await wait();
  const found = document.querySelector(".view[data-view] .plot .scatterlayer path.js-line");
  const words = document.forms[0].elements.words;
  words.value = "FAR";
  words.dispatchEvent(new Event("input", { bubbles: true }));
  return {
    line: Boolean(found), chart: Boolean(chart.querySelector("path.js-line")),
    color: getComputedStyle(document.body).backgroundColor, title: document.title,
    shown: document.querySelector("#shown").textContent,
    inside: document.documentElement.scrollWidth <= innerWidth,
  };
})()
"""


PRINTED = """
(() => {
  document.querySelector("#theme").click();
  if (document.documentElement.dataset.theme !== "dark") document.querySelector("#theme").click();
  const shown = (what) => getComputedStyle(document.querySelector(what)).display;
  return {
    color: getComputedStyle(document.body).backgroundColor, plot: shown(".charts"), still: shown(".printed"),
  };
})()
"""


@pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium")
@pytest.mark.parametrize(("width", "theme"), [(1400, "light"), (400, "dark")])
def test_a_browser_draws_it_without_a_complaint(chromium: str, made: Path, width: int, theme: str) -> None:
    page = made / "page.html"
    answer, printed, troubles = browser.visit(chromium, page, width, theme, QUESTION, PRINTED)
    assert troubles == []
    # on paper as in print: light whatever the screen shows, and the still drawing of the page
    assert printed == {"color": "rgb(255, 255, 255)", "plot": "none", "still": "block"}
    paper = {"light": "rgb(255, 255, 255)", "dark": "rgb(20, 24, 29)"}[theme]
    assert answer == {
        "line": True,
        "chart": True,
        "color": paper,
        "title": "Closed-loop results",
        "shown": "1 of 2",
        "inside": True,
    }
