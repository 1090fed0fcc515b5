"""Scenario files: layers, overrides, and every mistake with its message."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim import paths
from cosim.errors import CosimError, ScenarioError
from cosim.warned import once

from .conftest import END, entry

Write = Callable[..., Path]

MEASURED = (
    END
    + entry("metric", name="peak", value="max(plant.x)")
    + entry("criterion", id="small", claim="it gets small", metric="end", maximum=0.7)
    + entry("criterion", id="start", claim="it starts at one", metric="peak", equals=1)
)


def test_a_scenario_is_loaded_with_its_defaults(write: Write) -> None:
    scenario = cosim.load(write(MEASURED))
    assert scenario.name == "lag"
    assert scenario.loop.steps == 50
    assert (scenario.loop.seed, scenario.loop.substeps, scenario.loop.compute_delay) == (1, 1, 1)
    assert [wire.source for wire in scenario.wire] == ["plant.x", "controller.out"]
    assert scenario.criterion[0].maximum == 0.7


def test_a_variant_holds_only_what_differs(write: Write) -> None:
    write(MEASURED)
    variant = """
extends = "lag.toml"
title = "Variant"
[loop]
duration = 0.02
[controller.parameters]
gain = 2.0
[[wire]]
from = "plant.ramp"
to = "controller.in"
[[criterion]]
id = "small"
claim = "even smaller"
metric = "end"
maximum = 0.5
"""
    scenario = cosim.load(write(name="variant.toml", text=variant))
    assert (scenario.title, scenario.loop.duration, scenario.loop.step) == ("Variant", 0.02, 0.001)
    assert [(wire.source, wire.to) for wire in scenario.wire] == [
        ("plant.ramp", "controller.in"),
        ("controller.out", "plant.u"),
    ]
    assert [(criterion.id, criterion.maximum) for criterion in scenario.criterion] == [
        ("small", 0.5),
        ("start", None),
    ]


def test_a_variant_drops_what_it_inherits(write: Write) -> None:
    write(MEASURED)
    text = 'extends = "lag.toml"\ndrop = ["criterion.start", "metric.peak"]\n'
    scenario = cosim.load(write(name="variant.toml", text=text))
    assert [criterion.id for criterion in scenario.criterion] == ["small"]
    assert [metric.name for metric in scenario.metric] == ["end"]
    with pytest.raises(
        ScenarioError,
        match=r"`drop` holds `criterion.strat`, which is not inherited\n.*criterion.start",
    ):
        cosim.load(write(name="wrong.toml", text='extends = "lag.toml"\ndrop = ["criterion.strat"]\n'))


def test_several_injections_at_one_target_are_replaced_together(write: Write) -> None:
    pulse = '[[inject]]\nto = "controller.in"\nfrom_time = {0}\nto_time = {1}\nvalue = 1.0\n'
    write(pulse.format(0.0, 0.01) + pulse.format(0.02, 0.03))
    text = 'extends = "lag.toml"\n' + pulse.format(0.04, 0.05)
    scenario = cosim.load(write(name="variant.toml", text=text))
    assert [entry.from_time for entry in scenario.inject] == [0.04]


def test_names_are_found_in_the_folders(write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(name="scenarios/lag/fast.toml")
    assert cosim.load("lag/fast").name == "lag/fast"
    monkeypatch.chdir("/")
    monkeypatch.setenv("COSIM_SCENARIOS", str(folder / "scenarios"))
    assert cosim.load("lag/fast").name == "lag/fast"
    with pytest.raises(ScenarioError, match="there is no scenario `lag/fats`\nhint: Use `lag/fast`"):
        cosim.load("lag/fats")


@pytest.mark.parametrize("name", ["COSIM_SCENARIOS", "COSIM_FMU_PATH"])
def test_a_folder_that_does_not_exist_is_reported_once(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv(name, os.pathsep.join((str(tmp_path), str(tmp_path / "no"))))
    with once():
        for _ in range(2):
            assert paths.from_env(name) == [tmp_path, tmp_path / "no"]
    expected = f"`{name}` names `{tmp_path / 'no'}`, which is not a folder"
    assert [record.getMessage() for record in caplog.records] == [expected]


def test_overrides_win_and_the_last_one_wins(write: Write) -> None:
    overrides = [
        "loop.duration=0.03",
        "loop.duration=0.01",
        "controller.gain=2",
        "controller.parameters.label=plain text",
        "plant.pole=0.25",
        "wire.controller.in.noise=1e-3",
        "metric.end.value=first(plant.x)",
        "criterion.small.maximum=2",
        "title=Other",
    ]
    scenario = cosim.load(write(MEASURED + "[controller.parameters]\nbias = [1.0, 2.0]\n"), set=overrides)
    assert scenario.loop.duration == 0.01
    assert scenario.controller.parameters == {"bias": [1.0, 2.0], "gain": 2, "label": "plain text"}
    assert scenario.plant.parameters == {"pole": 0.25}
    assert scenario.wire[0].noise == 1e-3
    assert scenario.metric[0].value == "first(plant.x)"
    assert scenario.criterion[0].maximum == 2.0
    assert scenario.title == "Other"


def test_overriding_a_scenario_leaves_other_loads_alone(write: Write) -> None:
    file = write(MEASURED)
    cosim.load(file, set=["wire.controller.in.noise=1"])
    assert cosim.load(file).wire[0].noise is None


def test_parameter_tables_may_be_nested(write: Write) -> None:
    scenario = cosim.load(write("[controller.parameters.observer]\nbandwidth = 1.0\nfast.pole = 2.0\n"))
    assert scenario.controller.parameters == {"observer.bandwidth": 1.0, "observer.fast.pole": 2.0}


WRONG = {
    "unknown key": (
        "[loopp]\nstep = 1",
        r"`lag.toml`: `loopp` is not a known key\nhint: Use `loop`",
    ),
    "number as text": (
        "[plot]\nzoom = 1",
        r"`lag.toml`: `plot.zoom` is `1` \(an integer\), it must be a text",
    ),
    "missing key": ("[[metric]]\nname = 'm'", r"`lag.toml`: `metric.m.value` is missing"),
    "target twice": (
        "[[signal]]\nto = 'controller.in'\ntimes = [0.0]\nvalues = [1.0]",
        r"`signal.controller.in` is given twice, as `wire`",
    ),
    "signal starts late": (
        "[[signal]]\nto = 'controller.count'\ntimes = [1.0]\nvalues = [1]",
        r"times` must start with 0",
    ),
    "signal back in time": (
        "[[signal]]\nto = 'controller.count'\ntimes = [0, 2, 1]\nvalues = [1, 2, 3]",
        "must increase",
    ),
    "signal lengths": (
        "[[signal]]\nto = 'controller.count'\ntimes = [0]\nvalues = [1, 2]",
        "1 `times` and 2 `values`",
    ),
    "empty injection": (
        "[[inject]]\nto = 'controller.in'\nfrom_time = 1\nto_time = 1\nvalue = 0",
        r"`inject.controller.in.to_time` is `1.0` s, it must be later",
    ),
    "no limit": (
        "[[metric]]\nname='m'\nvalue='1'\n[[criterion]]\nid='c'\nclaim=''\nmetric='m'",
        "`criterion.c` has no limit",
    ),
    "unknown metric": (
        "[[criterion]]\nid='c'\nclaim=''\nmetric='m'\nmaximum=1",
        "`criterion.c.metric` is `m`, which is not a metric",
    ),
    "broken TOML": ("x = [1,\n2\n= 3", r"`lag.toml` is not valid TOML: .*line 24.*\nhint: "),
    "not an array": ("[metric]\nname = 'm'", r"`metric` is .* \(a table\), it must be an array"),
}


@pytest.mark.parametrize(("added", "message"), WRONG.values(), ids=WRONG.keys())
def test_a_mistake_in_a_file_names_file_and_key(write: Write, added: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        cosim.load(write(added))


def test_a_mistake_in_an_override_is_found_where_it_is_loaded(write: Write) -> None:
    with pytest.raises(ScenarioError, match=r"`--set loop.dration`: .*\nhint: Use `duration`"):
        cosim.load(write(), set=["loop.dration=1"])


def test_a_circle_of_files_is_rejected(write: Write) -> None:
    write(name="a.toml", text='extends = "b.toml"\n')
    write(name="b.toml", text='extends = "a.toml"\n')
    with pytest.raises(
        ScenarioError, match=r"`extends` = `b.toml` leads back|`extends` = `a.toml` leads back"
    ):
        cosim.load("a.toml")


@pytest.mark.parametrize("override", ["wire.controller.in.from=plant.y", "loop.stop_when=plant.y > 1"])
def test_a_wrong_name_is_found_before_the_run(write: Write, override: str) -> None:
    scenario = cosim.load(write(), set=[override])
    with pytest.raises(CosimError, match=r"(lag\.toml|--set).*`(plant\.)?y`"):
        cosim.run(scenario)
