"""The examples of the guides to scenarios and sweeps are true."""

from __future__ import annotations

import re
import shutil
import tomllib
from pathlib import Path

import pytest

import cosim
from cosim.metrics.functions import ROWWISE, TIMES, WHOLE
from cosim.scenario import model
from cosim.scenario.injection import INJECTED
from cosim.sweep import study

DOCS = Path(cosim.__file__).parents[1] / "docs"
SCENARIO, SWEEPS = ((DOCS / name).read_text("utf-8") for name in ("scenario.md", "sweeps.md"))


def blocks(language: str, guide: str = SCENARIO) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", guide, re.DOTALL)


def test_the_scenario_loads_and_shows_every_key(folder: Path) -> None:
    (folder / "readme.toml").write_text(blocks("toml")[0])
    scenario = cosim.load("readme.toml")
    assert scenario.loop.steps == 10_000
    raw = tomllib.loads(blocks("toml")[0])
    assert set(raw["loop"]) == set(model.Loop.__dataclass_fields__)
    shown = set(raw["wire"][0])
    assert shown == {"from", "to", "scale", "offset", "delay", "noise", "quantum", "minimum", "maximum"}
    assert set(raw["plot"]) == set(model.Plot.__dataclass_fields__)
    assert set(raw["plot"]["panels"][0]) == set(model.Panel.__dataclass_fields__)


def test_the_scenario_runs(folder: Path) -> None:
    (folder / "readme.toml").write_text(blocks("toml")[0])
    result = cosim.run(cosim.load("readme.toml"), engine="native")
    assert result.trace is not None
    # the input that the example replaces for a moment is what stops the controller
    assert result.trace["controller.enable"].any()
    assert result.items["controller.fault"]["LostReading"] in result.trace["controller.fault"]


def test_the_injection_begins_with_its_condition(folder: Path) -> None:
    (fault,) = [block for block in blocks("toml") if "\nwhen = " in block]
    whole = re.sub(r"\[\[inject\]\].*?\n\n", "", blocks("toml")[0], flags=re.DOTALL)
    (folder / "readme.toml").write_text(whole + fault)
    result = cosim.run(cosim.load("readme.toml"), engine="native")
    assert result.injected[0] is not None
    assert all(f"| `{kind} = " in SCENARIO for kind in INJECTED)


def test_several_fmus_run(folder: Path) -> None:
    (text,) = [block for block in blocks("toml") if "[[fmu]]" in block]
    for name in ("law", "axis"):
        shutil.copy(folder / "probe.fmu", folder / f"{name}.fmu")
    (folder / "several.toml").write_text(text)
    result = cosim.run(cosim.load("several.toml"))
    assert result.trace is not None
    assert result.trace["axis.sum"][-1] == pytest.approx(1.0 - (1.0 - 40.0 * 0.002) ** 100)
    assert set(tomllib.loads(text)["fmu"][0]) | {"step"} == set(model.FmuChoice.__dataclass_fields__) - {
        "alone"
    }


def test_the_study_loads_and_shows_the_keys(folder: Path) -> None:
    (text,) = [block for block in blocks("toml", SWEEPS) if "[design]" in block]
    (folder / "study.toml").write_text(text)
    found = study.load(folder / "study.toml")
    assert study.count(found) == 200
    shown = tomllib.loads(text)
    for table in ("design", "limits", "traces"):
        known = set(getattr(found, table).__dataclass_fields__)
        assert set(shown[table]) == known - {"file"}, table
    assert set(shown) == set(study.Study.__dataclass_fields__) - {"case", "file"}
    for name in ("points", "integer", "file"):
        assert f"`{name}" in SWEEPS


def test_all_functions_are_listed() -> None:
    for name in [*ROWWISE, *WHOLE, *TIMES]:
        assert re.search(rf"\b{name}\b", SCENARIO), name
