"""The orthogonal robot against closed forms."""

import math
import typing
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from plants.orthogonal_robot import AXES, OrthogonalRobot
from plants.orthogonal_robot_parameters import OrthogonalRobotParameters
from plants.tools.molds import MOLDS

Matrix = np.ndarray[Any, Any]
Columns = dict[str, Matrix]
Pulses = Callable[[int], tuple[float, float, float]]

NOMINAL = OrthogonalRobotParameters()
WEIGHT = 0.010 * 9.80665
BALL = 0.5e-3
# pressed into the top of the saddle by 30 um: 5.3 N
PRESSED: dict[str, Any] = {"mold": "saddle", "start_x": 0.0, "start_z": BALL - 30e-6}


def robot(**changes: Any) -> OrthogonalRobot:
    plant = OrthogonalRobot(replace(NOMINAL, **changes))
    plant.reset(1, 20.0)
    return plant


def rest(_: int) -> tuple[float, float, float]:
    return 0.0, 0.0, 0.0


def run(
    plant: OrthogonalRobot, ticks: int, pulses: Pulses = rest, lift: float = 0.0, enable: float = 1.0
) -> Columns:
    """Record measurements and ground truth by name, one row per tick of 1 ms and one at the end."""
    rows, substeps = [], round(1e-3 / plant.timestep)
    for k in range(ticks):
        rows.append(np.concatenate([plant.sense(), plant.truth()]))
        plant.command(np.array([*pulses(k), enable, lift]))
        plant.advance(substeps)
    rows.append(np.concatenate([plant.sense(), plant.truth()]))
    names = [channel.name for channel in (*plant.readings, *plant.truths)]
    return dict(zip(names, np.array(rows).T, strict=True))


def vector(rows: Columns, name: str) -> Matrix:
    return np.stack([rows[f"{name}_{axis}"] for axis in AXES], axis=-1)


# tip, contact and force sensor


@pytest.mark.parametrize("tip", [100e3, 209e3, 300e3])
def test_the_tip_gives_way_by_the_series_of_tip_and_contact(tip: float) -> None:
    plant = robot(**PRESSED, tip_stiffness=tip)
    stiffness = 1.0 / (1.0 / tip + 1.0 / 1.2e6)
    depths, forces = [], []
    for _ in range(6):
        rows = run(plant, 200, lambda k: (0.0, 0.0, -2.0 if k == 0 else 0.0))
        depths.append(-rows["axis_z"][-1])
        forces.append(rows["contact_force"][-1])
    assert np.polyfit(depths, forces, 1)[0] == pytest.approx(stiffness, rel=2e-3)
    assert rows["stiffness"][-1] == pytest.approx(stiffness, rel=1e-12)
    assert rows["contact_force"][-1] == pytest.approx(-1.2e6 * rows["gap"][-1], rel=2e-3)


def test_the_nominal_tip_has_the_178_newtons_per_millimetre_of_the_paper() -> None:
    assert run(robot(), 1)["stiffness"][0] == pytest.approx(178e3, rel=1e-3)


def test_the_sensor_shows_the_force_on_the_tool() -> None:
    air = run(robot(), 100)
    assert vector(air, "force")[-1] == pytest.approx([0.0, 0.0, -WEIGHT], abs=1e-6)
    assert not air["contact_force"].any()
    # the mold pushes the tool up
    pressed = run(robot(**PRESSED), 300)
    assert pressed["contact_force"][-1] == pytest.approx(30e-6 * 178e3, rel=5e-3)
    assert pressed["force_z"][-1] == pytest.approx(pressed["contact_force"][-1] - WEIGHT, rel=1e-3)


def test_the_sensor_answers_with_200_hertz() -> None:
    plant = robot(force_bandwidth=200.0)
    force = run(plant, 6)["force_z"] / -WEIGHT
    time = 1e-3 * np.arange(1, 7)
    # the weight of the tip is there from the first step on
    assert force[1:] == pytest.approx(1.0 - np.exp(-400.0 * math.pi * time), abs=1e-3)


def test_channels_have_noise_and_resolution() -> None:
    readings = {channel.name: channel for channel in robot().readings}
    assert {readings[f"position_{axis}"].quantum for axis in AXES} == {1e-6}
    assert {readings[f"force_{axis}"].quantum for axis in AXES} == {0.178}
    assert {readings[f"force_{axis}"].noise for axis in AXES} == {0.05}
    assert [channel.quantum for channel in robot().commands] == [1.0, 1.0, 1.0, 0.0, 0.0]


