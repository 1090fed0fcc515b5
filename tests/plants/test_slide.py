"""The slide against closed forms."""

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import plants
from plants.base.names import UnknownNameError
from plants.base.parameters import ParameterError
from plants.base.plant import PlantError
from plants.slide import Slide
from plants.slide_parameters import SlideParameters

TURN = 2.0 * math.pi

# only mass, motor and one rigid pair of flutes
QUIET = SlideParameters(
    mass=10.0, force_constant=20.0, force_ripple=0.0, damping=0.0, cogging=0.0, cogging_half=0.0,
    balancer_residual=0.0, balancer_sway=0.0, air_noise=0.0, spindle_force=0.0, spindle_force_twice=0.0,
    amplifier_noise=0.0, tilt=0.0, flute_shortfall=0.0, surface_distance=0.0, surface_spread=0.0,
    start_spread=0.0,
)  # fmt: skip


def slide(duration: float = 1.0, seed: int = 1, **changes: Any) -> Slide:
    plant = Slide(replace(QUIET, **changes))
    plant.reset(seed, duration)
    return plant


def run(plant: Slide, current: float, ticks: int, substeps: int = 2) -> dict[str, np.ndarray[Any, Any]]:
    """Ground truth by name, one row per tick and one at the end."""
    rows = []
    for _ in range(ticks):
        plant.sense()
        rows.append(plant.truth())
        plant.command(np.array([current, 1.0]))
        plant.advance(substeps)
    plant.sense()
    rows.append(plant.truth())
    table = np.array(rows).T
    return {channel.name: column for channel, column in zip(plant.truths, table, strict=True)}


def at(plant: Slide, position: float, flute_retreat: tuple[float, float] = (0.0, 0.0)) -> dict[str, float]:
    """Ground truth with the slide and its flutes at a given position."""
    plant.data.qpos[:] = position, *flute_retreat
    plant.sense()
    return {channel.name: value for channel, value in zip(plant.truths, plant.truth(), strict=True)}


# contact


@pytest.mark.parametrize(("force", "depth"), [(1e-3, 5e-9), (50e-3, 250e-9), (1.0, 5e-6)])
def test_one_flute_is_a_spring_of_200_kilonewton_per_metre(force: float, depth: float) -> None:
    plant = slide(stiffness=2e5)
    # the second flute stays far back
    assert at(plant, plant.surface + depth, (0.0, 1e-3))["contact_force"] == pytest.approx(force, rel=1e-9)


def test_no_force_before_the_first_touch() -> None:
    plant = slide(surface_distance=1e-5)
    for depth in (-1e-5, -1e-9, 0.0):
        assert at(plant, plant.surface + depth)["contact_force"] == 0.0


def test_two_flutes_add_and_the_short_one_comes_later() -> None:
    plant = slide()
    assert at(plant, plant.surface + 80e-9, (0.0, 100e-9))["contact_force"] == pytest.approx(16e-3, rel=1e-9)
    assert at(plant, plant.surface + 180e-9, (0.0, 100e-9))["contact_force"] == pytest.approx(52e-3, rel=1e-9)


def test_a_constant_thrust_comes_to_rest_at_the_depth_of_both_springs() -> None:
    # 0.05 A * 20 N/A = 1 N on 2 * 2e5 N/m, heavily damped
    plant = slide(damping=4e3)
    truth = run(plant, 0.05, 3000)
    assert truth["depth"][-1] == pytest.approx(2.5e-6, rel=1e-6)
    assert truth["contact_force"][-1] == pytest.approx(1.0, rel=1e-6)
    assert truth["touched"][-1] == 1.0
    # the peak sees every plant step but the present one
    assert truth["depth"][:-1].max() <= truth["depth_max"][-1] <= truth["depth"].max()


def test_without_damping_contact_keeps_its_energy() -> None:
    # dropped onto the spring at 1 mm/s: depth v sqrt(m / 2k), and the speed returns
    plant = slide()
    plant.data.qvel[0] = 1e-3
    truth = run(plant, 0.0, 400)
    assert truth["depth"].max() == pytest.approx(1e-3 * math.sqrt(10.0 / 4e5), rel=1e-2)
    assert truth["velocity"][-1] == pytest.approx(-1e-3, rel=1e-2)


