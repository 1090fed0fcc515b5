"""The rotary arm against closed forms."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from plants.rotary_arm import RotaryArm
from plants.rotary_arm_parameters import RotaryArmParameters

Matrix = np.ndarray[Any, Any]
Columns = dict[str, Matrix]
Torque = Callable[[float], float]

TURN = 2.0 * math.pi
TICK = 1e-4

# only inertias, flexure, current loop and a spindle at constant speed; a command is the torque
QUIET = RotaryArmParameters(
    torque_gain=1.0, viscous_friction=0.0, coulomb_friction=0.0, ripple_torque=0.0, hum_torque=0.0,
    cutting_force=0.0, cutting_force_twice=0.0, cutting_noise=0.0, spindle_ripple=0.0,
    spindle_ripple_twelfth=0.0, feed=0.0,
)  # fmt: skip


def arm(duration: float = 1.0, seed: int = 1, **changes: Any) -> RotaryArm:
    plant = RotaryArm(replace(QUIET, **changes))
    plant.reset(seed, duration)
    return plant


def order(plant: RotaryArm, **values: float) -> Matrix:
    return np.array([values.get(channel.name, channel.start) for channel in plant.commands])


def truth(plant: RotaryArm) -> dict[str, float]:
    return {channel.name: value for channel, value in zip(plant.truths, plant.truth(), strict=True)}


def run(plant: RotaryArm, ticks: int, torque: Torque = lambda time: 0.0, **commands: float) -> Columns:
    """Ground truth by name, one row per tick and one at the end; the torque is held over each tick."""
    rows, substeps = [], round(TICK / plant.timestep)
    for k in range(ticks):
        plant.sense()
        rows.append(plant.truth())
        plant.command(order(plant, torque=torque(k * TICK), **commands))
        plant.advance(substeps)
    plant.sense()
    rows.append(plant.truth())
    table = np.array(rows).T
    return {channel.name: column for channel, column in zip(plant.truths, table, strict=True)}


def test_an_amplifier_that_is_off_gives_no_torque() -> None:
    on, off = run(arm(), 200, lambda _: 1.0), run(arm(), 200, lambda _: 1.0, enable=0.0)
    assert on["torque"][-1] == pytest.approx(1.0, abs=1e-3)
    assert np.all(off["torque"] == 0.0)
    assert np.all(off["arm_angle"] == off["arm_angle"][0])


# the arm as a linear system


def system(p: RotaryArmParameters) -> tuple[Matrix, Matrix]:
    """State matrix and input column; states: hub angle and speed, flexure angle and speed, motor torque."""
    speed = TURN * p.flexure_frequency
    stiffness, damping = p.arm_inertia * speed**2, 2.0 * p.flexure_damping * p.arm_inertia * speed
    hub = np.array([0.0, -p.viscous_friction, stiffness, damping, p.torque_gain]) / p.hub_inertia
    tool = np.array([0.0, 0.0, -stiffness, -damping, 0.0]) / p.arm_inertia
    bandwidth = TURN * p.current_bandwidth
    state = np.array([[0, 1, 0, 0, 0], hub, [0, 0, 0, 1, 0], tool - hub, [0, 0, 0, 0, -bandwidth]])
    return state, np.array([0.0, 0.0, 0.0, 0.0, bandwidth])


def exponential(matrix: Matrix) -> Matrix:
    """Matrix exponential by its series after halving."""
    halvings = max(0, math.ceil(math.log2(np.abs(matrix).sum(axis=1).max())) + 4)
    scaled, result, term = matrix / 2.0**halvings, np.eye(len(matrix)), np.eye(len(matrix))
    for n in range(1, 20):
        term = term @ scaled / n
        result = result + term
    for _ in range(halvings):
        result = result @ result
    return result


def tick(p: RotaryArmParameters) -> tuple[Matrix, Matrix]:
    """Exact step of the system over one tick with the torque held."""
    block = np.zeros((6, 6))
    block[:5, :5], block[:5, 5] = system(p)
    step = exponential(block * TICK)
    return step[:5, :5], step[:5, 5]


def exact(p: RotaryArmParameters, torque: Torque, ticks: int) -> Matrix:
    """States at every tick."""
    state, column = tick(p)
    states = np.zeros((ticks + 1, 5))
    for k in range(ticks):
        states[k + 1] = state @ states[k] + column * torque(k * TICK)
    return states


def three_tones(time: float) -> float:
    return sum(
        amplitude * math.cos(TURN * frequency * time)
        for amplitude, frequency in ((0.1, 20.0), (0.4, 120.0), (1.0, 500.0))
    )


def tool_error(timestep: float) -> float:
    plant = arm(timestep=timestep)
    reached = run(plant, 2000, three_tones)
    states = exact(plant.parameters, three_tones, 2000)
    error = 0.08 * (np.arcsin(reached["tip_depth"] / 0.08) - states[:, 0] - states[:, 2])
    return float(np.sqrt(np.mean(error**2)))


def test_the_tool_follows_the_exact_solution_within_40_nanometres() -> None:
    assert tool_error(2e-5) < 40e-9


def test_the_error_of_the_plant_step_is_of_second_order() -> None:
    assert 3.5 < tool_error(1e-4) / tool_error(5e-5) < 4.5


def wave(rows: Columns, column: str, frequency: float) -> complex:
    """Complex amplitude of one frequency in addition to offset and drift, after the transients."""
    time = TICK * np.arange(len(rows[column]))
    late = time > 0.1
    angle = TURN * frequency * time[late]
    parts = np.stack([np.ones(late.sum()), time[late], np.cos(angle), np.sin(angle)], axis=1)
    found = np.linalg.lstsq(parts, rows[column][late], rcond=None)[0]
    return complex(found[2], -found[3])


@pytest.mark.parametrize(("frequency", "error"), [(20.0, 1e-4), (120.0, 1e-3), (300.0, 2e-3), (500.0, 4e-3)])
def test_frequency_response_of_the_hub(frequency: float, error: float) -> None:
    plant = arm()
    rows = run(plant, 3000, lambda time: 0.5 * math.cos(TURN * frequency * time))
    state, column = tick(plant.parameters)
    z = np.exp(2j * math.pi * frequency * TICK)
    hub = 0.5 * np.linalg.solve(z * np.eye(5) - state, column)[0]
    assert abs(wave(rows, "arm_angle", frequency) / hub - 1.0) < error


@pytest.mark.parametrize("frequency", [100.0, 300.0, 500.0, 800.0])
def test_the_tool_oscillates_further_than_the_hub_by_the_flexure(frequency: float) -> None:
    rows = run(arm(), 3000, lambda time: 0.5 * math.cos(TURN * frequency * time))
    hub, flexure = (wave(rows, column, frequency) for column in ("arm_angle", "flexure"))
    assert abs(1.0 + flexure / hub) == pytest.approx(1.0 / (1.0 - (frequency / 1200.0) ** 2), rel=3e-3)


def test_the_free_resonance_is_that_of_both_inertias() -> None:
    plant = arm(flexure_damping=0.0)
    flexure = run(plant, 5000, lambda time: 0.1 if time < TICK else 0.0)["flexure"]
    lines = np.abs(np.fft.rfft(flexure[1:] * np.hanning(5000)))
    # 1200 Hz sqrt(1 + 3.5 / 4.5)
    assert np.argmax(lines) / 0.5 == pytest.approx(1600.0, abs=4.0)


def test_torque_stops_at_its_limit_and_follows_its_gain() -> None:
    plant = arm(torque_limit=3.0, torque_gain=0.9)
    assert run(plant, 50, lambda time: 100.0)["torque"][-1] == pytest.approx(2.7, rel=1e-9)
    channel = plant.commands[0]
    assert (channel.minimum, channel.maximum, channel.quantum) == (-3.0, 3.0, 14.0 / 65_536.0)


def test_the_current_loop_reaches_63_percent_after_its_time_constant() -> None:
    plant = arm(current_bandwidth=1.0 / (TURN * 10.0 * TICK))
    torque = run(plant, 30, lambda time: 1.0)["torque"]
    assert torque[10] == pytest.approx(1.0 - math.exp(-1.0), rel=1e-9)


# friction


def test_coulomb_friction_holds_a_small_torque() -> None:
    rows = run(arm(coulomb_friction=0.01), 2000, lambda time: 0.0099)
    assert abs(0.08 * (rows["arm_angle"][-1] - rows["arm_angle"][0])) < 50e-9
    assert rows["friction"][-1] == pytest.approx(-0.0099, rel=1e-3)


def test_coulomb_friction_stops_the_arm_in_a_straight_line() -> None:
    plant = arm(coulomb_friction=0.01)
    plant.data.qvel[plant.model.joint("arm").dofadr[0]] = 0.5
    speed = np.diff(run(plant, 1000)["arm_angle"]) / TICK
    # 0.01 N.m on 8e-4 kg.m2 takes 12.5 rad/s per second
    time = (np.arange(1000) + 0.5) * TICK
    assert speed[:300] == pytest.approx(0.5 - 12.5 * time[:300], abs=2e-3)
    assert np.abs(speed[420:]).max() < 1e-5


def test_viscous_friction_decays() -> None:
    plant = arm(viscous_friction=8e-3)
    plant.data.qvel[plant.model.joint("arm").dofadr[0]] = 0.1
    angle = run(plant, 2000)["arm_angle"]
    speed = (angle[-1] - angle[-2]) / TICK
    assert speed == pytest.approx(0.1 * math.exp(-8e-3 / 8e-4 * 0.2), rel=2e-3)


# geometry


@pytest.mark.parametrize(("phi", "slide"), [(0.0, 0.04), (0.3, 0.02), (-0.2, 0.07), (1.2, 0.14)])
def test_the_tool_is_where_the_equations_say(phi: float, slide: float) -> None:
    plant = arm(start_angle=phi, slide_start=slide, arm_length=0.081, center_offset=0.151)
    readings = dict(zip([channel.name for channel in plant.readings], plant.sense(), strict=True))
    assert readings["arm_angle"] == pytest.approx(phi - 0.0523, abs=1e-15)
    assert readings["slide_position"] == slide
    assert truth(plant)["tip_depth"] == pytest.approx(0.081 * math.sin(phi), abs=1e-15)
    assert truth(plant)["tip_lateral"] == pytest.approx(0.151 - slide - 0.081 * math.cos(phi), abs=1e-15)


def test_encoders_have_their_steps() -> None:
    quantum = {channel.name: channel.quantum for channel in RotaryArm().readings}
    assert 0.08 * quantum["arm_angle"] == pytest.approx(60e-9, rel=2e-3)
    assert quantum["spindle_angle"] == TURN / 2**20
    assert (quantum["slide_position"], quantum["probe_depth"], quantum["probe_lateral"]) == (1e-7, 1e-7, 1e-7)


# spindle and slide


def test_the_spindle_keeps_its_speed_but_for_the_ripple_of_its_drive() -> None:
    rows = run(arm(2.0, spindle_ripple=0.05, spindle_ripple_twelfth=0.02), 10_000)
    # ten revolutions after the first half second: torque over velocity gain and inertia
    speed = rows["spindle_speed"][5000:10_000]
    lines = 2.0 * np.abs(np.fft.rfft(speed)) / len(speed)
    turn = 20.0 * math.pi
    assert speed.mean() == pytest.approx(turn, rel=1e-6)
    assert lines[5] == pytest.approx(0.05 / abs(2.0 + 0.05j * turn), rel=1e-3)
    assert lines[60] == pytest.approx(0.02 / abs(2.0 + 0.05j * 12.0 * turn), rel=1e-3)


def test_the_spindle_ramps_to_a_new_speed() -> None:
    rows = run(arm(2.0), 15_000, speed_change=10.0 * math.pi)
    speed, lag = rows["spindle_speed"], 0.05 / 2.0
    # the ramp of the set-point, less what the drive lags behind
    assert speed[5000] == pytest.approx(20.0 * math.pi + 10.0 * math.pi * (0.5 - lag), rel=1e-4)
    assert speed[-1] == pytest.approx(30.0 * math.pi, rel=1e-6)
    turned = rows["spindle_angle"][-1] - rows["spindle_angle"][0]
    assert turned == pytest.approx(math.pi * (20.0 * 1.5 + 10.0 * (0.5 + 0.5 - lag)), rel=1e-4)


def test_the_slide_feeds_per_revolution_and_moves_on_command() -> None:
    rows = run(arm(2.0, feed=1e-5), 10_000)
    assert np.diff(rows["slide_position"][5000:]).mean() / TICK == pytest.approx(1e-4, rel=1e-6)
    plant = arm(2.0, slide_start=0.04, slide_acceleration=1.0)
    rows = run(plant, 10_000, slide_velocity=0.02)
    # the ramp of 20 ms costs 0.2 mm, the drive follows 2 zeta / w later
    behind = 2.0 * 0.7 / (TURN * 30.0)
    assert rows["slide_position"][-1] == pytest.approx(0.04 + 0.02 * (1.0 - 0.01 - behind), abs=2e-6)


# disturbances


def test_ripple_turns_with_the_spindle_and_hum_does_not() -> None:
    plant = arm(2.0, ripple_torque=6e-3, spindle_speed=TURN * 9.0)
    lines = 2.0 * np.abs(np.fft.rfft(run(plant, 10_000)["ripple"][1:])) / 10_000
    assert lines[108] == pytest.approx(6e-3, rel=1e-6)
    plant = arm(2.0, hum_torque=6e-3, spindle_speed=TURN * 9.0)
    lines = 2.0 * np.abs(np.fft.rfft(run(plant, 10_000)["ripple"][1:])) / 10_000
    assert lines[120] == pytest.approx(6e-3, rel=1e-6)


def test_thrust_has_mean_second_harmonic_and_noise() -> None:
    parts: dict[str, Any] = {
        "cutting_force": 2.0, "cutting_force_twice": 0.1, "cutting_noise": 0.03, "coulomb_friction": 1.0,
    }  # fmt: skip
    force = run(arm(2.0, **parts), 10_000, cutting=1.0)["cutting_force"][1:]
    lines = np.abs(np.fft.rfft(force)) / 10_000
    assert lines[0] == pytest.approx(2.0, abs=2e-3)
    assert 2.0 * lines[20] == pytest.approx(0.1, rel=0.05)
    assert np.std(force) ** 2 - 0.1**2 / 2.0 == pytest.approx(0.03**2, rel=0.15)
    assert not run(arm(**parts), 100)["cutting_force"].any()


@pytest.mark.parametrize("phi", [0.0, 0.7])
def test_thrust_winds_up_the_flexure_and_loads_the_hub(phi: float) -> None:
    # friction holds the hub, the arm settles
    plant = arm(cutting_force=2.0, coulomb_friction=1.0, start_angle=phi)
    rows = run(plant, 3000, cutting=1.0)
    torque = 2.0 * 0.08 * math.cos(phi)
    stiffness = 3.5e-4 * (TURN * 1200.0) ** 2
    assert rows["flexure"][-1] == pytest.approx(-torque / stiffness, rel=1e-4)
    assert rows["friction"][-1] == pytest.approx(torque, rel=1e-3)
    assert rows["slide_position"][-1] == pytest.approx(0.04, abs=1e-9)


# the cut part and its probe


def probe(plant: RotaryArm, lateral: float) -> tuple[float, float]:
    """Depth and position measured by the probe with the slide at a distance from the spindle axis."""
    p = plant.parameters
    plant.data.qpos[plant.model.joint("slide").qposadr[0]] = p.center_offset - p.probe_place - lateral
    plant.sense()
    plant.command(order(plant, probing=1.0))
    plant.advance(1)
    values = dict(zip([channel.name for channel in plant.readings], plant.sense(), strict=True))
    return values["probe_depth"], values["probe_lateral"]


CUT: dict[str, Any] = {
    "spindle_speed": TURN * 100.0, "roughness": 0.0, "probe_misplacement": 0.0, "probe_zero": 5e-3,
}  # fmt: skip


def test_a_flat_lies_a_nose_radius_below_the_nose_center() -> None:
    plant = arm(2.0, **CUT, start_angle=0.7, slide_start=0.06, feed=5e-5)
    run(plant, 5000, cutting=1.0)
    edge = 0.15 - 0.06 - 0.08 * math.cos(0.7)
    for lateral in (edge - 1e-3, 1e-3 - edge):
        depth, place = probe(plant, lateral)
        assert place == pytest.approx(lateral, abs=1e-12)
        # what is left between grooves of 50 um on a nose of 2 mm is 0.16 um high
        left = 0.08 * math.sin(0.7) + 0.002 - 0.005 - depth
        assert -1e-9 < left < 0.16e-6


def test_a_toroid_shows_arm_length_nose_and_ball() -> None:
    # an arm without friction rotates at constant speed; the slide is at rest
    plant = arm(2.0, **CUT, start_angle=0.7, slide_start=0.07)
    plant.data.qvel[plant.model.joint("arm").dofadr[0]] = 0.1
    run(plant, 10_000, cutting=1.0)
    radius = 0.08 + 0.002 - 0.0015
    for angle in (0.73, 0.75, 0.77):
        lateral = 0.15 - 0.07 - radius * math.cos(angle)
        for side in (1.0, -1.0):
            depth, place = probe(plant, side * lateral)
            # what is left between grooves of 80 um is 0.4 um high
            left = radius - math.hypot(0.08 - side * place, depth + 0.005 - 0.0015)
            assert -1e-9 < left < 0.42e-6


def test_an_air_cut_leaves_the_blank() -> None:
    plant = arm(2.0, **CUT, start_angle=0.7, slide_start=0.06, part_face=-0.01)
    run(plant, 1000)
    assert probe(plant, 0.02)[0] == pytest.approx(-0.01 - 0.005, abs=1e-12)


def test_the_probe_is_misplaced_within_its_range() -> None:
    plant, places = arm(probe_misplacement=2e-5), []
    for seed in range(50):
        plant.reset(seed, 0.01)
        places.append(probe(plant, 0.01)[1] - 0.01)
    assert -2e-5 <= min(places) < -1.5e-5 < 1.5e-5 < max(places) <= 2e-5


# repeatability and errors


def trace(plant: RotaryArm, seed: int) -> bytes:
    plant.reset(seed, 0.1)
    return b"".join(column.tobytes() for column in run(plant, 300, three_tones, cutting=1.0).values())


def test_same_seed_same_bytes_other_seed_other_bytes() -> None:
    plant = RotaryArm()
    first = trace(plant, 11)
    assert trace(plant, 12) != first
    assert trace(plant, 11) == first
    assert trace(RotaryArm(), 11) == first


def test_five_substeps_are_five_steps() -> None:
    one, five = RotaryArm(), RotaryArm()
    for plant in (one, five):
        plant.reset(9, 0.1)
    for _ in range(100):
        one.sense()
        one.command(order(one, torque=0.3, cutting=1.0))
        one.advance(5)
        for _ in range(5):
            five.sense()
            five.command(order(five, torque=0.3, cutting=1.0))
            five.advance(1)
    assert one.sense().tobytes() == five.sense().tobytes()
    assert one.truth().tobytes() == five.truth().tobytes()


# what the controller's model does not have


def once_a_turn(values: Matrix, angle: Matrix, order: float = 1.0) -> float:
    """Amplitude at a number of cycles per revolution of the spindle, rows over whole revolutions."""
    return float(2.0 * abs(np.mean(values * np.exp(-1j * order * angle))))


def test_the_cut_pushes_with_the_chip() -> None:
    # 10 um deep, 10 um per revolution: an arm too heavy to be moved by 0.2 mN
    plant = arm(hub_inertia=1.0, cutting_pressure=2e6, depth_of_cut=1e-5, feed=1e-5)
    truth = run(plant, 3000, cutting=1.0)
    assert np.all(truth["cutting_force"][:990] == 0.0)
    assert truth["cutting_force"][1500:] == pytest.approx(2e6 * 1e-5 * 1e-5, rel=0.05)


def test_there_is_no_chip_beyond_the_part() -> None:
    plant = arm(hub_inertia=1.0, cutting_pressure=2e8, part_radius=0.02, feed=1e-5)
    assert np.all(run(plant, 2500, cutting=1.0)["cutting_force"] == 0.0)


@pytest.mark.parametrize(("name", "place"), [("arm", 0), ("spindle", 1)])
def test_a_grating_with_its_axis_errs_once_per_revolution(name: str, place: int) -> None:
    changes: dict[str, Any] = {f"{name}_eccentricity": 2e-5}
    plant = arm(**changes)
    joint = plant.model.joint("arm" if name == "arm" else "spindle").qposadr[0]
    angles = TURN * np.arange(64) / 64.0
    errors = []
    for angle in angles:
        plant.data.qpos[joint] = angle
        read = plant.sense()[place]
        errors.append(read - truth(plant)[f"{name}_angle"])
    assert once_a_turn(np.array(errors), angles) == pytest.approx(2e-5, rel=1e-6)
    assert np.ptp(errors) == pytest.approx(4e-5, rel=0.01)


def test_the_ripple_has_four_orders_more() -> None:
    plant = arm(ripple_orders=3e-3)
    truth = run(plant, 2000)
    turns = slice(0, 2000)
    angle, ripple = truth["spindle_angle"][turns], truth["ripple"][turns]
    for order in range(1, 36):
        amplitude = 3e-3 if order in (5, 7, 18, 31) else 0.0
        assert once_a_turn(ripple, angle, order) == pytest.approx(amplitude, abs=5e-5)


def test_the_tool_is_next_to_the_axis_of_the_spindle() -> None:
    plant = arm(tool_height=2e-5)
    plant.sense()
    assert truth(plant)["tip_height"] == pytest.approx(2e-5, abs=1e-15)
    assert truth(plant)["tip_lateral"] == pytest.approx(0.03, abs=1e-12)
