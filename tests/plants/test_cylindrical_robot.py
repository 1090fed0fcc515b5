"""The cylindrical robot against closed forms."""

import math
import os
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from plants.base.plant import PlantError
from plants.cylindrical_robot import AXES, CylindricalRobot, edge
from plants.cylindrical_robot_parameters import RPM, TURN, CylindricalRobotParameters
from plants.tools import burr

Matrix = np.ndarray[Any, Any]
Columns = dict[str, Matrix]
Law = Callable[[float, dict[str, float]], dict[str, float]]

TICK = 0.01
RIGID: dict[str, Any] = {"flexible": False, "coulomb_friction": 0.0}
PAPER: dict[str, Any] = {"drive_frequency": 280.0}
"""The drives of the closed forms, eq. 1."""
UNIFORM: dict[str, Any] = {
    "burr_height_least": 4e-3, "burr_height_most": 4e-3, "burr_thickness_least": 2e-3,
    "burr_thickness_most": 2e-3, "burr_gaps": 0.0,
}  # fmt: skip


def robot(duration: float = 20.0, seed: int = 1, **changes: Any) -> CylindricalRobot:
    plant = CylindricalRobot(CylindricalRobotParameters(**{**PAPER, **changes}))
    plant.reset(seed, duration)
    return plant


def named(plant: CylindricalRobot) -> dict[str, float]:
    return {channel.name: value for channel, value in zip(plant.truths, plant.truth(), strict=True)}


def run(plant: CylindricalRobot, ticks: int, law: Law, tick: float = TICK) -> Columns:
    """Return ground truth, and measurements as `read_...`, by name; one row per tick."""
    rows = []
    for k in range(ticks):
        sensed = zip((channel.name for channel in plant.readings), plant.sense(), strict=True)
        row = named(plant) | {f"read_{name}": value for name, value in sensed}
        rows.append(row)
        orders = law(k * tick, row)
        plant.command(np.array([orders.get(channel.name, channel.start) for channel in plant.commands]))
        plant.advance(round(tick / plant.timestep))
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def lag(speed: float) -> complex:
    """Eq. 1 of the paper at a frequency in rad/s."""
    return 280.0**2 / (280.0**2 - speed**2 + 2j * 0.52 * 280.0 * speed)


def response(plant: CylindricalRobot, axis: int, speed: float) -> complex:
    """Velocity of a motor over its command, from the encoder."""
    h, amplitude = plant.timestep, 0.005
    # a sample that is held for a plant step stands for its middle
    rows = run(
        plant, round(1.2 / h),
        lambda time, _: {f"axis{axis}_velocity": amplitude * math.cos(speed * (time + h / 2))}, h,
    )  # fmt: skip
    position = rows[f"read_axis{axis}_position"]
    time = h * np.arange(len(position))
    late = time > 0.4
    parts = np.stack(
        [np.ones(late.sum()), time[late], np.cos(speed * time[late]), np.sin(speed * time[late])]
    )
    found = np.linalg.lstsq(parts.T, position[late], rcond=None)[0]
    return complex(found[2], -found[3]) * 1j * speed / amplitude


# drives


def test_without_enable_the_brakes_stop_the_arm_and_nothing_snaps_back() -> None:
    def law(time: float, _: dict[str, float]) -> dict[str, float]:
        if time < 0.5:
            return {"axis1_velocity": 0.2, "axis3_velocity": 0.2}
        # commands are of no use while the drives are off
        on = time >= 1.0
        return {"axis3_velocity": 0.0 if on else 0.2, "enable": float(on)}

    rows = run(robot(2.0), 150, law)
    place, force = rows["read_axis3_position"], rows["axis3_force"]
    assert place[49] - place[10] > 0.07
    assert 0.0 < place[55] - place[50] < 5e-3
    assert np.ptp(place[56:100]) < 1e-5
    assert not force[52:100].any()
    assert abs(place[149] - place[99]) < 5e-4
    assert np.ptp(rows["read_axis1_position"][60:100]) < 1e-5


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("speed", [50.0, 150.0, 280.0])
def test_every_velocity_loop_is_the_second_order_lag_of_the_paper(axis: int, speed: float) -> None:
    error = response(robot(2.0, **RIGID), axis, speed) / lag(speed)
    # axis 1 is tuned for another reach
    assert abs(error) == pytest.approx(1.0, abs=0.02)
    assert abs(np.angle(error, deg=True)) < 4.0