def test_a_yielding_surface_keeps_the_indentation() -> None:
    plant = slide(yield_depth=100e-9)
    at(plant, plant.surface + 150e-9, (0.0, 1e-3))
    plant.advance(1)
    after = at(plant, plant.surface - 1e-6, (0.0, 1e-3))
    assert after["indentation"] == pytest.approx(50e-9, rel=1e-3)
    assert after["contact_force"] == 0.0
    # the true surface stays where the first touch was possible; the force starts deeper
    assert at(plant, plant.surface + 40e-9, (0.0, 1e-3))["contact_force"] == 0.0
    assert at(plant, plant.surface + 60e-9, (0.0, 1e-3))["contact_force"] == pytest.approx(2e-3, rel=1e-2)
    # and a reset gives a new workpiece
    plant.reset(1, 1.0)
    assert at(plant, plant.surface)["indentation"] == 0.0


def test_without_workpiece_there_is_no_contact() -> None:
    plant = slide(workpiece=False)
    truth = run(plant, 1.0, 1000)
    assert truth["position"][-1] > 5e-3
    assert truth["touched"][-1] == 0.0


# flutes and spindle


def test_flutes_follow_the_spindle() -> None:
    speed, tilt, shortfall = 1000.0 * math.pi, 50e-9, 100e-9
    plant = slide(tilt=tilt, flute_shortfall=shortfall, surface_distance=1e-3, spindle_speed=speed)
    plant.sense()
    # the angle at time zero is random: read it off the wires
    start = plant.wire("angle").read()
    for k in range(200):
        angle = start + speed * k * plant.timestep
        exact = tilt * (1.0 - math.cos(angle)), shortfall + tilt * (1.0 + math.cos(angle))
        assert plant.data.qpos[1:] == pytest.approx(exact, abs=1e-15), f"step {k}"
        plant.advance(1)
        plant.sense()


def test_spindle_force_has_its_two_lines() -> None:
    speed = 1000.0 * math.pi  # 500 Hz: 20 ticks of 1e-4 s per revolution
    plant = slide(spindle_force=0.02, spindle_force_twice=0.01, surface_distance=1e-2, spindle_speed=speed)
    truth = run(plant, 0.0, 2000)
    lines = 2.0 * np.abs(np.fft.rfft(truth["disturbance"][1:])) / 2000
    assert lines[100] == pytest.approx(0.02, rel=1e-6)
    assert lines[200] == pytest.approx(0.01, rel=1e-6)
    assert np.delete(lines, [100, 200]).max() < 1e-9


# motor and stage


def test_a_free_mass_accelerates_with_force_over_mass() -> None:
    plant = slide(mass=4.0, workpiece=False, current_bandwidth=1e5)
    truth = run(plant, 0.5, 1000)
    assert truth["velocity"][-1] == pytest.approx(0.5 * 20.0 / 4.0 * 0.1, rel=1e-4)
    assert truth["position"][-1] == pytest.approx(0.5 * 2.5 * 0.1**2, rel=1e-3)


def test_a_free_mass_drifts_at_constant_speed() -> None:
    plant = slide(workpiece=False)
    plant.data.qvel[0] = 1e-4
    truth = run(plant, 0.0, 5000)
    assert truth["velocity"][-1] == 1e-4
    assert truth["position"][-1] == pytest.approx(0.5e-4, rel=1e-9)


def test_viscous_friction_decays() -> None:
    plant = slide(workpiece=False, damping=100.0)
    plant.data.qvel[0] = 1e-2
    truth = run(plant, 0.0, 1000)
    assert truth["velocity"][-1] == pytest.approx(1e-2 * math.exp(-1.0), rel=1e-3)
    assert truth["disturbance"][1] == pytest.approx(1.0, rel=1e-3)


def test_current_reaches_63_percent_after_its_time_constant() -> None:
    bandwidth = 100.0  # Hz: 1.59 ms
    plant = slide(workpiece=False, current_bandwidth=bandwidth, timestep=1e-5)
    truth = run(plant, 1.0, 1000, substeps=1)
    # row k is the mean over the step before: centered half a step earlier
    time = (np.arange(len(truth["current"])) - 0.5) * 1e-5
    reached = np.interp(1.0 - math.exp(-1.0), truth["current"], time)
    assert reached == pytest.approx(1.0 / (TURN * bandwidth), rel=1e-4)