def test_without_enable_pulses_are_lost() -> None:
    plant = robot()
    before = run(plant, 20)
    lost = run(plant, 20, lambda _: (5.0, 5.0, 5.0), enable=0.0)
    again = run(plant, 20)
    for axis in AXES:
        name = f"position_{axis}"
        assert abs(again[name][-1] - before[name][-1]) < 5e-6, axis
        assert abs(lost[name][-1] - before[name][-1]) < 5e-6, axis


# friction of ball and mold


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.4])
def test_a_ball_that_slides_is_held_back_by_coulomb_friction(friction: float) -> None:
    plant = robot(**PRESSED, friction=friction)
    rows = run(plant, 400, lambda k: (2.0, 1.0, 0.0))
    late = slice(150, None)
    force, load = vector(rows, "friction")[late], rows["contact_force"][late]
    assert np.linalg.norm(force, axis=1) / load == pytest.approx(friction, rel=1e-3)
    motion = np.diff(vector(rows, "ball"), axis=0)[late]
    assert (force[1:] * motion).sum(axis=1) == pytest.approx(
        -friction * load[1:] * np.linalg.norm(motion, axis=1), rel=1e-2
    )
    # without load for one step there would be a hop
    assert load.min() > 1.0


@pytest.mark.parametrize(("impedance", "share"), [(0.95, 1.0), (0.8, 4.0 / 19.0), (0.5, 1.0 / 19.0)])
@pytest.mark.parametrize("friction", [0.2, 0.4])
def test_sliding_lifts_the_ball_by_less_than_two_micrometres(
    friction: float, impedance: float, share: float
) -> None:
    # MuJoCo's contact gives way by mu v c / k while it slides: 0.8 and 1.7 um at 10 mm/s
    def height(friction: float) -> float:
        plant = robot(**PRESSED, friction=friction, timestep=2.5e-5, contact_impedance=impedance)
        rows = run(plant, 60, lambda k: (10.0 if k > 20 else 0.0, 0.0, 0.0))
        return float((rows["contact_force"][-10:] / 1.2e6 + rows["gap"][-10:]).mean())

    # the way along the mold makes 0.03 um without friction, too
    lift = height(friction) - height(1e-4)
    assert lift == pytest.approx(share * friction * 0.01 * 500.0 / 1.2e6, rel=0.05)


