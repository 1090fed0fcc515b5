"""The examples on the pages about scenarios and sweeps run."""

from __future__ import annotations

import math
import re
import shutil
import tomllib
from pathlib import Path
from typing import get_args, get_type_hints

import pytest

import cosim
from cosim.metrics.functions import ROWWISE, TIMES, WHOLE
from cosim.scenario import model
from cosim.scenario.injection import INJECTED
from cosim.sweep import study

DOCS = Path(cosim.__file__).parents[1] / "docs"


def text(page: str) -> str:
    return (DOCS / page).read_text("utf-8")


SCENARIO, SWEEPS = text("scenario.md"), text("sweeps.md")
INJECTIONS, EXPRESSIONS = text("scenario/injections.md"), text("scenario/expressions.md")


def blocks(language: str, guide: str = SCENARIO) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", guide, re.DOTALL)


def test_the_scenario_loads_and_shows_every_key(folder: Path) -> None:
    (folder / "readme.toml").write_text(blocks("toml")[0])
    scenario = cosim.load("readme.toml")
    assert scenario.loop.steps == 10_000
    raw = tomllib.loads(blocks("toml")[0])
    assert set(raw["loop"]) == set(model.Loop.__dataclass_fields__)
    assert set(raw["wire"][0]) == (set(model.Wire.__dataclass_fields__) | {"from"}) - {"source"}
    assert set(raw["plot"]) == set(model.Plot.__dataclass_fields__)
    assert set(raw["plot"]["panels"][0]) == set(model.Panel.__dataclass_fields__)


def test_the_scenario_runs(folder: Path) -> None:
    (folder / "readme.toml").write_text(blocks("toml")[0])
    result = cosim.run(cosim.load("readme.toml"), engine="native")
    assert result.trace is not None
    # the controller stops because the example replaces its position by NaN
    assert result.trace["controller.enable"].any()
    assert result.items["controller.fault"]["PositionLost"] in result.trace["controller.fault"]


def test_the_injection_begins_with_its_condition(folder: Path) -> None:
    (fault,) = blocks("toml", INJECTIONS)
    whole = re.sub(r"\[\[inject\]\].*?\n\n", "", blocks("toml")[0], flags=re.DOTALL)
    (folder / "readme.toml").write_text(whole + fault)
    result = cosim.run(cosim.load("readme.toml"), engine="native")
    assert result.injected[0] is not None
    assert all(f"| `{kind} = " in INJECTIONS for kind in INJECTED)


def test_several_fmus_run(folder: Path) -> None:
    (example,) = blocks("toml", text("scenario/several-fmus.md"))
    for name in ("law", "axis"):
        shutil.copy(folder / "probe.fmu", folder / f"{name}.fmu")
    (folder / "several.toml").write_text(example)
    result = cosim.run(cosim.load("several.toml"))
    assert result.trace is not None
    assert result.trace["axis.sum"][-1] == pytest.approx(1.0 - (1.0 - 40.0 * 0.002) ** 100)
    assert set(tomllib.loads(example)["fmu"][0]) | {"step"} == set(model.FmuChoice.__dataclass_fields__) - {
        "alone"
    }


def test_the_study_loads_and_shows_the_keys(folder: Path) -> None:
    (example,) = blocks("toml", SWEEPS)
    (folder / "study.toml").write_text(example)
    found = study.load(folder / "study.toml")
    assert found.design.samples == 200
    shown = tomllib.loads(example)
    for table in ("design", "limits", "traces"):
        known = set(getattr(found, table).__dataclass_fields__)
        assert set(shown[table]) == known - {"file"}, table
    assert set(shown) == set(study.Study.__dataclass_fields__) - {"case", "file"}
    for name in ("points", "integer", "file"):
        assert f"`{name}" in SWEEPS


def test_all_functions_are_listed() -> None:
    for name in [*ROWWISE, *WHOLE, *TIMES]:
        assert re.search(rf"\b{name}\b", EXPRESSIONS), name


def test_all_kinds_of_charts_are_listed() -> None:
    charts = text("scenario/charts.md")
    assert [
        kind for kind in get_args(get_type_hints(model.Chart)["kind"]) if f"\n| `{kind}` |" not in charts
    ] == []


def test_the_study_of_the_tutorial_has_twenty_runs(folder: Path) -> None:
    (example,) = blocks("toml", text("tutorials/first-sweep.md"))
    (folder / "first-sweep.toml").write_text(example)
    found = study.load(folder / "first-sweep.toml")
    assert math.prod(len(vary.values) for vary in found.vary) * found.design.repeats == 20