def test_cogging_is_a_sine_of_the_position() -> None:
    plant = slide(cogging=0.2, cogging_half=0.05, workpiece=False)
    positions = np.linspace(0.0, 0.03, 200, endpoint=False)
    force = []
    for position in positions:
        plant.data.qpos[0] = position
        plant.sense()
        plant.advance(1)
        force.append(float(plant.data.actuator_force[1:].sum()))
    lines = 2.0 * np.abs(np.fft.rfft(force)) / len(force)
    assert lines[1:3] == pytest.approx([0.2, 0.05], rel=1e-9)
    assert lines[3:].max() < 1e-9


def test_thrust_ripples_along_the_track() -> None:
    plant = slide(force_ripple=0.01, workpiece=False)
    run(plant, 1.0, 100)
    thrust = []
    for position in np.linspace(0.0, 0.03, 100, endpoint=False):
        plant.data.qpos[0] = position
        plant.sense()
        plant.advance(1)
        thrust.append(float(plant.data.ctrl[0]))
    assert (max(thrust) - min(thrust)) / 2.0 == pytest.approx(0.2, rel=1e-3)
    assert np.mean(thrust) == pytest.approx(20.0, rel=1e-6)


def test_disturbance_and_contact_close_the_balance_of_forces() -> None:
    # thrust - disturbance - contact = mass * acceleration, with every source on
    plant = Slide(replace(SlideParameters(), surface_distance=1e-6, surface_spread=0.0, mass=10.0))
    plant.reset(5, 1.0)
    for _ in range(400):
        plant.sense()
        truth = dict(zip([channel.name for channel in plant.truths], plant.truth(), strict=True))
        plant.command(np.array([0.05, 1.0]))
        contact = truth["contact_force"]
        plant.advance(1)
        disturbance = plant.wire("disturbance").read()
        inertia = 10.0 * float(plant.data.qacc[0])
        assert plant.data.ctrl[0] - disturbance - contact - inertia == pytest.approx(0.0, abs=1e-4)
    assert truth["touched"] == 1.0


# noise and seeds


@pytest.mark.parametrize(
    ("source", "rms"), [("balancer_sway", 0.02), ("air_noise", 1e-3), ("amplifier_noise", 5e-5)]
)
def test_noise_has_its_standard_deviation(source: str, rms: float) -> None:
    changes: dict[str, Any] = {"damping": 1e4, "balancer_time": 1e-2, source: rms}
    plant = slide(8.0, workpiece=False, **changes)
    truth = run(plant, 0.0, 40_000)
    column = "current" if source == "amplifier_noise" else "disturbance"
    friction = 1e4 * truth["velocity"] if column == "disturbance" else 0.0
    # 8 s hold at least 400 independent values: 4 standard errors of a standard deviation are 14 %
    assert np.std((truth[column] - friction)[100:]) == pytest.approx(rms, rel=0.15)


def trace(plant: Slide, seed: int | np.random.SeedSequence) -> bytes:
    plant.reset(seed, 0.5)
    return b"".join(column.tobytes() for column in run(plant, 0.02, 500).values())


def test_same_seed_same_bytes_other_seed_other_bytes() -> None:
    plant = Slide()
    first = trace(plant, 11)
    assert trace(plant, 12) != first
    assert trace(plant, 11) == first
    assert trace(Slide(), np.random.SeedSequence(11)) == first


def test_a_source_does_not_shift_another() -> None:
    one, other = slide(seed=3, balancer_residual=0.5), slide(seed=3)
    assert one.stream("air").standard_normal() == other.stream("air").standard_normal()
    assert one.stream("air").standard_normal() != one.stream("spindle").standard_normal()


def test_start_and_surface_are_sampled_within_their_ranges() -> None:
    plant = Slide(replace(SlideParameters(), start_spread=1e-3, surface_distance=2e-4, surface_spread=1e-4))
    starts, distances = [], []
    for seed in range(100):
        plant.reset(seed, 0.01)
        start = plant.sense()[0]
        starts.append(start)
        distances.append(plant.surface - start)
    assert -1e-3 <= min(starts) < -0.5e-3 < 0.5e-3 < max(starts) <= 1e-3
    assert 2e-4 <= min(distances) < 2.2e-4 < 2.8e-4 < max(distances) <= 3e-4


