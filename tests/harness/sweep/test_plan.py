"""The plan of a study before its runs: seeds, hashes of everything that affects numbers, and memory."""

from __future__ import annotations

import json
import sysconfig
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.errors import CosimError
from cosim.study import run_hash
from cosim.sweep import study
from cosim.sweep.plan import Plan

from ..conftest import SCENARIO
from . import studies

Write = Callable[..., Path]
CASES = ["plant.pole = 0.25", "controller.gain = 0.4", "loop.duration = 0.02", 'wire."plant.u".noise = 0.2']


def hashes(folder: Path, text: str) -> list[str]:
    """Hashes of the runs of a study, as another process would find them."""
    for function in (run_hash.digest_of, run_hash.plant_of, run_hash.project):
        function.cache_clear()
    (folder / "study.toml").write_text(text)
    return [run.hash for run in Plan(study.load(folder / "study.toml")).runs]


def test_a_hash_shows_every_value_however_it_came_about(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    found = hashes(folder, studies.case_list(["title = 'other'", *CASES]))
    assert len(set(found)) == len(found)
    seeds = 'seed = 1\nscenario = "lag.toml"\n[design]\nkind = "list"\nseeds = "repeat"\n'
    for case in CASES:
        (varied,) = hashes(folder, f"{seeds}[[case]]\n{case}\n")
        (given,) = hashes(folder, f"{seeds}[[case]]\ntitle = 'other'\n[set]\n{case}\n")
        assert varied == given
    plain = f"{seeds}[[case]]\ntitle = 'other'\n"
    (folder / "study.toml").write_text(f"{seeds}[[case]]\nplant.pole = 0.25\n")
    from_case = hashes(folder, (folder / "study.toml").read_text())
    write(studies.MEASURED + "[plant.parameters]\npole = 0.25\n")
    assert hashes(folder, plain) == from_case
    # a title is nothing that a number depends on
    assert hashes(folder, plain.replace("other", "another")) == from_case


def test_runs_are_the_same_whichever_way_they_are_asked_for(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    (folder / "grid.toml").write_text(studies.GRID)
    runs = Plan(study.load(folder / "grid.toml")).runs
    assert [run.number for run in runs] == list(range(12))
    assert runs[3] == list(runs)[3]
    assert [run.hash for run in runs[2:5]] == [runs.hash(number) for number in (2, 3, 4)]
    assert runs[-1].changes == {"controller.gain": 0.4, "plant.pole": 0.9}
    with pytest.raises(IndexError):
        runs[12]


IMPORTS = ["import helper", "from helper import GAIN", "def late():\n    import helper"]


@pytest.mark.parametrize("number", range(len(IMPORTS)))
def test_a_module_that_a_plant_imports_is_part_of_its_hash(write: Write, folder: Path, number: int) -> None:
    # a name of its own: modules stay imported
    plant = f"helped{number}"
    write(text=SCENARIO.replace("probe_plants:Lag", f"{plant}:Helped"))
    text = f"from probe_plants import Lag\n{IMPORTS[number]}\nclass Helped(Lag): ...\n"
    (folder / f"{plant}.py").write_text(text)
    (folder / "helper.py").write_text("GAIN = 1.0\n")
    study_text = studies.case_list(["plant.pole = 0.25"])
    before = hashes(folder, study_text)
    assert hashes(folder, study_text) == before
    (folder / "helper.py").write_text("GAIN = 100.0\n")
    assert hashes(folder, study_text) != before


@pytest.mark.parametrize("layout", ["installed", "on the path"])
def test_the_package_of_a_plant_is_part_of_its_hash(
    write: Write, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, layout: str
) -> None:
    package = f"mymachine{layout.count(' ')}"
    installed = tmp_path / "elsewhere"
    (installed / package / "parts").mkdir(parents=True)
    for name, text in {
        "__init__": "",
        "plant": "from probe_plants import Lag\nfrom .parts.friction import GAIN\nclass P(Lag): ...\n",
        "parts/friction": "GAIN = 1.0\n",
    }.items():
        (installed / package / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(installed))
    if layout == "installed":
        places = {**sysconfig.get_paths(), "purelib": str(installed)}
        monkeypatch.setattr(sysconfig, "get_paths", lambda: places)
    write(text=SCENARIO.replace("probe_plants:Lag", f"{package}.plant:P"))
    study_text = studies.case_list(["plant.pole = 0.25"])
    before = hashes(folder, study_text)
    assert hashes(folder, study_text) == before
    (installed / package / "parts" / "friction.py").write_text("GAIN = 100.0\n")
    assert hashes(folder, study_text) != before


def test_the_project_as_it_is_is_part_of_every_hash(
    write: Write, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(studies.MEASURED)
    packages = [tmp_path / "plants", tmp_path / "cosim"]
    files = [packages[0] / "_native.so", packages[0] / "bare" / "x.py", packages[1] / "loop" / "y.py"]
    for file in files:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("before")
    monkeypatch.setattr(run_hash, "PROJECT", packages)
    text = studies.case_list(["plant.pole = 0.25"])
    found = [hashes(folder, text)]
    for file in files:
        file.write_text("after")
        found.append(hashes(folder, text))
    assert len({name for (name,) in found}) == 4
    (packages[1] / "show").mkdir()
    (packages[1] / "show" / "bar.py").write_text("shows nothing else")
    assert hashes(folder, text) == found[-1]


def test_a_wrong_value_gives_an_error_with_its_case_however_late_it_comes(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    for wrong, problem in {
        "plant.pole = 9": r"case 30: `plant.pole` is `9.0`, it must be in 0 .. 1",
        "controller.gain = 'x'": r"case 30: `controller.gain` is `'x'`, it must be a number",
        "loop.duration = 0.0505": r"case 30: `loop.duration` .* multiple of `loop.step`",
        "wire.'plant.u'.minimum = nan": r"case 30: `wire.plant.u.minimum` is `nan`, it must be a number",
        "wire.'plant.u'.delay = -1": r"case 30: `wire.plant.u.delay` is `-1` steps",
    }.items():
        cases = [f"plant.pole = 0.{number}" for number in range(10, 40)]
        (folder / "late.toml").write_text(studies.case_list([*cases, wrong, "plant.pole = 8"]))
        with pytest.raises(CosimError, match=problem):
            Plan(study.load(folder / "late.toml"))


def test_a_run_is_repeated_by_the_command_that_is_shown(write: Write, folder: Path) -> None:
    write(studies.MEASURED, name="away/lag.toml")
    for file in ("probe.fmu", "probe_plants.py"):
        (folder / "away" / file).write_bytes((folder / file).read_bytes())
    traces = '\n[traces]\nworst = 1\nfailed = 0\nmetric = "end"\n'
    names = ", ".join(f'"{letter * 60}"' for letter in "ab")
    label = f'vary = [\n    {{key = "controller.label", values = [{names}]}},'
    (folder / "away" / "grid.toml").write_text(studies.GRID.replace("vary = [", label) + traces)
    done = studies.sweep("away/grid.toml", "--out", "there")
    (command,) = [line for line in done.stdout.splitlines() if line.startswith("cosim run ")]
    assert command.startswith("cosim run away/lag.toml ")
    worst = max(studies.rows(folder / "there"), key=lambda row: row["metrics"]["end"])
    assert studies.repeated(command)["metrics"]["end"]["value"] == worst["metrics"]["end"]


def test_a_large_study_is_planned_without_its_runs_in_memory(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    draws = '[[vary]]\nkey = "plant.pole"\nminimum = 0.1\nmaximum = 0.9\n'
    design = 'scenario = "lag.toml"\n[design]\nkind = "monte-carlo"\nsamples = 2000\n'
    (folder / "many.toml").write_text(design + draws)
    plan = Plan(study.load(folder / "many.toml"))
    assert len({run.hash for run in plan.runs}) == 2000
    # one setting serves all runs that differ in parameters only
    assert len(plan.settings) == 1


def test_a_changed_limit_repeats_no_run(write: Write, folder: Path) -> None:
    write(studies.MEASURED.replace("maximum = 1.5", "maximum = 9.0"))
    (folder / "grid.toml").write_text(studies.GRID)
    assert studies.sweep("grid.toml").returncode == 0
    before = (folder / "grid.sweep" / "results.jsonl").read_text().splitlines()
    write(studies.MEASURED.replace("maximum = 1.5", "maximum = 1.0"))
    done = studies.sweep("grid.toml")
    rows = studies.rows(folder / "grid.sweep")
    held = [row["metrics"]["end"] <= 1.0 for row in rows]
    assert 0 < sum(held) < 12
    assert [row["criteria"] for row in rows] == [{"end": passed} for passed in held]
    assert [row["status"] for row in rows] == ["passed" if passed else "failed" for passed in held]
    assert [row["reason"] for row in rows] == ["" if passed else "end" for passed in held]
    assert done.returncode == 1
    assert f"{sum(held)} passed" in done.stdout
    # the same runs: their times did not change either
    old = {row["hash"]: row["wall_s"] for row in map(json.loads, before)}
    assert old == {row["hash"]: row["wall_s"] for row in rows}
    file = folder / "grid.sweep" / "results.jsonl"
    assert len(file.read_text().splitlines()) == 12 + 12 - sum(held)
    # a metric that no row holds is another matter
    write(studies.MEASURED.replace("last(plant.x) +", "2 * last(plant.x) +"))
    studies.sweep("grid.toml")
    assert len(studies.rows(folder / "grid.sweep")) == 24


def test_a_unit_that_does_not_fit_ends_the_sweep_and_costs_no_run(write: Write, folder: Path) -> None:
    write(studies.MEASURED.replace("maximum = 1.5", 'maximum = 1.5\nunit = "s"'))
    (folder / "grid.toml").write_text(studies.GRID)
    done = studies.sweep("grid.toml")
    assert (done.returncode, done.stdout) == (2, "")
    assert "`criterion.end.unit` is `s`, `metric.end` is in `m`" in done.stderr
    assert not (folder / "grid.sweep" / "results.jsonl").read_text()


def test_criteria_may_vary_and_share_a_run(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    cases = [f"criterion.end.maximum = {limit}" for limit in (-9.0, 9.0)]
    (folder / "list.toml").write_text(studies.case_list(cases).replace("[limits]", 'seeds = "repeat"\n'))
    result = cosim.sweep("list.toml", workers=1)
    assert [(row["set"], row["status"]) for row in result.rows] == [
        ({"criterion.end.maximum": -9.0}, "failed"),
        ({"criterion.end.maximum": 9.0}, "passed"),
    ]
    file = folder / "list.sweep" / "results.jsonl"
    assert len(file.read_text().splitlines()) == 1
    cosim.sweep("list.toml", workers=1)
    assert len(file.read_text().splitlines()) == 1
