"""A bare MJCF as a plant: channels by name, parameters as in the file, honest errors."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import plants.bare.plant
from plants.base.parameters import ParameterError
from plants.base.plant import PlantError

CART = """
<mujoco model="cart">
  <option timestep="0.001" integrator="implicitfast" gravity="0 0 -9.81"/>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 0.1"/>
    <body name="cart" pos="0 0 1">
      <joint name="slide" type="slide" axis="1 0 0" damping="0.5"/>
      <geom name="box" type="box" size="0.1 0.05 0.05" mass="1"/>
      <body name="pole">
        <joint name="hinge" type="hinge" axis="0 1 0" damping="0.02" stiffness="0.3"/>
        <geom type="capsule" size="0.01" fromto="0 0 0 0 0 -0.5" mass="0.1"/>
      </body>
    </body>
    <body name="puck" pos="0 1 0.02">
      <freejoint name="free"/>
      <geom name="disc" type="cylinder" size="0.05 0.02" mass="0.2" friction="0.7"/>
    </body>
    <body name="globe" pos="0 -1 0.5">
      <joint name="ball" type="ball"/>
      <geom type="sphere" size="0.1" pos="0 0 0.1" mass="1" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="travel" stiffness="0.4"><joint joint="slide" coef="1"/></fixed>
    <fixed name="mixed"><joint joint="slide" coef="1"/><joint joint="hinge" coef="1"/></fixed>
  </tendon>
  <actuator>
    <motor name="push" joint="slide" ctrllimited="true" ctrlrange="-10 10"/>
    <motor name="geared" joint="slide" gear="3"/>
    <position name="servo" joint="hinge" kp="0.2"/>
    <velocity name="drive" joint="hinge" kv="0.1"/>
    <motor joint="slide"/>
  </actuator>
  <sensor>
    <jointpos name="x" joint="slide" noise="1e-3"/>
    <jointvel name="turning" joint="hinge"/>
    <framequat name="tilt" objtype="body" objname="puck"/>
    <framepos name="place" objtype="body" objname="puck"/>
    <actuatorfrc name="thrust" actuator="push"/>
    <tendonpos name="length" tendon="travel"/>
    <tendonpos name="sum" tendon="mixed"/>
    <user name="extra" dim="2"/>
    <jointpos joint="hinge"/>
  </sensor>
  <keyframe>
    <key name="away" qpos="0.3 0.1  0 1 0.02 1 0 0 0  1 0 0 0" qvel="0.5 0  0 0 0 0 0 0  0 0 0"/>
  </keyframe>
</mujoco>
"""
Write = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Write an MJCF file: the cart with some texts replaced."""

    def write_mjcf(*changes: tuple[str, str], name: str = "cart.xml", text: str = CART) -> Path:
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        file = tmp_path / name
        file.write_text(text)
        return file

    return write_mjcf


def build(file: Path, **parameters: Any) -> Any:
    """Plant of a file; `joint__slide__damping` is the parameter `joint.slide.damping`."""
    kind = plants.bare.load(file)
    fields = {field.metadata["key"]: field.name for field in dataclasses.fields(cast(Any, kind.Parameters))}
    named = {fields[key.replace("__", ".")]: value for key, value in parameters.items()}
    return kind(kind.Parameters(**named))


def run(plant: Any, steps: int = 200, **commands: Any) -> np.ndarray[Any, Any]:
    """Ground truth of a run with constant commands."""
    plant.reset(1, steps * plant.timestep)
    rows = []
    for _ in range(steps):
        plant.sense()
        plant.command(np.array([commands.get(channel.name, 0.0) for channel in plant.commands]))
        rows.append(plant.truth())
        plant.advance(1)
    return np.array(rows)


def column(plant: Any, table: np.ndarray[Any, Any], name: str) -> np.ndarray[Any, Any]:
    values: np.ndarray[Any, Any] = table[:, [channel.name for channel in plant.truths].index(name)]
    return values