@pytest.mark.parametrize("timestep", [5e-4, 2e-3])
def test_other_plant_steps_have_the_same_drives(timestep: float) -> None:
    error = response(robot(2.0, timestep=timestep, **RIGID), 3, 280.0) / lag(280.0)
    assert abs(error) == pytest.approx(1.0, abs=0.05)
    assert abs(np.angle(error, deg=True)) < 3.0


@pytest.mark.parametrize(("axis", "joint"), [(1, "coupling_1"), (3, "coupling_3")])
def test_the_motor_feels_its_load_through_the_coupling(axis: int, joint: str) -> None:
    plant = robot(2.0, coulomb_friction=0.0, tuned_radius=math.hypot(0.75 - 0.0937789, 0.0971109))
    load = plant.model.joint(joint)
    stiffness, damping = load.stiffness[0], load.damping[0]
    inertia = stiffness / (TURN * 60.0) ** 2
    total = plant.model.actuator(f"axis_{axis}").gainprm[0] / 280.0**2
    for speed in (150.0, 280.0):
        s = 1j * speed
        spring = stiffness + damping * s
        # load of the motor: itself and the mass after the spring
        carried = (total - inertia) + inertia * spring / (inertia * s * s + spring)
        exact = total * 280.0**2 / (carried * s * s + 2 * 0.52 * 280.0 * total * s + total * 280.0**2)
        assert response(plant, axis, speed) == pytest.approx(exact, abs=0.04)
        plant.reset(1, 2.0)


def test_a_drive_brings_its_largest_force_and_no_more() -> None:
    rows = run(robot(1.0, **RIGID), 30, lambda time, _: {"axis3_velocity": 1.0})
    assert rows["axis3_force"].max() == pytest.approx(600.0)
    # 600 N move 85 kg
    speed = np.diff(rows["read_axis3_position"]) / TICK
    assert np.diff(speed).max() / TICK == pytest.approx(600.0 / 85.0, rel=0.02)


def test_coulomb_friction_holds_at_rest_and_brakes_in_motion() -> None:
    rows = run(robot(2.0), 100, lambda time, _: {"axis3_velocity": 0.03})
    assert rows["axis3_force"][-1] == pytest.approx(0.05 * 600.0, rel=1e-3)
    # a push below friction: the drive alone gives way by its stiffness
    moved = {}
    for friction in (0.0, 0.05):
        plant = robot(2.0, coulomb_friction=friction)
        plant.data.xfrc_applied[plant.model.body("wrist_4").id, 0] = 25.0
        moved[friction] = np.ptp(run(plant, 100, lambda time, _: {})["read_axis3_position"])
    assert moved[0.0] == pytest.approx(25.0 / (85.0 * 280.0**2), rel=0.2)
    assert moved[0.05] < 0.6 * moved[0.0]


def test_the_position_loop_lags_by_the_velocity_over_its_gain() -> None:
    def servo(time: float, row: dict[str, float]) -> dict[str, float]:
        return {"axis3_velocity": 13.0 * (start + 0.05 * time - row["read_axis3_position"])}

    plant = robot(5.0)
    start = plant.sense()[2]
    rows = run(plant, 300, servo)
    error = start + 0.05 * TICK * np.arange(300) - rows["read_axis3_position"]
    assert error[-1] == pytest.approx(0.05 / 13.0, rel=0.005)


# geometry


def test_the_tip_is_where_cylindrical_coordinates_and_wrist_say() -> None:
    plant = robot()
    wanted = {1: 0.3, 2: -0.05, 3: 0.8, 4: 0.7, 5: -0.4, 6: 1.0}
    for n, value in wanted.items():
        plant.data.joint(f"axis_{n}").qpos[0] = value
        plant.data.act[n - 1] = value
    readings = plant.sense()
    assert readings[:6] == pytest.approx(list(wanted.values()))
    # tool axis: down, tilted by axis 5 about y, turned by the axes 4 and 1 about z
    tilt, turn = wanted[5], wanted[1] + wanted[4]
    axis = (-math.sin(tilt) * math.cos(turn), -math.sin(tilt) * math.sin(turn), -math.cos(tilt))
    wrist = (0.8 * math.cos(0.3), 0.8 * math.sin(0.3), -0.05)
    truth = named(plant)
    for component, at, along in zip("xyz", wrist, axis, strict=True):
        assert truth[f"tip_{component}"] == pytest.approx(at + 0.2 * along, abs=1e-12)


