"""`cosim new`: a scenario to start from."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim as api
from cosim.new.draft import End, match

from ..conftest import DATA
from .commands import called, cosim

Write = Callable[..., Path]
MJCF = """
<mujoco>
  <option timestep="0.001"/>
  <worldbody>
    <body><joint name="slide" type="slide"/><geom size="0.1" mass="1"/></body>
  </worldbody>
  <actuator>
    <position name="out" joint="slide" kp="10" ctrllimited="true" ctrlrange="-5 5"/>
    <motor name="brake" joint="slide"/>
  </actuator>
  <sensor><jointpos name="in" joint="slide"/><jointvel name="rate" joint="slide"/></sensor>
</mujoco>
"""


def pairs(sources: list[End], targets: list[End]) -> dict[str, tuple[str, float, bool]]:
    return {m.target.name: (m.source.name, m.conversion.factor, m.sure) for m in match(sources, targets)}


def test_ends_match_by_the_words_of_their_names() -> None:
    sources = [End("slide.position"), End("slide.velocity"), End("swing.position")]
    targets = [End("SlideVelocity"), End("swing_position"), End("target")]
    assert pairs(sources, targets) == {
        "SlideVelocity": ("slide.velocity", 1.0, True),
        "swing_position": ("swing.position", 1.0, True),
        # what is left on both sides is a guess
        "target": ("slide.position", 1.0, False),
    }


def test_axes_are_not_taken_for_each_other() -> None:
    axes = [End(f"axis.{axis}") for axis in "xyz"]
    assert {to: of[0] for to, of in pairs(axes, [End(f"pos_{axis}") for axis in "zyx"]).items()} == {}
    swapped = pairs(axes, [End(f"axis_{axis}") for axis in "zyx"])
    assert {to: of[0] for to, of in swapped.items()} == {f"axis_{axis}": f"axis.{axis}" for axis in "xyz"}


def test_units_that_contradict_each_other_are_never_joined() -> None:
    assert pairs([End("position", "m")], [End("position", "rad")]) == {}
    assert pairs([End("position", "m")], [End("position", "mm")]) == {"position": ("position", 1e3, True)}
    both = [End("position", "rad"), End("position_x", "m")]
    assert pairs(both, [End("position", "m")])["position"][0] == "position_x"


def test_what_is_left_alone_on_both_sides_is_joined_as_a_guess() -> None:
    assert pairs([End("force")], [End("drive", "N")]) == {"drive": ("force", 1.0, False)}
    assert pairs([End("force"), End("torque")], [End("drive", "N")]) == {}
    assert pairs([End("force", "A")], [End("drive", "N")]) == {}


def test_the_new_scenario_passes_the_check_and_runs(folder: Path) -> None:
    (folder / "cart.xml").write_text(MJCF)
    done = cosim("new", "probe.fmu", "cart.xml")
    assert (done.returncode, done.stderr) == (0, "")
    assert "probe.toml: 2 wires, 4 inputs and commands left as comments" in done.stdout
    checked = cosim("check", "probe.toml")
    assert checked.returncode == 0
    assert checked.stdout == "probe.toml: scenario, valid\n"
    assert (
        "nothing drives `controller.count`, `controller.mode`, `controller.flag`, `plant.brake`"
        in checked.stderr
    )
    scenario = api.load(folder / "probe.toml")
    assert [(wire.source, wire.to) for wire in scenario.wire] == [
        ("plant.in", "controller.in"),
        ("controller.out", "plant.out"),
    ]
    assert (scenario.loop.step, scenario.loop.substeps) == (0.01, 10)
    assert set(api.run(scenario).metrics) == {"peak"}


def test_the_schema_of_a_new_scenario_is_named_in_it_and_knows_fmu_and_plant(
    folder: Path,
) -> None:
    (folder / "cart.xml").write_text(MJCF)
    assert called("new", "probe.fmu", "cart.xml", "-o", "my.toml").returncode == 0
    assert (folder / "my.toml").read_text().startswith("#:schema ./my.schema.json\n")
    schema = json.loads((folder / "my.schema.json").read_text())
    known = {name: schema["properties"][name]["properties"]["parameters"] for name in ("controller", "plant")}
    assert "gain" in known["controller"]["properties"]
    assert known["plant"]["properties"]


def test_the_comments_are_a_scenario_once_the_marks_are_taken_away(folder: Path) -> None:
    (folder / "cart.xml").write_text(MJCF)
    called("new", "probe.fmu", "cart.xml")
    text = (folder / "probe.toml").read_text()
    assert "# Enumeration, Off | Slow | Fast" in text
    assert "#   plant.rate: m/s, Sensor `jointvel`" in text
    (folder / "all.toml").write_text(re.sub(r"^# (\[\[|\w+ = )", r"\1", text, flags=re.MULTILINE))
    scenario = api.load(folder / "all.toml")
    driven = {signal.to for signal in scenario.signal}
    assert driven == {"controller.count", "controller.mode", "controller.flag", "plant.brake"}
    result = api.run(scenario)
    assert [verdict.criterion.id for verdict in result.criteria] == ["peak"]
    assert called("check", "all.toml").stderr == ""


def test_the_comment_at_the_top_quiets_what_is_left(folder: Path) -> None:
    (folder / "cart.xml").write_text(MJCF)
    called("new", "probe.fmu", "cart.xml")
    text = (folder / "probe.toml").read_text()
    (folder / "quiet.toml").write_text(text.replace("# undriven = [", "undriven = [", 1))
    scenario = api.load(folder / "quiet.toml")
    assert scenario.undriven == ("controller.count", "controller.mode", "controller.flag", "plant.brake")
    assert "nothing drives" not in called("check", "quiet.toml").stderr


def test_an_fmu_alone_gets_a_scenario_without_a_plant(folder: Path) -> None:
    (folder / "deep").mkdir()
    assert called("new", "probe.fmu", "--out", "deep/alone.toml").returncode == 0
    scenario = api.load(folder / "deep" / "alone.toml")
    assert (scenario.plant.name, scenario.controller.fmu) == ("", "../probe.fmu")
    assert called("check", "deep/alone.toml").returncode == 0


def test_a_single_letter_matches_no_component() -> None:
    components = [End(f"force.{axis}", "N") for axis in "xyz"]
    assert pairs([End("y")], components) == {}
    assert pairs([End("y")], [End("y", "N")]) == {"y": ("y", 1.0, True)}
    setpoints = [End("servo.pos", "m"), End("servo.vel", "m/s"), End("servo.ff", "N")]
    assert pairs([End("y")], setpoints) == {}
    assert pairs([End("velocity", "m/s")], [setpoints[1]]) == {"servo.vel": ("velocity", 1.0, False)}


def test_a_model_with_rk4_gets_another_integrator(folder: Path) -> None:
    (folder / "cart.xml").write_text(MJCF.replace("<option ", '<option integrator="RK4" '))
    assert called("new", "probe.fmu", "cart.xml").returncode == 0
    reason = "a step of `RK4` cannot be divided at the sensors"
    assert f'integrator = "implicitfast"    # {reason}\n' in (folder / "probe.toml").read_text()
    scenario = api.load(folder / "probe.toml")
    assert scenario.plant.parameters == {"integrator": "implicitfast"}
    assert set(api.run(scenario).metrics) == {"peak"}


def test_a_urdf_file_is_a_plant(folder: Path) -> None:
    links = '<link name="base"/><link name="arm"><inertial><mass value="1"/>'
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    joint = '<parent link="base"/><child link="arm"/><limit lower="-1" upper="1" effort="3" velocity="1"/>'
    robot = f'{links}{inertia}<joint name="hinge" type="revolute">{joint}</joint>'
    (folder / "arm.urdf").write_text(f'<robot name="arm">{robot}</robot>')
    assert called("new", "probe.fmu", "arm.urdf").returncode == 0
    scenario = api.load(folder / "probe.toml")
    assert "plant.hinge.position" in api.run(scenario).units


def test_nothing_is_ever_overwritten(folder: Path) -> None:
    (folder / "probe.toml").write_text("mine")
    done = called("new", "probe.fmu")
    assert done.returncode == 2
    assert done.stderr == "error: `probe.toml` exists already\nhint: Choose another name with `--out`.\n"
    assert (folder / "probe.toml").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["none.fmu"], "the FMU file `none.fmu` does not exist"),
        (["probe.fmu", "none.xml"], "the MJCF file `none.xml` does not exist"),
        (["probe.fmu", "slid"], "Use `slide`"),
        (["probe.fmu", "exiting:Any"], "the plant `exiting:Any` ended the process: `sys.exit(0)`"),
        (["probe.fmu", "--out", "a.txt"], "Use a name that ends in `.toml`."),
        (["probe.fmu", "--out", "none/a.toml"], "cannot write `none/a.toml`: the folder"),
    ],
)
def test_mistakes_are_reported_and_leave_no_file(arguments: list[str], reported: str, folder: Path) -> None:
    shutil.copy(DATA / "exiting.py", folder)
    before = set(Path().glob("**/*.toml"))
    done = called("new", *arguments)
    assert done.returncode == 2
    assert reported in done.stderr
    assert set(Path().glob("**/*.toml")) == before