def test_channels_have_the_names_units_noise_and_limits_of_the_file(write: Write) -> None:
    plant = build(write())
    readings = {channel.name: channel for channel in plant.readings}
    assert list(readings) == [
        "x", "turning", "tilt.w", "tilt.x", "tilt.y", "tilt.z", "place.x", "place.y", "place.z", "thrust",
        "length", "sum", "extra[1]", "extra[2]",
    ]  # fmt: skip
    units = {
        "x": "m",
        "turning": "rad/s",
        "tilt.w": "1",
        "place.z": "m",
        "thrust": "N",
        "length": "m",
        "sum": "",
    }
    assert {name: readings[name].unit for name in units} == units
    assert (readings["x"].noise, readings["turning"].noise) == (1e-3, 0.0)
    commands = {channel.name: channel for channel in plant.commands}
    assert {name: channel.unit for name, channel in commands.items()} == {
        "push": "N", "geared": "", "servo": "rad", "drive": "rad/s",
    }  # fmt: skip
    assert (commands["push"].minimum, commands["push"].maximum) == (-10.0, 10.0)
    assert commands["servo"].maximum == math.inf
    truths = {channel.name: channel.unit for channel in plant.truths}
    assert (truths["slide.position"], truths["hinge.velocity"], truths["free.position.x"]) == (
        "m",
        "rad/s",
        "m",
    )
    assert (truths["free.rotation.w"], truths["ball.angular_velocity.z"]) == ("1", "rad/s")
    assert (truths["push.command"], truths["push.force"], truths["x"]) == ("N", "N", "m")


def test_a_pushed_cart_moves_as_newton_says(write: Write) -> None:
    plant = build(write(), body__cart__mass=3.9, joint__slide__damping=2.0, tendon__travel__stiffness=0.0)
    table = run(plant, 1000, push=4.0)
    # the pole adds 0.1 kg and hardly oscillates while the cart is slow
    time, mass = 0.999, 4.0
    expected = 4.0 / 2.0 * (1.0 - math.exp(-2.0 * time / mass))
    assert column(plant, table, "slide.velocity")[-1] == pytest.approx(expected, rel=0.02)


EDITS = {
    "timestep": ('timestep="0.001"', 'timestep="0.002"', 0.002),
    "gravity__z": ("0 0 -9.81", "0 0 -1.62", -1.62),
    "body__cart__mass": ('mass="1"', 'mass="2.5"', 2.5),
    "body__pole__mass": ('mass="0.1"', 'mass="0.3"', 0.3),
    "joint__slide__damping": ('damping="0.5"', 'damping="3"', 3.0),
    "joint__slide__armature": ('damping="0.5"', 'damping="0.5" armature="0.7"', 0.7),
    "joint__slide__frictionloss": ('damping="0.5"', 'damping="0.5" frictionloss="0.2"', 0.2),
    "joint__slide__stiffness": ('damping="0.5"', 'damping="0.5" stiffness="5"', 5.0),
    "joint__hinge__stiffness": ('stiffness="0.3"', 'stiffness="0"', 0.0),
    "tendon__travel__stiffness": ('stiffness="0.4"', 'stiffness="7"', 7.0),
    "tendon__travel__damping": ('stiffness="0.4"', 'stiffness="0.4" damping="2"', 2.0),
    "geom__disc__friction": ('friction="0.7"', 'friction="1.2"', 1.2),
    "actuator__geared__gear": ('gear="3"', 'gear="-2"', -2.0),
    "actuator__push__gain": ('<motor name="push"', '<general gainprm="4" name="push"', 4.0),
    "actuator__servo__kp": ('kp="0.2"', 'kp="0.5"', 0.5),
    "actuator__servo__kv": ('kp="0.2"', 'kp="0.2" kv="0.07"', 0.07),
    "actuator__drive__kv": ('kv="0.1"', 'kv="0.3"', 0.3),
}


