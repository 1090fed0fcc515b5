"""Plants written by users: found by name, parameters checked."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.errors import PlantError

from .conftest import END, SCENARIO

Write = Callable[..., Path]
ROOT = Path(__file__).resolve().parents[2]

REFUSED = {
    "plant.name=none": r"there is no plant `none`\nhint: .*`module:Class`",
    "plant.name=none:Lag": r"cannot import the plant `none:Lag`: ModuleNotFoundError.*\nhint: ",
    "plant.name=probe_plants:Lg": r"the module `probe_plants` has no class `Lg`\nhint: Use `Lag`",
    "plant.name=probe_plants:Refusing": r"`probe_plants:Refusing` rejected its parameters: pole and label",
    "plant.ploe=1": r"`--set plant.ploe`: `plant.ploe` is not a parameter .*\nhint: Use `pole`",
    "plant.pole=2": r"`--set plant.pole`: `plant.pole` is `2.0`, it must be in 0 .. 1\nhint: List types",
    "plant.pole=nan": r"`plant.pole` is `nan`, it must be in 0 .. 1",
    "plant.pole=high": r"`plant.pole` is `'high'` \(a text\), it must be a number",
    "plant.label=1": r"`plant.label` is `1` \(an integer\), it must be a text",
    "plant.fail_at=0.5": r"`plant.fail_at` is `0.5` \(a number\), it must be an integer",
}


@pytest.mark.parametrize(("override", "message"), REFUSED.items(), ids=REFUSED.keys())
def test_a_wrong_plant_is_explained(write: Write, override: str, message: str) -> None:
    with pytest.raises(PlantError, match=message):
        cosim.run(cosim.load(write(), set=[override]))


def test_a_plant_gets_its_parameters(write: Write) -> None:
    result = cosim.run(cosim.load(write(), set=["plant.pole=0.25", "controller.gain=0"]))
    assert result.trace is not None
    assert result.trace["plant.x"][:3].tolist() == [1.0, 0.25, 0.0625]


def test_the_plants_of_the_project_are_found_by_name(write: Write) -> None:
    import plants

    with pytest.raises(PlantError, match=plants.names()[0]):
        cosim.run(cosim.load(write(), set=["plant.name=none"]))


UNSTABLE = """
<mujoco><option timestep="1e-3" integrator="implicitfast"/>
  <worldbody>
    <body><joint name="hinge" type="hinge" stiffness="-0.3"/><geom size="0.1" mass="1"/></body>
  </worldbody>
  <actuator><motor name="push" joint="hinge"/></actuator>
  <sensor><jointpos name="angle" joint="hinge"/></sensor>
