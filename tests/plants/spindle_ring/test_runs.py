"""Whole runs: mirrored, repeated, and ended by what the plant cannot do."""

import math

import numpy as np
import pytest

from plants.base.plant import PlantError

from .bench import MODELS, ROUND, RPM_20, Trace, at_rest, place, ring, run, strokes, touch


def test_reverse_rotation_is_the_mirror_image() -> None:
    def pushed(sign: float) -> Trace:
        plant = ring(spindle_speed=sign * RPM_20, eccentricity_angle=sign * -0.1, **ROUND)
        start = touch(plant, plant.parameters.radius + 600e-6)
        place(plant, slide=start)
        return run(plant, strokes((0.02, start), (0.2, start + 400e-6), (0.1, start)), 0.4)

    forth, back = pushed(1.0), pushed(-1.0)
    assert abs(forth["ring_y"][-1] - forth["ring_y"][0]) > 10e-6
    for name, sign in (("ring_x", 1.0), ("ring_y", -1.0), ("ring_yaw", -1.0), ("slide_position", 1.0)):
        assert forth[name] == pytest.approx(sign * back[name], abs=1e-12), name


def test_without_enable_the_windings_brake_the_slide() -> None:
    plant, speed, rows = ring(brake_time=0.02, **ROUND), 0.05, []
    for k in range(500):
        plant.sense()
        on = k < 200
        plant.command(np.array([speed * k * 1e-3, speed, float(on), plant.parameters.spindle_speed]))
        plant.advance(round(1e-3 / plant.timestep))
        rows.append(plant.data.qvel[plant.model.joint("slide").dofadr[0]])
    assert rows[199] == pytest.approx(speed, rel=0.01)
    # v' = -v / brake_time
    assert rows[219] == pytest.approx(speed / math.e, rel=0.05)
    assert abs(rows[-1]) < 1e-4 * speed


@MODELS
def test_the_same_seed_gives_the_same_run_bit_for_bit(bristle: bool) -> None:
    plant = ring(
        bristle=bristle, spindle_error=1e-7, spindle_error_noise=1e-7, dirt_height=1e-5, spike_height=1e-5
    )
    path = strokes((0.05, 0.0), (0.5, 0.0508), (0.1, 0.04))
    runs = []
    for seed in (7, 7, 8):
        plant.reset(seed, 1.0)
        runs.append(run(plant, path, 0.7))
    plant = ring(
        7, 7, **{name: getattr(plant.parameters, name) for name in plant.parameters.__dataclass_fields__}
    )
    runs.append(run(plant, path, 0.7))
    assert runs[0]["pusher_force"].max() > 0.0
    for name, values in runs[0].items():
        assert np.array_equal(values, runs[1][name]), name
        assert name in ("probe_position",) or np.array_equal(values, runs[3][name]), name
    assert not np.array_equal(runs[0]["ring_x"], runs[2]["ring_x"])


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        (
            {"ring_y": 0.048},
            r"`probe_line`: the distance of the ring center from .* is `0.048000` m, limit .*`0.047500` m",
        ),
        ({"ring_x": -0.12}, r"`table_edge`: the eccentricity is `0.120000` m, limit .* to `0.110000` m"),
        ({"slide": 0.056}, r"`probe_stroke`: the position of the probe is `0.026.*` m, limit .*`0.025000` m"),
    ],
)
def test_a_ring_that_leaves_its_geometry_stops_the_plant(joints: dict[str, float], message: str) -> None:
    plant = ring(spindle_speed=0.0, **ROUND)
    place(plant, **joints)
    with pytest.raises(
        PlantError, match=rf"(?s)plant `spindle_ring` at t = `0` s: element {message}\nhint: "
    ):
        plant.sense()


@MODELS
def test_a_table_that_turns_too_fast_throws_the_ring_off(bristle: bool) -> None:
    # mu g = 1.96 m/s2 holds 0.5 kg at 25 mm up to 84 rpm
    plant = ring(spindle_speed=9.5, eccentricity=0.025, bristle=bristle, **ROUND)
    with pytest.raises(PlantError, match="the ring"):
        run(plant, at_rest(0.0), 3.0)


def test_a_state_that_is_not_finite_is_an_error() -> None:
    plant = ring()
    plant.sense()
    place(plant, ring_x=math.nan)
    with pytest.raises(PlantError, match="element `ring`: input `x` is `NaN`"):
        plant.advance(1)


def test_the_table_takes_its_speed_from_the_command_with_a_ramp() -> None:
    plant = ring(spindle_speed=0.0, spindle_acceleration=20.0)
    found = []
    for _ in range(3):
        plant.sense()
        plant.command(np.array([0.0, 0.0, 1.0, 10.0]))
        plant.advance(2000)
        found.append(float(plant.data.qvel[plant.model.joint("spindle").dofadr[0]]))
    # 20 rad/s2 for 0.2 s and 0.4 s, less the lag of the drive; then there
    assert found == pytest.approx([4.0, 8.0, 10.0], abs=0.1)