@pytest.mark.parametrize("key", EDITS)
def test_a_parameter_does_what_the_same_edit_of_the_file_does(write: Write, key: str) -> None:
    old, new, value = EDITS[key]
    commands: dict[str, Any] = {"push": 1.0, "geared": 0.5, "servo": 0.4}
    sliding = ('qvel="0.5 0  0 0 0', 'qvel="0.5 0  1 0 0')
    edited = run(build(write(sliding, (old, new)), keyframe="away"), **commands)
    plain = write(sliding)
    given = run(build(plain, keyframe="away", **{key: value}), **commands)
    assert not np.array_equal(given, run(build(plain, keyframe="away"), **commands))
    np.testing.assert_allclose(given, edited, rtol=1e-9, atol=1e-12)


SERVO, GENERAL = '<position name="servo" joint="hinge" kp="0.2"/>', '<general name="servo" joint="hinge" {}/>'
AFFINE = GENERAL.format('biastype="affine" gaintype="affine" gainprm="{} {} {}" biasprm="{} {} {}"')
NUMBERS = ("gain", "gain_length", "gain_velocity", "bias", "bias_length", "bias_velocity")


@pytest.mark.parametrize("place", range(6))
def test_gain_and_bias_are_those_of_the_compiled_model(write: Write, place: int) -> None:
    numbers = [0.4, 0.3, 0.2, 0.1, -0.7, -0.6]
    plain = write((SERVO, AFFINE.format(*numbers)))
    given = build(plain, **{f"actuator__servo__{NUMBERS[place]}": 0.9}).model
    numbers[place] = 0.9
    edited = build(write((SERVO, AFFINE.format(*numbers)))).model
    for array in ("actuator_gainprm", "actuator_biasprm"):
        assert np.array_equal(getattr(given, array), getattr(edited, array))


def actuator_parameters(file: Path, name: str) -> dict[str, tuple[float, str]]:
    """Value and unit of the parameters of an actuator."""
    fields = dataclasses.fields(cast(Any, plants.bare.load(file).Parameters))
    start = f"actuator.{name}."
    keys = {field.metadata["key"]: field for field in fields}
    return {
        key.removeprefix(start): (cast(float, field.default), field.metadata["unit"])
        for key, field in keys.items()
        if key.startswith(start)
    }


KINDS = {
    "servo": {"gear": (1.0, ""), "kp": (0.2, "N.m/rad"), "kv": (0.0, "N.m.s/rad"), "bias": (0.0, "N.m")},
    "drive": {"gear": (1.0, ""), "kv": (0.1, "N.m.s/rad"), "bias": (0.0, "N.m")},
    "push": {"gear": (1.0, ""), "gain": (1.0, "")},
}


@pytest.mark.parametrize("name", KINDS)
def test_an_actuator_has_the_numbers_that_mujoco_uses(write: Write, name: str) -> None:
    assert actuator_parameters(write(), name) == KINDS[name]


RATIO = {
    "position": '<position name="servo" joint="hinge" kp="0.2" dampratio="0.7"/>',
    "nameless": '<position joint="hinge" kp="0.2" dampratio="0.7"/><motor name="servo" joint="hinge"/>',
    "pid": '<pid name="servo" joint="hinge" kp="0.2" dampratio="0.7" gear="2"/>',
    "tendon": '<position name="servo" tendon="mixed" kp="0.2" dampratio="0.7"/>',
    "orientation": '<orientation name="servo" joint="ball" kp="0.2" dampratio="0.7"/>',
}
CHANGES = {
    "actuator__servo__kp": ('kp="0.2"', 'kp="0.5"', 0.5),
    "actuator__servo__dampratio": ('dampratio="0.7"', 'dampratio="0.4"', 0.4),
    "body__cart__mass": ('mass="1"', 'mass="2.5"', 2.5),
    "joint__hinge__armature": ('damping="0.02"', 'damping="0.02" armature="0.7"', 0.7),
}


