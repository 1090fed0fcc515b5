"""The plant in the README of the plants is one, and the controllers are reported what it says they are."""

import importlib
import math
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import plants

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "plants/README.md").read_text(encoding="utf-8")
CONTROLLERS = {
    "cylindrical_robot": "deburr", "orthogonal_robot": "polish", "rotary_arm": "fts", "slide": "dob",
    "spindle_ring": "centering",
}  # fmt: skip
SECTION = README[README.index("## Nominal values of plants and controllers") :].split("\n## ")[0]
NOMINAL = re.findall(
    r"^\| `(\w+)` \| `(\w+)` \| ([\d.]+) ?(\S*) \| ([\d.]+) ?(\S*) \| (.*) \|$", SECTION, re.MULTILINE
)
"""Rows of the table: plant, parameter, value and unit of both, and the parameter of the controller."""


def nominal(plant: str, variable: str) -> float:
    """Start value in SI of a variable of the controller, from its generated page of variables."""
    page = (ROOT / f"fmu-{CONTROLLERS[plant]}/doc/variables.md").read_text(encoding="utf-8")
    (value,) = re.findall(rf"^\| `{re.escape(variable)}` \| [^|]* \| ([^|]+) \|", page, re.MULTILINE)
    return float(value)


def test_every_plant_differs_from_what_is_reported() -> None:
    assert {row[0] for row in NOMINAL} == set(plants.names()) == set(CONTROLLERS)
    assert len(NOMINAL) == SECTION.count("\n| `")


@pytest.mark.parametrize("row", NOMINAL, ids=lambda row: f"{row[0]}.{row[1]}")
def test_what_is_reported_is_not_what_the_plant_has(row: tuple[str, ...]) -> None:
    plant, parameter, has, unit, other, other_unit, words = row
    (declared,) = (item for item in fields(plants.load(plant).Parameters) if item.name == parameter)
    assert float(has) == declared.default != float(other)
    assert (unit or "1") == (other_unit or "1") == declared.metadata["unit"]
    if words.startswith("`") and words.endswith("`"):
        scale = 2.0 * math.pi if unit == "Hz" else 1.0
        assert nominal(plant, words.strip("`")) == pytest.approx(scale * float(other), rel=1e-3)


def test_drives_of_the_robot_are_configured_without_their_gain() -> None:
    p = plants.load("orthogonal_robot").Parameters()
    for name in ("position_gain", "velocity_bandwidth"):
        assert nominal("orthogonal_robot", f"drive.{name}") == getattr(p, name)


def test_the_torque_of_the_arm_is_configured_without_its_gain() -> None:
    p = plants.load("rotary_arm").Parameters()
    assert nominal("rotary_arm", "servo.inertia") == pytest.approx(p.hub_inertia + p.arm_inertia)


def oscillator(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    section = (ROOT / "plants/doc/new-plant.md").read_text(encoding="utf-8")
    for language, suffix in (("xml", "xml"), ("python", "py")):
        (text,) = re.findall(rf"```{language}\n(.*?)```", section, re.DOTALL)
        (folder / f"oscillator.{suffix}").write_text(text)
    monkeypatch.syspath_prepend(folder)
    return importlib.import_module("oscillator")


def test_the_mass_settles_where_spring_and_force_are_equal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = oscillator(tmp_path, monkeypatch)
    plant = module.Oscillator(module.OscillatorParameters(mass=0.5))
    assert plant.model.body("mass").mass == 0.5
    plant.reset(seed=1, duration=4.0)
    for _ in range(4000):
        plant.sense()
        plant.command(np.array([20.0]))
        plant.advance(10)
    assert plant.sense() == pytest.approx([2e-3], abs=1e-9)
    assert plant.truth() == pytest.approx([0.0], abs=1e-8)