@pytest.mark.parametrize(("impedance", "keeps"), [(0.95, False), (0.5, True)])
def test_an_impedance_of_a_half_keeps_the_load_of_a_tip_that_breaks_away(
    impedance: float, keeps: bool
) -> None:
    # soft across, it leaps at 45 mm/s: mu v c is more than the 5 N, so MuJoCo lifts it out of the mold
    changes = {"friction": 0.4, "friction_ratio": 1.5, "tip_lateral": 0.2, "timestep": 2.5e-5}
    plant, loads = robot(**PRESSED, **changes, contact_impedance=impedance), []
    load = [channel.name for channel in plant.truths].index("contact_force")
    for k in range(4000):
        plant.sense()
        if k % 40 == 0:
            plant.command(np.array([0.0, 10.0 if k // 800 % 2 == 0 else -10.0, 0.0, 1.0, 0.0]))
        plant.advance(1)
        loads.append(plant.truth()[load])
    assert (min(loads[1000:]) > 4.0) == keeps


def test_sliding_adds_up_way_preston_and_work() -> None:
    rows = run(robot(**PRESSED), 600, lambda k: (2.0, 0.0, 0.0))
    way = np.linalg.norm(np.diff(vector(rows, "ball"), axis=0)[300:], axis=1).sum()
    assert rows["slid"][-1] - rows["slid"][300] == pytest.approx(way, rel=1e-3)
    load = np.diff(rows["rubbed"])[300:] / np.diff(rows["slid"])[300:]
    assert load == pytest.approx(
        0.5 * (rows["contact_force"][300:-1] + rows["contact_force"][301:]), rel=5e-3
    )
    work = np.diff(rows["friction_work"])[300:]
    assert work == pytest.approx(0.2 * np.diff(rows["rubbed"])[300:], rel=1e-3)


@pytest.mark.parametrize("tip", [100e3, 209e3, 400e3])
def test_the_ball_does_not_hop(tip: float) -> None:
    sign = [1.0 if (k // 10) % 2 == 0 else -1.0 for k in range(200)]
    rows = run(robot(**PRESSED, tip_stiffness=tip, friction=0.4), 200, lambda k: (2.0, 10.0 * sign[k], 0.0))
    assert rows["contact_force"][50:].min() > 1.0


def test_a_ball_sticks_until_friction_breaks_away() -> None:
    # break-away at 0.2 * 5.3 N / 209 N/mm: 5.1 um
    plant = robot(**PRESSED)
    run(plant, 300)
    held = run(plant, 300, lambda k: (1.0 if k < 3 else 0.0, 0.0, 0.0))
    assert held["axis_x"][-1] - held["axis_x"][0] == pytest.approx(3e-6, abs=2e-8)
    # MuJoCo's friction creeps by 1 um/s per newton
    assert abs(held["ball_x"][-1] - held["ball_x"][0]) < 0.4e-6
    assert held["friction_x"][-1] == pytest.approx(-3e-6 * 209e3, rel=0.1)
    creep = run(plant, 500)["ball_x"]
    assert abs(creep[-1] - creep[0]) < 0.6e-6
    slid = run(plant, 300, lambda k: (1.0 if k < 10 else 0.0, 0.0, 0.0))["ball_x"]
    assert slid[-1] - slid[0] > 5e-6


# drives


def swing(half_period: int, ticks: int = 600, **changes: Any) -> float:
    """Peak to peak of the x axis in air under squares of +-10 mm/s, um."""
    sign = [1.0 if (k // half_period) % 2 == 0 else -1.0 for k in range(ticks)]
    axis = run(robot(**changes), ticks, lambda k: (10.0 * sign[k], 0.0, 0.0))["axis_x"][ticks // 2 :]
    return float(np.ptp(axis)) * 1e6


@pytest.mark.parametrize(
    ("half_period", "measured", "tolerance"),
    [(1, 0.24, 0.05), (2, 1.5, 0.2), (5, 18.7, 1.0), (10, 73.7, 2.0), (20, 190.0, 4.0), (50, 488.0, 5.0)],
)
def test_free_response_to_squares(half_period: int, measured: float, tolerance: float) -> None:
    # 10 um times half_period are commanded: at 500 Hz the drive passes 2 %, at 10 Hz all but 2 %
    assert swing(half_period) == pytest.approx(measured, abs=tolerance)


def test_the_drives_end_where_the_pulses_say() -> None:
    plant = robot()
    rows = run(plant, 800, lambda k: (7.0, -3.0, 1.0) if k < 100 else (0.0, 0.0, 0.0))
    moved = vector(rows, "axis")[-1] - vector(rows, "axis")[0]
    assert moved == pytest.approx([700e-6, -300e-6, 100e-6], abs=0.1e-6)
    assert vector(rows, "reference")[-1] == pytest.approx(vector(rows, "axis")[-1], abs=0.1e-6)
    assert vector(rows, "ball")[-1] == pytest.approx(vector(rows, "axis")[-1], abs=0.1e-6)


def glitch(**changes: Any) -> float:
    """Range of the error of the z axis in air after a reversal at 0.1 mm/s, um."""
    # a pulse every 10 ms
    rows = run(robot(**changes), 4000, lambda k: (0.0, 0.0, (k % 10 == 0) * (1.0 if k < 2000 else -1.0)))
    # means of 10 ms
    error = (rows["axis_z"] - rows["reference_z"])[1:].reshape(-1, 10).mean(axis=1)
    return float(np.ptp(error[150:])) * 1e6


def test_a_reversal_costs_less_when_balls_roll_than_when_friction_is_dry() -> None:
    none, rolling, dry = glitch(drive_friction=0.0), glitch(), glitch(drive_rolling_way=0.0)
    # a reversal of 2 N moves 8 kg * 500 rad/s * 80 1/s by 12.5 um, less the part of the integral
    assert 3.0 < dry < 12.5
    assert none < rolling < 0.35 * dry


def test_an_axis_stops_at_the_end_of_its_stroke() -> None:
    rows = run(robot(stroke_z=0.02), 900, lambda k: (0.0, 0.0, 20.0))
    assert rows["axis_z"][-1] == pytest.approx(0.01, abs=1e-4)


# geometry


def nearest(mold: str, centre: Matrix) -> Matrix:
    """Foot of the perpendicular by brute force."""
    spread, foot = 1e-3, centre[:2]
    for _ in range(30):
        grid = np.linspace(-spread, spread, 21)
        x, y = np.meshgrid(foot[0] + grid, foot[1] + grid, indexing="ij")
        with np.errstate(invalid="ignore"):
            z = MOLDS[mold].height(x, y)
        square = (x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z - centre[2]) ** 2
        best = np.nanargmin(square)
        foot, spread = np.array([x.flat[best], y.flat[best]]), 0.3 * spread
    return np.array([*foot, float(MOLDS[mold].height(*foot))])


@pytest.mark.parametrize("mold", list(MOLDS))
@pytest.mark.parametrize("place", [(0.05e-3, 0.0), (0.9e-3, -0.4e-3), (-1.1e-3, -1.0e-3)])
def test_the_contact_is_the_nearest_point_of_the_mold(mold: str, place: tuple[float, float]) -> None:
    normal = MOLDS[mold].normal(*place)
    start = np.array([*place, float(MOLDS[mold].height(*place))]) + (BALL + 50e-6) * normal
    plant = robot(mold=mold, start_x=start[0], start_y=start[1], start_z=start[2])
    rows = run(plant, 1)
    assert vector(rows, "contact")[0] == pytest.approx(nearest(mold, start), abs=1e-9)
    assert vector(rows, "contact")[0, :2] == pytest.approx(place, abs=1e-11)
    assert vector(rows, "normal")[0] == pytest.approx(normal, abs=1e-9)
    assert rows["gap"][0] == pytest.approx(50e-6, abs=1e-11)


def test_a_ball_that_moves_stays_on_the_surface() -> None:
    # along x through a dimple of the LED mold, pressed by position alone
    plant = robot(start_x=0.0, start_z=BALL - 30e-6)
    rows = run(plant, 300, lambda k: (2.0, 0.0, 0.0))
    ball, contact, normal = (vector(rows, name)[50:] for name in ("ball", "contact", "normal"))
    # the ground truth of the mold is one plant step old: 0.2 um
    assert ball - contact == pytest.approx((BALL + rows["gap"][50:, None]) * normal, abs=0.4e-6)
    assert contact[:, 2] == pytest.approx(MOLDS["led"].height(contact[:, 0], contact[:, 1]), abs=1e-12)


def rotation(vector: Matrix) -> Matrix:
    """Rotation matrix of a rotation vector (series)."""
    skew = np.array([[0, -vector[2], vector[1]], [vector[2], 0, -vector[0]], [-vector[1], vector[0], 0]])
    result, term = np.eye(3), np.eye(3)
    for n in range(1, 20):
        term = term @ skew / n
        result = result + term
    return result


def test_a_misplaced_mold_is_met_where_it_is() -> None:
    shift, tilt = np.array([50e-6, -30e-6, 70e-6]), np.array([0.02, -0.03, 0.1])
    place = (0.6e-3, 0.3e-3)
    normal = MOLDS["led"].normal(*place)
    centre = np.array([*place, float(MOLDS["led"].height(*place))]) + (BALL - 20e-6) * normal
    turned = rotation(tilt)
    start = shift + turned @ centre
    pose = dict(
        zip(("shift_x", "shift_y", "shift_z", "tilt_x", "tilt_y", "tilt_z"), [*shift, *tilt], strict=True)
    )
    at = dict(zip(("start_x", "start_y", "start_z"), start, strict=True))
    rows = run(robot(**pose, **at), 1)
    assert vector(rows, "contact")[0, :2] == pytest.approx(place, abs=1e-10)
    assert vector(rows, "normal")[0] == pytest.approx(turned @ normal, abs=1e-9)
    assert rows["gap"][0] == pytest.approx(-20e-6, abs=1e-11)


def test_a_step_lifts_the_ball() -> None:
    step: dict[str, Any] = {"step_height": 20e-6, "step_place": 0.2e-3, "step_width": 0.4e-3}
    rows = run(robot(**PRESSED, **step), 500, lambda k: (2.0, 0.0, 0.0))
    x = rows["contact_x"]
    plain = MOLDS["saddle"].height(x, rows["contact_y"])
    assert (rows["contact_z"] - plain)[x < 0.2e-3] == pytest.approx(0.0, abs=1e-12)
    assert (rows["contact_z"] - plain)[x > 0.6e-3] == pytest.approx(20e-6, abs=1e-12)


def test_a_mold_that_sinks_is_lost_and_one_that_rises_presses() -> None:
    plant = robot(**PRESSED)
    assert run(plant, 200)["contact_force"][-1] > 5.0
    lost = run(plant, 100, lift=-100e-6)
    assert lost["contact_force"][-1] == 0.0
    assert lost["gap"][-1] == pytest.approx(70e-6, abs=1e-6)
    back = run(plant, 300, lift=10e-6)
    assert back["contact_force"][-1] == pytest.approx(40e-6 * 178e3, rel=5e-3)


# squares across the feed


def gain(half_period: int, **changes: Any) -> float:
    """Sliding distance over feed distance with squares of +-10 mm/s across it."""
    sign = [1.0 if (k // half_period) % 2 == 0 else -1.0 for k in range(400)] if half_period else [0.0] * 400
    rows = run(robot(**PRESSED, **changes), 400, lambda k: (2.0, 10.0 * sign[k], 0.0))
    return float((rows["slid"][-1] - rows["slid"][200]) / (rows["axis_x"][-1] - rows["axis_x"][200]))


def test_squares_at_500_hertz_do_not_reach_the_mold_and_at_50_hertz_they_do() -> None:
    none = gain(0)
    assert gain(1) == pytest.approx(none, rel=0.01)
    assert gain(10) > 2.0 * none


def test_a_tip_that_is_soft_across_oscillates_less() -> None:
    assert gain(10, tip_lateral=0.25) < 0.7 * gain(10)


# numerics and repeatability


def test_half_the_plant_step_gives_the_same_sliding() -> None:
    assert gain(10) == pytest.approx(gain(10, timestep=5e-5), rel=0.01)


def trace(plant: OrthogonalRobot, seed: int) -> bytes:
    plant.reset(seed, 1.0)
    return b"".join(column.tobytes() for column in run(plant, 60, lambda k: (3.0, -1.0, -5.0)).values())


def test_every_run_is_the_same() -> None:
    plant = OrthogonalRobot()
    first = trace(plant, 11)
    assert trace(plant, 12) == first
    assert trace(OrthogonalRobot(), 11) == first


def test_ten_substeps_are_ten_steps() -> None:
    one, ten = robot(**PRESSED), robot(**PRESSED)
    for _ in range(50):
        one.sense()
        one.command(np.array([3.0, -2.0, 1.0, 1.0, 0.0]))
        one.advance(10)
        for _ in range(10):
            ten.sense()
            ten.command(np.array([3.0, -2.0, 1.0, 1.0, 0.0]))
            ten.advance(1)
    assert one.sense().tobytes() == ten.sense().tobytes()
    assert one.truth().tobytes() == ten.truth().tobytes()


# parameters


def test_every_mold_can_be_chosen() -> None:
    kind = typing.get_type_hints(OrthogonalRobotParameters)["mold"]
    field = OrthogonalRobotParameters.__dataclass_fields__["mold"]
    assert typing.get_args(kind) == field.metadata["options"] == tuple(MOLDS)


# what the controller's model does not have


def test_wood_sticks_better_than_it_slides() -> None:
    # pulled sideways: the friction rises to its static share, then falls to the kinetic one
    for ratio in (1.0, 1.5):
        plant = robot(**PRESSED, friction=0.2, friction_ratio=ratio, tip_lateral=0.5)
        rows = run(plant, 400, lambda k: (0.5 * (k % 2), 0.0, 0.0) if k < 20 else (2.0, 0.0, 0.0))
        share = np.abs(rows["friction_x"][20:]) / rows["contact_force"][20:]
        assert share.max() == pytest.approx(0.2 * ratio, rel=0.05)
        assert share[300:].mean() < 0.2 * (1.02 + 0.9 * (ratio - 1.0))


def test_per_revolutioned_sensor_shows_the_same_force_in_its_own_axes() -> None:
    # pressed and pulled along x
    def reported(k: int) -> tuple[float, float, float]:
        return (2.0 if k < 20 else 0.0, 0.0, 0.0)

    straight, turned = (run(robot(**PRESSED, sensor_turn=turn), 300, reported) for turn in (0.0, 0.5))
    force, shown = vector(straight, "force")[-1], vector(turned, "force")[-1]
    assert abs(force[0]) > 0.5
    rotation = np.array([[np.cos(0.5), np.sin(0.5)], [-np.sin(0.5), np.cos(0.5)]])
    assert shown[:2] == pytest.approx(rotation @ force[:2], abs=1e-6)
    assert shown[2] == pytest.approx(force[2], abs=1e-9)