@pytest.mark.parametrize(("kind", "key"), [
    *(("position", key) for key in CHANGES), ("nameless", "joint__hinge__armature"),
    ("pid", "actuator__servo__kp"), ("tendon", "body__cart__mass"), ("orientation", "actuator__servo__kp"),
])  # fmt: skip
def test_a_damping_ratio_follows_gains_and_masses_as_in_the_file(write: Write, kind: str, key: str) -> None:
    # inertias of the ball that differ from axis to axis
    ball = '<geom type="sphere" size="0.1" pos="0 0 0.1"'
    old, new, value = CHANGES[key]
    plain = (SERVO, RATIO[kind]), (ball, '<geom type="box" size="0.1 0.2 0.4" pos="0.1 0 0"')
    given = build(write(*plain), **{key: value}).model
    edited = build(write(*plain, (old, new))).model
    unchanged = build(write(*plain)).model.actuator_biasprm[2, 2]
    assert unchanged < 0.0
    assert given.actuator_biasprm[2, 2] != unchanged
    np.testing.assert_allclose(given.actuator_biasprm, edited.actuator_biasprm, rtol=1e-12)


def test_a_servo_has_the_damping_ratio_of_the_file_instead_of_a_damping(write: Write) -> None:
    numbers = actuator_parameters(write((SERVO, RATIO["position"])), "servo")
    assert (numbers["dampratio"], "kv" in numbers) == ((0.7, "1"), False)


def test_damping_from_a_spring_damper_is_described_as_constant(write: Write) -> None:
    file = write(('damping="0.5"', 'springdamper="0.1 1"'))
    fields = dataclasses.fields(cast(Any, plants.bare.load(file).Parameters))
    texts = {field.metadata["key"]: field.metadata["description"] for field in fields}
    from_masses = ", from `springdamper` and the masses of the file"
    assert texts["joint.slide.damping"].endswith(from_masses)
    assert texts["joint.slide.stiffness"].endswith(from_masses)
    assert texts["joint.hinge.damping"] == "Damping of the joint"


PID = '<pid name="servo" joint="{}" kp="0.2" kv="0.1" ki="0.3" input="pos vel ff" velrange="-2 2"/>'


@pytest.mark.parametrize(
    ("joint", "units"), [("slide", ["m", "m/s", "N"]), ("hinge", ["rad", "rad/s", "N.m"])]
)
def test_the_inputs_of_an_actuator_have_names_and_units(write: Write, joint: str, units: list[str]) -> None:
    file = write((SERVO, PID.format(joint)))
    channels = [one for one in build(file).commands if one.name.startswith("servo")]
    assert [one.name for one in channels] == ["servo.pos", "servo.vel", "servo.ff"]
    assert [one.unit for one in channels] == units
    assert [one.maximum for one in channels] == [math.inf, 2.0, math.inf]
    assert channels[1].description == "Velocity setpoint of `servo`"
    numbers = {key: value for key, (value, _) in actuator_parameters(file, "servo").items()}
    assert numbers == {"gear": 1.0, "kp": 0.2, "kv": 0.1, "ki": 0.3, "bias": 0.0}


INPUT = {
    "pos-ff": ('<pid name="servo" joint="hinge" input="pos ff"/>', {"servo.pos": "rad", "servo.ff": "N.m"}),
    "vel": ('<pid name="servo" joint="hinge" input="vel"/>', {"servo": "rad/s"}),
    "voltage": ('<dcmotor name="servo" joint="hinge" resistance="1" motorconst="1"/>', {"servo": "V"}),
    "pressure": ('<cylinder name="servo" joint="slide"/>', {"servo": "Pa"}),
    "quaternion": (
        '<orientation name="servo" joint="ball" kp="1" input="quat"/>',
        dict.fromkeys(("servo.qw", "servo.qx", "servo.qy", "servo.qz"), "1"),
    ),
    "rotation": (
        '<orientation name="servo" joint="ball" kp="1"/>',
        dict.fromkeys(("servo.rx", "servo.ry", "servo.rz"), "rad"),
    ),
}


@pytest.mark.parametrize("case", INPUT)
def test_inputs_are_called_as_in_mujoco(write: Write, case: str) -> None:
    text, units = INPUT[case]
    found = {one.name: one.unit for one in build(write((SERVO, text))).commands}
    assert {name: unit for name, unit in found.items() if name.startswith("servo")} == units