def test_it_starts_above_the_edge_at_rest() -> None:
    plant = robot()
    rows = run(plant, 50, lambda time, _: {})
    assert rows["distance"][-1] == pytest.approx(0.0, abs=1e-9)
    assert rows["deviation"][-1] == pytest.approx(0.0, abs=1e-9)
    assert rows["deviation_across"][-1] == pytest.approx(0.02)
    assert np.ptp(rows["read_axis3_position"]) < 1e-9


def test_an_edge_that_does_not_fit_is_rejected_with_a_hint() -> None:
    with pytest.raises(ValueError, match=r"`0\.2` m\nhint: start, corner and end"):
        CylindricalRobot(CylindricalRobotParameters(edge_radius=0.2))


# the cut


def straight(feed: float, **changes: Any) -> Columns:
    """Cut an edge along the arm at a constant feed, tip on the edge, in a burr of 4 by 2 mm."""
    along = {
        "edge_start_x": 0.6, "edge_start_y": 0.0, "edge_corner_x": 0.7, "edge_corner_y": 0.0,
        "edge_end_x": 0.9, "edge_end_y": 0.0, "edge_radius": 0.0, "start_height": 0.0,
    }  # fmt: skip
    plant = robot(**{**along, **UNIFORM, **changes})
    return run(plant, round(0.28 / feed / TICK), lambda time, _: {"axis3_velocity": feed, "workpiece": 1.0})


def test_the_spindle_slips_until_its_torque_is_that_of_the_cut() -> None:
    rows = straight(0.05)
    cutting = (rows["distance"] > 0.15) & (rows["distance"] < 0.25)
    speed, torque = rows["spindle_speed"][cutting], rows["cutting_torque"][cutting]
    slip, most = 1.0 - speed / (18_000.0 * RPM), 0.13309
    rated = 600.0 / (17_500.0 * RPM)
    kloss = 2.0 * 2.5 * rated / (slip / most + most / slip)
    assert kloss == pytest.approx(torque + 0.008, rel=5e-3)
    chip = 0.05 / (2.0 * speed / TURN)
    by_hand = 2.0 * 2e-3 / TURN * (9e8 * chip * 4e-3 + 2e4 * 6e-3 * math.acos(1.0 - 4.0 / 6.0))
    assert torque == pytest.approx(by_hand, rel=5e-3)
    assert rows["read_spindle_speed"][cutting] == pytest.approx(speed, abs=1.0)


def test_the_reaction_of_the_cut_reaches_the_drives() -> None:
    rows = straight(0.05)
    air = rows["distance"] < 0.028
    cutting = (rows["distance"] > 0.15) & (rows["distance"] < 0.25)
    more = rows["axis3_force"][cutting].mean() - rows["axis3_force"][air][-10:].mean()
    assert more == pytest.approx(0.5 * rows["cutting_force"][cutting].mean(), rel=0.02)


def test_what_is_cut_is_gone() -> None:
    rows = straight(0.05)
    assert rows["burr_left"][0] == pytest.approx(0.26 * 4e-3 * 2e-3)
    total = rows["burr_left"] + rows["burr_removed"]
    assert rows["burr_left"][-1] < 0.05 * rows["burr_left"][0]
    # gouges are cut too, but are not above the edge
    assert np.all(np.diff(total) > -1e-15)
    assert rows["finish_low"][-1] == pytest.approx(rows["deviation"].min(), abs=2e-5)
    assert rows["finish_high"][-1] == pytest.approx(max(rows["deviation"].max(), 0.0), abs=2e-5)


def test_a_harder_burr_stalls_the_spindle() -> None:
    rows = straight(0.1, cutting_pressure=2.5e9)
    assert rows["spindle_speed"].min() < 1000.0 * RPM
    assert rows["cutting_force"].max() < 600.0


def test_without_the_part_nothing_is_cut() -> None:
    plant = robot()
    rows = run(plant, 100, lambda time, _: {"axis3_velocity": 0.05})
    assert rows["cutting_torque"].max() == 0.0
    assert rows["burr_removed"][-1] == 0.0


def test_a_tool_that_crosses_the_part_stops_the_plant() -> None:
    plant = robot(start_height=0.0)
    law: Law = lambda time, row: {"axis1_velocity": 0.15, "workpiece": 1.0}  # noqa: E731
    with pytest.raises(PlantError, match=r"inside the part, limit `0\.012000` m\nhint: lift the tool"):
        run(plant, 500, law)


# the burr


