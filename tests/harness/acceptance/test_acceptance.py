"""One run of `cosim test` over scenarios that hold, fail, demand nothing, are broken and crash."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import pytest

from cosim.acceptance import junit, runner
from cosim.acceptance.selection import select
from cosim.cli import app
from cosim.errors import CosimError, PlantError, ScenarioError

from ..cli.commands import cosim
from ..conftest import DATA, END, SCENARIO

HELD = """
[[metric]]
name = "settled"
value = "last(plant.x) < 1"
[[criterion]]
id = "end"
claim = "The lag comes near to zero"
paper = "first order"
metric = "end"
minimum = 1e-3
maximum = 0.7
[[criterion]]
id = "settled"
claim = "It settles"
metric = "settled"
equals = true
"""
FAILED = """
[[criterion]]
id = "end"
claim = "The lag ends < 450 nm"
metric = "end"
maximum = 4.5e-7
"""
SLOW = "[controller.parameters]\ngain = 0.97\n"
TEXTS = {
    "lag": SCENARIO + END + HELD + SLOW,
    "lag/short": SCENARIO + END + FAILED + SLOW,
    "lag/broken": SCENARIO.replace("duration", "durration"),
    "lag/free": SCENARIO + END,
    "failing/plant": SCENARIO + END + "[plant.parameters]\nfail_at = 3\n",
}
TABLE = """\
scenario       claim                       paper        measured    limit           result
lag            The lag comes near to zero  first order  607 mm      1 mm .. 700 mm  passed
               It settles                               as claimed                  passed
lag/broken     could not run
lag/free       no criteria
lag/short      The lag ends < 450 nm                    607 mm      <= 450 nm       FAILED
failing/plant  could not run
2 of 3 criteria passed, 2 of 5 scenarios could not run
"""


DRAWN = """\
<?xml version="1.0" encoding="utf-8" standalone="no"?>
<svg xmlns="http://www.w3.org/2000/svg" version="1.1">
 <metadata>
  <rdf:RDF xmlns:dc="http://purl.org/dc/elements/1.1/" xmlns:cc="http://creativecommons.org/ns#" \
xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
   <cc:Work>
    <dc:title>cosim</dc:title>
    <dc:creator>
     <cc:Agent>
      <dc:title>Matplotlib v3.11.2, https://matplotlib.org/</dc:title>
     </cc:Agent>
    </dc:creator>
   </cc:Work>
  </rdf:RDF>
 </metadata>