def test_a_pid_without_an_integral_has_no_gain_of_it(write: Write) -> None:
    file = write((SERVO, INPUT["pos-ff"][0]))
    assert actuator_parameters(file, "servo").keys() == {"gear", "kp", "kv", "bias"}


def test_a_quaternion_command_starts_as_no_rotation(write: Write) -> None:
    plant = build(write((SERVO, INPUT["quaternion"][0])))
    assert [one.start for one in plant.commands if one.name.startswith("servo")] == [1.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("gain", ["kp", "kv", "ki"])
def test_a_gain_of_a_pid_does_what_the_same_edit_of_the_file_does(write: Write, gain: str) -> None:
    old = {"kp": "0.2", "kv": "0.1", "ki": "0.3"}[gain]
    text = PID.format("hinge")
    edited = text.replace(f'{gain}="{old}"', f'{gain}="0.9"')
    commands: dict[str, Any] = {"servo.pos": 0.4, "servo.vel": 0.1}
    given = run(build(write((SERVO, text)), **{f"actuator__servo__{gain}": 0.9}), **commands)
    assert np.array_equal(given, run(build(write((SERVO, edited))), **commands))
    assert not np.array_equal(given, run(build(write((SERVO, text))), **commands))


def test_a_keyframe_sets_the_start_of_its_commands(write: Write) -> None:
    file = write(('<key name="away"', '<key name="away" ctrl="3 0 0.2 -0.1 0.5"'))
    plant = build(file, keyframe="away")
    starts = {one.name: one.start for one in plant.commands}
    assert starts == {"push": 3.0, "geared": 0.0, "servo": 0.2, "drive": -0.1}
    plant.reset(1, 1.0)
    assert plant.data.ctrl.tolist() == [3.0, 0.0, 0.2, -0.1, 0.5]
    assert {one.start for one in build(file).commands} == {0.0}


def test_a_sensor_replaces_the_signal_of_a_joint_with_its_name(write: Write) -> None:
    plant = build(write(('jointpos name="x" joint="slide" noise="1e-3"', 'clock name="slide.position"')))
    assert plant.readings[0].name == "slide.position"
    assert [one.unit for one in plant.truths if one.name == "slide.position"] == ["s"]


def test_an_actuator_of_another_kind_has_its_gear_only(write: Write) -> None:
    file = write((SERVO, '<muscle name="servo" joint="hinge" lengthrange="0 1"/>'))
    assert list(actuator_parameters(file, "servo")) == ["gear"]


def test_a_servo_whose_gain_changes_still_holds_its_setpoint(write: Write) -> None:
    weightless = ("0 0 -9.81", "0 0 0"), ('damping="0.02" stiffness="0.3"', 'damping="0.02"')
    plant = build(write(*weightless), actuator__servo__kp=2.0, actuator__servo__kv=0.3)
    assert plant.commands[2].unit == "rad"
    assert column(plant, run(plant, 4000, servo=0.4), "hinge.position")[-1] == pytest.approx(0.4, abs=1e-3)


def test_a_run_starts_where_it_is_reported(write: Write) -> None:
    file = write()
    truths = run(build(file), 1)
    plant = build(file, keyframe="away", joint__slide__position=-0.2, joint__hinge__velocity=0.7)
    table = run(plant, 50)
    start = {
        name: column(plant, table, name)[0] for name in ("slide.position", "slide.velocity", "hinge.position")
    }
    assert start == {"slide.position": -0.2, "slide.velocity": 0.5, "hinge.position": 0.1}
    assert column(plant, table, "hinge.velocity")[0] == 0.7
    assert column(plant, truths, "slide.position")[0] == 0.0
    # the second run of a plant is the first run of a new one
    assert np.array_equal(run(plant, 50), table)


def test_forces_are_those_of_the_step_before(write: Write) -> None:
    plant = build(write())
    thrust = column(plant, run(plant, 3, push=2.0), "thrust")
    assert thrust.tolist() == [0.0, 2.0, 2.0]


MISTAKES = {
    "misspelt": (('damping="0.5"', 'dampin="0.5"'), r"cannot load `cart.xml`: .*`?'dampin'.*joint.*line 7"),
    "no-target": (('joint="slide" ctrl', 'joint="slid" ctrl'), r"cannot load `cart.xml`: .*'slid'.*line"),
    "broken": (("</mujoco>", ""), r"cannot load `cart.xml`: XML"),
    "ambiguous": (('name="x"', 'name="extra[1]"'), r"two channels .*`extra\[1\]`\nhint: Rename"),
    "rk4": (("implicitfast", "RK4"), r"`cart`: integrator `RK4` .*\nhint: Use `implicitfast`"),
}


@pytest.mark.parametrize("case", MISTAKES)
def test_a_file_with_a_mistake_is_rejected(write: Write, case: str) -> None:
    change, message = MISTAKES[case]
    with pytest.raises(PlantError, match=message):
        build(write(change))


def test_wrong_parameters_are_rejected(write: Write) -> None:
    file = write()
    with pytest.raises(ParameterError, match=r"`plant.joint.slide.damping` .* `-1` N.s/m, limit `0` to"):
        build(file, joint__slide__damping=-1.0)
    with pytest.raises(ParameterError, match=r"`plant.keyframe` .* value `1.0`, one of `away`"):
        build(file, keyframe=1.0)
    with pytest.raises(ParameterError, match=r"`plant.keyframe` .* value `none`, one of `away`"):
        build(file, keyframe="none")


def test_what_the_file_says_is_never_rejected(write: Write) -> None:
    file = write(('stiffness="0.3"', 'stiffness="-0.3"'))
    plant = build(file)
    assert plant.model.jnt_stiffness[1] == -0.3
    assert build(file, joint__hinge__stiffness=0.5).model.jnt_stiffness[1] == 0.5
    with pytest.raises(
        ParameterError, match=r"`plant.joint.hinge.stiffness` .* `-0.4` N.m/rad, limit `0` to"
    ):
        build(file, joint__hinge__stiffness=-0.4)


def test_another_integrator_makes_a_file_with_rk4_fit(write: Write) -> None:
    given = run(build(write(("implicitfast", "RK4")), integrator="implicitfast"), push=1.0)
    assert np.array_equal(given, run(build(write()), push=1.0))
    with pytest.raises(ParameterError, match=r"value `verlet`, one of `euler`, `implicit`, `implicitfast`"):
        build(write(), integrator="verlet")


def test_a_run_that_blows_up_ends_with_the_time(write: Write) -> None:
    plant = build(write(), joint__slide__stiffness=0.0, timestep=0.01, actuator__geared__gear=1e12)
    with pytest.raises(PlantError, match=r"plant `cart` at t = .*mjWARN_BAD"):
        run(plant, 50, geared=1e12)


def test_the_fingerprint_is_that_of_all_that_is_included(write: Write) -> None:
    write(name="sensors.xml", text='<mujoco><sensor><clock name="now"/></sensor></mujoco>')
    file = write(("<sensor>", '<include file="sensors.xml"/><sensor>'))
    before = plants.bare.fingerprint(file)
    assert before == plants.bare.fingerprint(write(("<sensor>", '<include file="sensors.xml"/>\n<sensor>')))
    assert [channel.name for channel in build(file).readings][:1] == ["now"]
    write(name="sensors.xml", text='<mujoco><sensor><clock name="later"/></sensor></mujoco>')
    assert plants.bare.fingerprint(file) != before


def test_a_class_of_the_file_is_left_to_it_whatever_its_name(write: Write) -> None:
    named = (
        "<worldbody>",
        '<default><default class="looks"><geom group="2"/></default></default><worldbody>',
    )
    file = write(named, ('<geom type="capsule"', '<geom class="looks" type="capsule"'))
    before, plant = build(write(name="plain.xml")).model, build(file)
    assert (plant.model.ngeom, plant.model.ncam) == (before.ngeom, before.ncam)
    assert np.array_equal(plant.model.body_mass, before.body_mass)