</mujoco>
"""
TILTED = SCENARIO.replace("probe_plants:Lag", "tilted.xml").replace("plant.x", "plant.angle")
TILTED = TILTED.replace("plant.u", "plant.push")


def test_an_mjcf_with_a_negative_stiffness_runs_and_is_shown(write: Write, folder: Path) -> None:
    (folder / "tilted.xml").write_text(UNSTABLE)
    file = write(text=TILTED)
    assert cosim.run(cosim.load(file)).simulated_s == 0.05
    with pytest.raises(PlantError, match=r"`plant.joint.hinge.stiffness` is `-0.4`, it must be in 0 .. "):
        cosim.run(cosim.load(file, set=["plant.joint.hinge.stiffness=-0.4"]))
    shown = subprocess.run(
        [sys.executable, "-m", "cosim", "show", "lag.toml"],
        env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert re.search(r"joint.hinge.stiffness +-0.3 +N.m/rad +0 ..", shown.stdout), shown.stderr


REGISTERED = {
    "Slid": (
        "slide",
        r"cannot import the plant `slide`: .*no class .* named `Slid`\nhint: Use `Slide`",
    ),
    "Slide": (
        "sledge",
        r"cannot import the plant `sledge`: .*'plants.sledge'\nhint: Check `plants/sledge.py`",
    ),
}


@pytest.mark.parametrize("kind", REGISTERED)
def test_a_wrong_entry_of_the_registry_is_explained(
    write: Write, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    import plants

    name, message = REGISTERED[kind]
    monkeypatch.setitem(plants.PLANTS, name, kind)
    with pytest.raises(PlantError, match=message):
        cosim.run(cosim.load(write(), set=[f"plant.name={name}"]))


def test_a_plant_that_names_what_is_not_there_is_explained(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    from plants.slide import Slide

    file = write(text=SCENARIO.replace("probe_plants:Lag", "slide").replace("plant.x", "plant.position"))
    scenario = cosim.load(file, set=["wire.plant.u.to=plant.current", "loop.substeps=20"])
    with monkeypatch.context() as patch:
        patch.setattr(Slide, "shape", lambda plant, spec, p: spec.body("slid"))
        expected = (
            r"the plant `slide` cannot be built: there is no body in `slide.xml` named `slid`\nhint: Use"
        )
        with pytest.raises(PlantError, match=expected):
            cosim.run(scenario)
    monkeypatch.setattr(Slide, "begin", lambda plant, steps: plant.wire("curent"))
    expected = r"the plant `slide` cannot be reset: .* no wire in `Slide.wires` named `curent`\nhint: Use"
    with pytest.raises(PlantError, match=expected):
        cosim.run(scenario)


SHAPELESS = {
    "class P: ...": r":P` has no method `reset`, so it is not a plant\nhint: Follow the protocols",
    "P = len": ":len` is not a class, so it is not a plant",
    "class P(Lag):\n    Parameters = None": ":P` has no dataclass `Parameters`",
    "class P(Lag):\n    Parameters = dict": ":P` has no dataclass `Parameters`",
    "@dataclasses.dataclass\nclass Q:\n    a: 'Undefined' = 1\nclass P(Lag):\n    Parameters = Q": (
        r":P` has `Parameters` with unknown types: NameError: name 'Undefined'"
    ),
    "class P(Lag):\n    readings = 'x'": "`readings` is `'x'`, it must be a tuple of channels",
    "class P(Lag):\n    readings = ('x',)": "AttributeError: 'str' object has no attribute 'name'",
    "class P(Lag):\n    commands = None": "`commands` is `None`, it must be a tuple of channels",
    "class P(Lag):\n    truths = 2 * Lag.truths": "`x` of `truths` is defined twice",
    "class P(Lag):\n    truths = (Channel(1),)": "`1` of `truths` has the name `1`, it must be a text",
    "class P(Lag):\n    commands = (Channel('u', noise=-1.0),)": "`u` of `commands` has the noise `-1.0`",
    "class P(Lag):\n    commands = (Channel('u', minimum=2.0, maximum=1.0),)": "limited to `2.0` .. `1.0`",
    "class P(Lag):\n    timestep = None": "`timestep` is `None`, it must be a positive number of seconds",
    "class P(Lag):\n    timestep = 0.0": "`timestep` is `0.0`, it must be a positive number",
    "class P(Lag):\n    timestep = float('nan')": "`timestep` is `nan`, it must be a positive number",
    "class P(Lag):\n    @property\n    def timestep(self): raise RuntimeError('boom')": "RuntimeError: boom",
    "class P(Lag):\n    def truth(self): return 1.0": (
        r"`truth` of the plant gave the single value `1.0` for 4 channels at t = 0 s \(step 0\)"
    ),
    "class P(Lag):\n    def sense(self): return np.zeros(3)": (
        r"`sense` of the plant gave values of shape `\(3,\)` for 4 channels at t = 0 s"
    ),
}


@pytest.mark.parametrize("number", range(len(SHAPELESS)), ids=SHAPELESS)
def test_what_has_not_the_shape_of_a_plant_is_reported_in_one_message(
    write: Write, folder: Path, number: int
) -> None:
    text, message = list(SHAPELESS.items())[number]
    imports = "import dataclasses\nimport numpy as np\nfrom probe_plants import *\n"
    # a name of its own: modules stay imported
    (folder / f"shapeless{number}.py").write_text(f"{imports}{text}\n")
    with pytest.raises(PlantError, match=message):
        cosim.run(cosim.load(write(), set=[f"plant.name=shapeless{number}:P"]))


def test_modules_of_one_name_next_to_two_scenarios_are_two_plants(write: Write, folder: Path) -> None:
    ends = []
    for name, pole in (("one", 0.5), ("two", 0.9)):
        file = write(name=f"{name}/lag.toml", added=END)
        sense = f"    def sense(self): return {pole} * super().sense()\n"
        file.with_name("tank.py").write_text(f"from probe_plants import *\nclass Tank(Lag):\n{sense}")
        result = cosim.run(
            cosim.load(file, set=["plant.name=tank:Tank", f"controller.fmu={folder / 'probe.fmu'}"])
        )
        ends.append(result.metrics["end"].value)
    assert ends[0] != ends[1]