def test_balancer_leaves_a_weight_of_either_sign() -> None:
    plant = Slide(replace(QUIET, balancer_residual=0.5))
    weights = []
    for seed in range(100):
        plant.reset(seed, 0.01)
        weights.append(plant.truth()[[channel.name for channel in plant.truths].index("disturbance")])
    assert -0.5 <= min(weights) < -0.4 < 0.4 < max(weights) <= 0.5


def test_two_substeps_are_two_steps() -> None:
    one, two = Slide(), Slide()
    one.reset(9, 0.1)
    two.reset(9, 0.1)
    for _ in range(200):
        one.sense()
        one.command(np.array([0.2, 1.0]))
        one.advance(2)
        for _ in range(2):
            two.sense()
            two.command(np.array([0.2, 1.0]))
            two.advance(1)
    assert one.sense().tobytes() == two.sense().tobytes()
    assert one.truth().tobytes() == two.truth().tobytes()


def test_a_reset_discards_the_command() -> None:
    plant = slide(workpiece=False)
    run(plant, 1.0, 10)
    plant.reset(1, 0.1)
    plant.sense()
    plant.advance(10)
    assert plant.sense()[0] == 0.0


@pytest.mark.parametrize("substeps", [1, 5])
def test_substeps_agree(substeps: int) -> None:
    # a push into the surface, noise off: 100 us ticks of 1, 2 or 5 plant steps
    def push(count: int) -> dict[str, np.ndarray[Any, Any]]:
        spindle: dict[str, Any] = {"spindle_force": 0.02, "spindle_force_twice": 0.01, "tilt": 50e-9}
        plant = slide(timestep=1e-4 / count, cogging=0.2, damping=2e3, surface_distance=1e-7, **spindle)
        return run(plant, 0.05, 500, count)

    nominal = push(2)
    assert nominal["depth_max"][-1] > 2e-6
    assert np.abs(push(substeps)["position"] - nominal["position"]).max() < 5e-9


# errors


def test_a_run_longer_than_its_noise_is_an_error_with_time_and_hint() -> None:
    plant = slide(0.001)
    with pytest.raises(PlantError, match=r"`slide` at t = `0.0010.*s:.*(?s:.)*hint: Call `reset`"):
        run(plant, 0.0, 20)


def test_a_command_that_is_not_finite_is_an_error() -> None:
    plant = slide()
    plant.sense()
    with pytest.raises(PlantError, match=r"`slide` at t = `0` s: command `current` is `nan` A"):
        plant.command(np.array([math.nan, 1.0]))


def test_a_state_that_is_not_finite_is_an_error() -> None:
    plant = slide()
    plant.sense()
    plant.data.qpos[0] = math.nan
    with pytest.raises(
        PlantError, match=r"`slide` at t = `0` s: element `thrust`: input `position` is `NaN`"
    ):
        plant.advance(1)


def test_advance_needs_sense() -> None:
    plant = slide()
    with pytest.raises(PlantError, match="`advance` before `sense`"):
        plant.advance(1)
    plant.sense()
    plant.advance(1)
    with pytest.raises(PlantError, match="`advance` before `sense`"):
        plant.advance(1)


def test_registry() -> None:
    assert "slide" in plants.names()
    assert plants.load("slide") is Slide
    with pytest.raises(UnknownNameError, match=r"there is no plant `slid`\nhint: Use `slide`"):
        plants.load("slid")


# effects that the model of the controller lacks


def fed(plant: Slide, velocity: float, ticks: int) -> dict[str, np.ndarray[Any, Any]]:
    """Ground truth of a slide without resistance, one row per tick."""
    rows = []
    for _ in range(ticks):
        plant.data.qvel[0] = velocity
        plant.sense()
        rows.append(plant.truth())
        plant.advance(2)
    return dict(zip((channel.name for channel in plant.truths), np.array(rows).T, strict=True))