</svg>
"""
"""Figure of the user."""
EARLIER = '{\n  "loop": "of an earlier run"\n}\n'


@dataclass(frozen=True)
class Acceptance:
    """Results of one call of `cosim test`."""

    done: subprocess.CompletedProcess[str]
    folder: Path


@pytest.fixture(scope="module")
def tested(tmp_path_factory: pytest.TempPathFactory, probe: Path) -> Iterator[Acceptance]:
    """Test all scenarios of a project, where results of an earlier run still lie."""
    folder = tmp_path_factory.mktemp("project")
    shutil.copy(DATA / "probe_plants.py", folder)
    for name, text in TEXTS.items():
        for file, content in ((f"scenarios/{name}.toml", text), (f"out/{name}.json", EARLIER)):
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_text(content)
    arguments = ("lag*", "failing/*", "--out", "out", "--json", "all.json", "--junit", "all.xml")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COSIM_FMU_PATH", str(probe.parent))
        patch.setenv("COSIM_CACHE", str(folder / "cache"))
        patch.chdir(folder)
        yield Acceptance(cosim("test", *arguments), folder)


def test_the_table_shows_every_criterion_and_what_could_not_run(tested: Acceptance) -> None:
    assert tested.done.stdout == TABLE
    assert (tested.folder / "out/acceptance.txt").read_text() == TABLE


def test_what_could_not_run_is_reported_and_stops_no_other(tested: Acceptance) -> None:
    assert tested.done.returncode == 2
    assert "lag: 2 of 2 criteria passed; seed 1, " in tested.done.stderr
    errors = [line for line in tested.done.stderr.splitlines() if line.startswith("error: ")]
    assert len(errors) == 2
    assert errors[0].startswith("error: `lag/broken`: ")
    assert "`loop.durration` is not a known key" in errors[0]
    assert errors[1].startswith("error: `failing/plant`: ")
    assert "failed on request" in errors[1]


def test_results_and_plots_are_those_of_this_run(tested: Acceptance) -> None:
    out = tested.folder / "out"
    written = {file.relative_to(out).as_posix() for file in out.rglob("*") if file.is_file()}
    ran = ("lag", "lag/free", "lag/short")
    plots = {f"{name}.svg" for name in ran}
    assert written == {"acceptance.txt", *plots, *(f"{name}.json" for name in ran)}
    assert json.loads((out / "lag/short.json").read_text())["passed"] is False
    # the next run may write over them
    assert all(runner.places(out, name) for name in ran)


def test_json_holds_one_entry_for_every_scenario(tested: Acceptance) -> None:
    found = json.loads((tested.folder / "all.json").read_text())
    verdicts = {entry["scenario"]: entry["passed"] for entry in found}
    assert verdicts == {
        "lag": True, "lag/broken": False, "lag/free": None, "lag/short": False, "failing/plant": False,
    }  # fmt: skip
    assert [entry["scenario"] for entry in found if "error" in entry] == ["lag/broken", "failing/plant"]


def test_junit_has_a_case_for_every_criterion(tested: Acceptance) -> None:
    root = ElementTree.parse(tested.folder / "all.xml").getroot()
    counts = {
        suite.get("name"): [int(suite.get(key, "")) for key in ("tests", "failures", "errors", "skipped")]
        for suite in root
    }
    assert counts == {
        "lag": [2, 0, 0, 0],
        "lag/broken": [1, 0, 1, 0],
        "lag/free": [1, 0, 0, 1],
        "lag/short": [1, 1, 0, 0],
        "failing/plant": [1, 0, 1, 0],
    }
    failure = root.find("testsuite[@name='lag/short']/testcase[@name='end']/failure")
    assert failure is not None
    assert "limit <= 450 nm" in failure.get("message", "")


@pytest.mark.usefixtures("tested")
@pytest.mark.parametrize(
    ("scenarios", "code"), [(["scenarios/lag.toml", "lag/free"], 0), (["lag", "lag/short"], 1)]
)
def test_exit_codes_are_those_of_run(
    scenarios: list[str], code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["cosim", "test", *scenarios, "-q", "--json", "-"])
    assert app.status_of(app.app) == code
    reported = capsys.readouterr()
    assert reported.err == ""
    assert [entry["scenario"] for entry in json.loads(reported.out)] == [
        name.removeprefix("scenarios/").removesuffix(".toml") for name in scenarios
    ]


@pytest.mark.usefixtures("tested")
def test_scenarios_are_meant_by_name_file_and_pattern() -> None:
    assert select(["lag/*", "lag", "lag/f*"]) == ["lag/broken", "lag/free", "lag/short", "lag"]
    assert select(["x.toml"]) == ["x.toml"]
    assert {*TEXTS, "dob/paper"} < set(select([]))
    with pytest.raises(ScenarioError, match="no scenario matches `lug"):
        select(["lag", "lug*"])


@pytest.mark.usefixtures("tested")
def test_two_files_of_one_name_are_rejected() -> None:
    with pytest.raises(CosimError, match="another file both define the scenario `lag`"):
        runner.run(["lag", "elsewhere/lag.toml"], runner.RunOptions())


@pytest.mark.parametrize(
    ("file", "content", "kind"),
    [
        ("lag.json", '{"color": "of the user"}', "the result of a run"),
        ("lag/free.svg", "a note", "the plot of a run"),
        ("lag.svg", DRAWN, "the plot of a run"),
        ("acceptance.txt", "a note", "an acceptance table"),
    ],
)
@pytest.mark.usefixtures("tested")
def test_no_file_of_the_user_is_written_over(
    file: str,
    content: str,
    kind: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "lag").mkdir()
    earlier = tmp_path / "lag.json"
    earlier.write_text(EARLIER)
    (tmp_path / file).write_text(content)
    before = {place: place.read_text() for place in tmp_path.rglob("*.*")}
    monkeypatch.setattr(sys, "argv", ["cosim", "test", "lag", "lag/free", "--out", str(tmp_path)])
    assert app.status_of(app.app) == 2
    reported = capsys.readouterr().err
    assert f"`{tmp_path / file}` would overwrite a file that is not {kind}" in reported
    assert {place: place.read_text() for place in tmp_path.rglob("*.*")} == before


def test_junit_has_no_control_characters() -> None:
    error = PlantError("\x1b[31mdiverged\x00", "a\x08b")
    root = ElementTree.fromstring(junit.document({"lag": error}).encode())
    (found,) = root.iter("error")
    assert (found.get("message"), found.text) == (
        "\ufffd[31mdiverged\ufffd",
        "\ufffd[31mdiverged\ufffd\nhint: a\ufffdb",
    )