@pytest.mark.parametrize("processor", ["Nehalem", "Haswell"])
def test_a_seed_gives_the_same_burr_on_every_processor(processor: str) -> None:
    code = (
        "import numpy as np; from plants.tools import burr; "
        "from plants.cylindrical_robot_parameters import CylindricalRobotParameters as P; "
        "print([part.tobytes().hex() for part in burr.draw(P(), 0.02, np.random.default_rng(5))])"
    )
    # numpy's algebra is that of OpenBLAS, in the version for this processor
    environment = {**os.environ, "OPENBLAS_CORETYPE": processor}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True)
    here = burr.draw(CylindricalRobotParameters(), 0.02, np.random.default_rng(5))
    assert done.stdout.decode().strip() == str([part.tobytes().hex() for part in here])


def test_the_burr_is_uniform_between_its_limits_and_smooth() -> None:
    p = CylindricalRobotParameters(burr_gaps=0.0)
    drawn = [burr.draw(p, 0.2236, np.random.default_rng(seed)) for seed in range(300)]
    height, thickness = (np.array(columns) for columns in zip(*drawn, strict=True))
    for column, least, most in ((height, 2e-3, 5e-3), (thickness, 1e-3, 2e-3)):
        share = (column - least) / (most - least)
        assert 0.0 <= share.min() < 0.01 < 0.99 < share.max() <= 1.0
        assert [np.mean(share < q) for q in (0.25, 0.5, 0.75)] == pytest.approx([0.25, 0.5, 0.75], abs=0.03)
        # correlation exp(-1) of the Gaussian at the correlation length, a little less of the copula
        near, far = share[:, :-48], share[:, 48:]
        assert np.corrcoef(near.ravel(), far.ravel())[0, 1] == pytest.approx(0.35, abs=0.06)
    assert abs(np.corrcoef(height.ravel(), thickness.ravel())[0, 1]) < 0.06


def test_a_burr_of_fine_bins_needs_no_more_memory_than_its_noise() -> None:
    p = CylindricalRobotParameters(burr_pitch=1e-4, burr_correlation=0.1)
    tracemalloc.start()
    try:
        height, _ = burr.draw(p, 0.2, np.random.default_rng(1))
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert len(height) == 2000
    # 8000 numbers of noise, and some lists of 6000; every tap with its own would be 96 MB
    assert most < 2e6


def test_gaps_are_as_many_and_as_long_as_they_should_be() -> None:
    p = CylindricalRobotParameters()
    for seed in range(100):
        height, _ = burr.draw(p, 0.2236, np.random.default_rng(seed))
        share = np.mean(height == 0.0) * 0.2236
        assert share <= 2 * 0.02 + 1e-3
        assert share == 0.0 or share > 0.006 - 1e-3


def test_the_same_seed_gives_the_same_run() -> None:
    def cut(seed: int) -> Columns:
        plant = robot(seed=seed, start_height=0.0)
        return run(
            plant, 200, lambda time, _: {"axis3_velocity": 0.05, "axis1_velocity": 0.07, "workpiece": 1.0}
        )

    first, again, other = cut(3), cut(3), cut(4)
    assert all(np.array_equal(first[name], again[name]) for name in first)
    assert first["burr_left"][0] != other["burr_left"][0]


def test_half_the_plant_step_changes_little() -> None:
    coarse, fine = straight(0.05), straight(0.05, timestep=5e-4)
    assert coarse["spindle_speed"] == pytest.approx(fine["spindle_speed"], abs=2.0 * RPM)
    assert coarse["read_axis3_position"] == pytest.approx(fine["read_axis3_position"], abs=1e-5)


# what the controller's model does not have


@pytest.mark.parametrize(("axis", "reach"), [(1, 0.75), (3, 1.0)])
def test_the_gear_has_play(axis: int, reach: float) -> None:
    # no force within the play, the spring of the coupling beyond
    plant, stiff = robot(backlash=3e-4), robot()
    joint = plant.model.joint(f"coupling_{axis}")
    place, dof = int(joint.qposadr[0]), int(joint.dofadr[0])
    stiffness = float(stiff.model.jnt_stiffness[stiff.model.joint(f"coupling_{axis}").id])
    for at_tip, beyond in ((-1.4e-4, 0.0), (1.4e-4, 0.0), (2.5e-4, 1e-4), (-2.5e-4, -1e-4)):
        plant.data.qpos[place] = at_tip / reach
        plant.sense()
        force = -float(plant.data.qfrc_spring[dof])
        assert force == pytest.approx(stiffness * beyond / reach, rel=1e-9, abs=1e-12)