def test_flutes_that_cut_push_with_the_feed_per_tooth() -> None:
    # 100 um/s, 500 revolutions/s, two flutes: 0.1 um each, of 1e10 Pa on 0.1 mm, at any depth
    plant = slide(cutting_pressure=1e10, spindle_speed=500.0 * TURN, mass=1e3)
    truth = fed(plant, 1e-4, 1000)
    force = 2.0 * 1e10 * 1e-4 * 1e-7
    assert truth["contact_force"][800:] == pytest.approx(force, rel=0.01)
    # the spring of 2e5 N/m at each flute
    assert truth["indentation"][-1] == pytest.approx(truth["depth"][-1] - 0.5 * force / 2e5, abs=5e-8)
    assert truth["disturbance"][-1] == pytest.approx(0.0, abs=1e-12)


def test_flutes_at_rest_only_press() -> None:
    plant = slide(cutting_pressure=1e10, spindle_speed=0.0, flute_shortfall=1e-4)
    plant.data.qpos[0] = plant.surface + 1e-7
    plant.sense()
    plant.advance(1)
    assert plant.truth()[5] == pytest.approx(1e-7 / (1.0 / 2e5 + 1.0 / 1e6), rel=1e-9)


def test_the_tool_oscillates_unseen_by_the_encoder() -> None:
    # half of the mass at 300 Hz and 2 % oscillates against the other half
    plant = slide(mass=10.0, tool_mass=5.0, tool_frequency=300.0, tool_damping=0.02, workpiece=False)
    plant.data.qpos[1] = 1e-6
    truth = run(plant, 0.0, 400)
    tool = truth["depth"] + plant.surface
    swing = tool - truth["position"]
    up = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
    period = (up[10] - up[0]) * 1e-4 / 10.0
    assert 1.0 / period == pytest.approx(300.0 * math.sqrt(2.0), rel=0.01)
    peaks = [swing[a:b].max() for a, b in itertools.pairwise(up[:11])]
    assert math.log(peaks[0] / peaks[8]) / 8.0 == pytest.approx(TURN * 0.02 * math.sqrt(2.0), rel=0.1)
    assert 0.5 * (tool + truth["position"]) == pytest.approx(5e-7, abs=1e-12)


def test_the_tool_touches_and_deflects() -> None:
    # both springs carry the force: contact of one flute of 2e6 N/m, and the bracket of 2 kg at 300 Hz
    plant = slide(stiffness=2e6, tool_frequency=300.0, tool_damping=1.0, flute_shortfall=1e-4, mass=1e3)
    plant.data.qpos[0] = plant.surface + 1e-7
    truth = run(plant, 0.0, 30)
    bracket = 2.0 * (TURN * 300.0) ** 2
    assert truth["contact_force"][-1] == pytest.approx(1e-7 / (1.0 / 2e6 + 1.0 / bracket), rel=0.02)


def test_the_spindle_speed_varies() -> None:
    plant = slide(spindle_wobble=3e-3, wobble_frequency=5.0, workpiece=False)
    speeds = []
    for _ in range(4000):
        speeds.append(plant.sense()[1])
        plant.advance(2)
    assert np.mean(speeds) == pytest.approx(1000.0 * math.pi, rel=1e-6)
    assert np.std(speeds) * math.sqrt(2.0) / (1000.0 * math.pi) == pytest.approx(3e-3, rel=1e-3)


def test_the_encoder_errs_within_its_signal_period() -> None:
    plant = slide(encoder_interpolation=3e-9, encoder_period=4e-6)
    places = np.linspace(0.0, 8e-6, 160, endpoint=False)
    errors = []
    for place in places:
        plant.data.qpos[0] = place
        errors.append(plant.sense()[0] - place)
    waves = np.abs(np.fft.rfft(errors)) / 80.0
    assert waves[2] == pytest.approx(3e-9, rel=1e-6)
    assert np.delete(waves, 2).max() < 1e-15


def test_the_floor_vibration_moves_the_slide() -> None:
    # velocity of a free mass: force over mass and frequency
    plant = slide(floor_force=0.02, floor_frequency=18.0, workpiece=False)
    velocity = run(plant, 0.0, 5000)["velocity"]
    assert 0.5 * np.ptp(velocity) == pytest.approx(0.02 / (10.0 * TURN * 18.0), rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tool_frequency": 300.0, "tool_mass": 10.0}, r"`plant.tool_mass`.*`10` kg.*`10` kg"),
        ({"cutting_pressure": 1e9, "yield_depth": 1e-8}, r"`plant.yield_depth`.*`1e-08` m"),
    ],
)
def test_parameters_that_do_not_fit_are_rejected(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        slide(**changes)
