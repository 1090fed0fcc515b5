"""Every plant is found by name, and its parameters are documented and checked."""

import math
import re
from dataclasses import fields
from typing import Any

import pytest

import plants

SOURCES = ("paper", "default", "derived", "literature")


@pytest.mark.parametrize("name", plants.names())
def test_it_is_found_by_name(name: str) -> None:
    plant = plants.load(name)
    assert plant.__module__ == f"plants.{name}"
    assert plant().name == name


@pytest.mark.parametrize("name", plants.names())
def test_every_parameter_is_documented(name: str) -> None:
    for item in fields(plants.load(name).Parameters):
        limits = {"options"} if isinstance(item.default, str) else {"minimum", "maximum"}
        assert set(item.metadata) == {"unit", "description", "source", *limits}
        assert item.metadata["unit"]
        assert item.metadata["description"]
        assert re.split("[:;]", item.metadata["source"])[0] in SOURCES


@pytest.mark.parametrize(
    ("name", "changes", "message"),
    [
        ("slide", {"mass": -1.0}, r"`plant.mass`.*`-1` kg.*`0.1` to `1000` kg"),
        ("slide", {"mass": math.nan}, r"`plant.mass`.*`nan` kg"),
        ("slide", {"mass": "10"}, r"`plant.mass`.*`'10'`, expected a number"),
        ("slide", {"mass": True}, r"`plant.mass`.*`True`, expected a number"),
        ("slide", {"workpiece": 1}, r"`plant.workpiece`.*`1`, expected true or false"),
        ("spindle_ring", {"mass": 0.0}, r"`plant.mass`.*: value `0` kg, limit `0.1` to `200` kg"),
        ("spindle_ring", {"spindle_speed": math.inf}, r"`plant.spindle_speed`.*`inf` rad/s"),
        ("spindle_ring", {"bristle": 1}, r"`plant.bristle`.*`1`, expected true or false"),
        (
            "spindle_ring",
            {"feet_radius": 0.06},
            r"`plant.feet_radius`.*`0.06` m, limit `0.05` m\nhint: .*`plant.radius`",
        ),
        ("spindle_ring", {"eccentricity": 0.04}, r"`plant.eccentricity`.*hint: .*`plant.start_distance`"),
        ("spindle_ring", {"probe_at_pusher": 0.03}, r"`plant.probe_at_pusher`.*hint: .*`plant.probe_stroke`"),
        ("spindle_ring", {"form_last": 8.5}, r"`plant.form_last`.*`8.5`, a whole number"),
        (
            "spindle_ring",
            {"form_first": 15.0},
            r"`plant.form_first`.*`15`, limit `14`\nhint: .*`plant.form_last`",
        ),
        ("orthogonal_robot", {"mold": "moon"}, r"`plant.mold`.*`moon`, one of `sphere`, `led`"),
        (
            "orthogonal_robot",
            {"tip_stiffness": 1e6},
            r"`plant.tip_stiffness`.*`1e\+06` N/m.*`10000` to `400000` N/m",
        ),
        ("orthogonal_robot", {"friction": math.nan}, r"`plant.friction`.*`nan` 1"),
        ("orthogonal_robot", {"step_height": 2e-4}, r"`plant.step_width`.*`0.0005` m, limit `0.001"),
        (
            "orthogonal_robot",
            {"contact_stiffness": 1e7, "tip_stiffness": 4e5},
            r"`plant.contact_stiffness`.*`1e\+07` N/m, limit `3e\+06` N/m at .*`timestep` = `0.0001` s",
        ),
        (
            "orthogonal_robot",
            {"contact_impedance": 0.5},
            r"`plant.contact_impedance`.*`0.5`, limit at least `0.8` at .*`timestep` = `0.0001` s",
        ),
        ("rotary_arm", {"arm_length": -1.0}, r"`plant.arm_length`.*`-1` m.*`0.01` to `0.5` m"),
        (
            "rotary_arm",
            {"flexure_frequency": 50.0},
            r"`plant.flexure_frequency`.*`50` Hz.*`100` to `10000` Hz",
        ),
        ("rotary_arm", {"torque_limit": math.nan}, r"`plant.torque_limit`.*`nan` N.m"),
        ("rotary_arm", {"timestep": 1e-3}, r"`plant.timestep`.*`0.001` s.*`1e-06` to `0.0001` s"),
        ("cylindrical_robot", {"teeth": 0.0}, r"`plant.teeth`.*: value `0` 1, limit `1` to `12` 1"),
    ],
)
def test_bad_parameters_are_named(name: str, changes: dict[str, Any], message: str) -> None:
    plant = plants.load(name)
    with pytest.raises(ValueError, match=rf"(?s)^parameter .*of plant `{name}`") as refused:
        plant(plant.Parameters(**changes))
    assert refused.match(f"(?s){message}")