def test_friction_after_the_gear_bends_it_where_the_encoder_does_not_see_it() -> None:
    # 3 % of 600 N on the spring of the coupling, in either direction;
    # Dahl's model has reversed after some such distances
    plant = robot(reversal_friction=0.03, reversal_way=1e-4, coulomb_friction=0.0, coupling_damping=0.3)
    coupling = plant.model.joint("coupling_3")
    stiffness = float(plant.model.jnt_stiffness[coupling.id])
    bent = []

    def law(time: float, _: dict[str, float]) -> dict[str, float]:
        bent.append(float(plant.data.qpos[int(coupling.qposadr[0])]))
        return {"axis3_velocity": 0.02 if time < 1.0 else -0.02}

    run(plant, 200, law)
    forth, back = np.mean(bent[60:95]), np.mean(bent[160:195])
    assert 0.5 * (back - forth) == pytest.approx(0.03 * 600.0 / stiffness, rel=0.02)
    assert abs(back + forth) < 0.02 * abs(back - forth)


@pytest.mark.parametrize(
    ("axis", "period", "force"), [(1, TURN / 160.0 / 24.0, 300.0), (3, 0.02 / 24.0, 600.0)]
)
def test_the_motor_cogs(axis: int, period: float, force: float) -> None:
    plant = robot(cogging=0.02)
    joint = plant.model.joint(f"axis_{axis}")
    place, dof = int(joint.qposadr[0]), int(joint.dofadr[0])
    start, found = float(plant.data.qpos[place]), []
    for i in range(48):
        plant.data.qpos[place] = start + 2.0 * period * i / 48.0
        plant.data.qvel[:] = 0.0
        plant.sense()
        plant.advance(1)
        found.append(float(plant.data.qfrc_applied[dof]))
    waves = np.abs(np.fft.rfft(found)) / 24.0
    assert waves[2] == pytest.approx(0.02 * force, rel=1e-6)
    assert np.delete(waves, 2).max() < 1e-6 * force


def test_noise_is_reported_to_the_harness() -> None:
    readings = robot(encoder_noise=2.0, spindle_noise=0.5).readings
    assert [channel.noise for channel in readings[:3]] == [2.0 * TURN / 640_000, 5e-6, 1e-5]
    assert readings[6].noise == 0.5
    # all but a switch
    assert [channel.name for channel in robot().readings if channel.noise == 0.0] == ["contact"]
    assert not any(channel.noise for channel in robot(encoder_noise=0.0, spindle_noise=0.0).readings)


def test_a_part_that_is_not_displaced_is_where_it_was_to_the_bit() -> None:
    p = CylindricalRobotParameters()
    taught = [[float(getattr(p, f"edge_{point}_{c}")) for c in "xyz"] for point in ("start", "corner", "end")]
    assert list(edge(p)[:3]) == taught


def test_a_displaced_part_is_shifted_and_turned_about_its_corner() -> None:
    p = CylindricalRobotParameters(part_x=1e-3, part_y=-2e-3, part_angle=0.01)
    taught = edge(CylindricalRobotParameters())
    moved = edge(p)
    assert moved[1] == pytest.approx([taught[1][0] + 1e-3, taught[1][1] - 2e-3, taught[1][2]], abs=1e-15)
    for a, b in ((taught[0], moved[0]), (taught[2], moved[2])):
        before, after = (
            np.array(point[:2]) - np.array(corner[:2]) for point, corner in ((a, taught[1]), (b, moved[1]))
        )
        turned = math.atan2(after[1], after[0]) - math.atan2(before[1], before[0])
        assert turned == pytest.approx(0.01, abs=1e-12)
        assert np.hypot(*after) == pytest.approx(np.hypot(*before), abs=1e-15)


@pytest.mark.parametrize("probe", [1.0, 0.0])
def test_the_touch_probe_feels_the_wall_beyond_its_pretravel(probe: float) -> None:
    # the tip starts above the start of its edge; another edge puts it 0.2 mm inside of the wall
    p, heading = CylindricalRobotParameters(start_height=0.015), math.radians(46.0)
    along, out = [math.cos(heading), math.sin(heading)], [math.sin(heading), -math.cos(heading)]
    x, y = (2e-4 * n - 0.07 * t for n, t in zip(out, along, strict=True))
    plant = robot(1.0, start_height=p.start_height, part_x=x, part_y=y, **RIGID)
    columns = run(plant, 3, lambda _, __: {"workpiece": 1.0, "probe": probe})
    assert columns["read_contact"][-1] == probe
    assert columns["probe_deflection"][-1] == pytest.approx(2e-4 * probe, abs=2e-6)
    assert columns["cutting_force"][-1] == 0.0
