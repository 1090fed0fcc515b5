"""Friction of the ring on its table, under pushes and on its own, against closed forms."""

import math

import numpy as np
import pytest

from plants.base.parameters import ParameterError

from .bench import (
    FREE,
    MODELS,
    ROUND,
    RPM_20,
    TURN,
    G,
    Trace,
    at_rest,
    in_room,
    place,
    ring,
    rotated,
    run,
    strokes,
    touch,
    truth,
)


@MODELS
def test_ring_does_not_creep_under_the_probe(bristle: bool) -> None:
    # 0.5 kg, mu 0.15, e 25 mm, 20 rpm: means over the second and the last of four revolutions
    plant = ring(13.0, mass=0.5, mu_static=0.15, eccentricity=0.025, bristle=bristle)
    turn, turns = 3000, 4
    ahead: float = 2e-3 - plant.parameters.probe_at_pusher

    def follow() -> float:
        # this keeps the probe at a collapse of 2 mm
        return touch(plant, truth(plant)["surface"]) + ahead

    plant.sense()
    before = follow()
    place(plant, slide=before)
    rows = []
    for _ in range(turns * turn):
        plant.sense()
        rows.append(plant.truth()[:2])
        now = follow()
        plant.command(np.array([now, (now - before) / 1e-3, 1.0, plant.parameters.spindle_speed]))
        before = now
        plant.advance(10)
    assert truth(plant)["probe_force"] > 0.35
    means = np.array(rows).reshape(turns, turn, 2).mean(axis=1)
    creep = np.linalg.norm(means[-1] - means[1]) / (3.0 * (turns - 2)) * 60.0
    assert creep < 0.2e-6


@MODELS
def test_break_away_is_the_same_in_every_direction(bristle: bool) -> None:
    plant = ring(spindle_speed=0.0, bristle=bristle, **ROUND)
    body, limit, forces = plant.model.body("ring").id, 0.2 * G, []
    for degrees in (0.0, 22.5, 45.0):
        plant.reset(1, 3.0)
        direction = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
        force, moved, start = 0.0, np.zeros(2), plant.truth()[:2]
        while np.linalg.norm(moved) < 1.5e-6:
            plant.data.xfrc_applied[body, :2] = force * direction
            plant.sense()
            moved = plant.truth()[:2] - start
            force += 0.0005 * limit
            plant.advance(10)
        assert math.degrees(math.atan2(moved[1], moved[0])) == pytest.approx(degrees, abs=0.1)
        forces.append(force)
    # a bristle gives way a little before it breaks
    assert forces[0] == pytest.approx(limit, rel=0.04 if bristle else 0.015)
    assert forces == pytest.approx([forces[0]] * 3, rel=0.002)


@MODELS
@pytest.mark.parametrize(("mass", "push"), [(1.0, 5e-6), (1.0, 20e-6), (1.0, 200e-6), (10.0, 200e-6)])
def test_lost_motion_of_a_push_is_friction_over_stiffness(bristle: bool, mass: float, push: float) -> None:
    # static friction holds the slide back by F / k_servo and compresses the tip by F / k_tip;
    # the bristle bends before the ring slides, and recovers
    plant = ring(spindle_speed=0.0, mass=mass, bristle=bristle, **FREE)
    p = plant.parameters
    contact = touch(plant, p.radius + p.eccentricity)
    start = contact - 20e-6
    place(plant, slide=start)
    path = strokes((0.05, start), (0.5, contact + push), (0.1, contact + push), (0.1, start))
    trace = run(plant, path, 0.8)
    moved = trace["ring_x"][0] - trace["ring_x"][-1]
    servo = p.slide_mass * (TURN * p.servo_bandwidth) ** 2
    lost = p.mu_static * mass * G * (1.0 / servo + 1.0 / p.pusher_stiffness)
    elastic = p.presliding if bristle else 0.0
    # a push that hardly breaks away ends inside the soft knee of the bristle
    tolerance = 0.03 * lost + 0.45 * elastic
    assert moved == pytest.approx(max(push - lost - elastic, 0.0), abs=tolerance)
    assert abs(trace["ring_y"][-1]) < 2e-8


@MODELS
def test_halving_the_step_does_not_change_a_sequence_of_pushes(bristle: bool) -> None:
    def pushed(timestep: float) -> Trace:
        plant = ring(timestep=timestep, bristle=bristle, eccentricity_angle_spread=0.0)
        contact = touch(plant, plant.parameters.radius)
        away = contact - 2e-3
        place(plant, slide=away)
        pieces = [(0.05, away)]
        for ahead in (-300e-6, -200e-6, -100e-6):
            pieces += [(0.15, contact + ahead), (0.15, away), (0.1, away)]
        return run(plant, strokes(*pieces), 1.4)

    coarse, fine = pushed(1e-4), pushed(5e-5)
    moved = math.hypot(coarse["ring_x"][0] - coarse["ring_x"][-1], coarse["ring_y"][0] - coarse["ring_y"][-1])
    assert moved > 100e-6
    for axis in ("ring_x", "ring_y"):
        assert abs(coarse[axis][-1] - fine[axis][-1]) < 0.01 * moved


@MODELS
def test_ring_coasts_as_far_as_friction_lets_it(bristle: bool) -> None:
    plant = ring(spindle_speed=0.0, mu_ratio=1.0, bristle=bristle, **ROUND)
    plant.data.qvel[plant.model.joint("ring_y").dofadr[0]] = 0.05
    trace = run(plant, at_rest(0.0), 0.2)
    # from 1 ms on: a bristle has to be bent first
    distance, speed = trace["ring_y"][-1] - trace["ring_y"][1], trace["slip_speed"][1]
    assert distance == pytest.approx(speed**2 / (2.0 * 0.2 * G), rel=0.01)


@MODELS
def test_turning_ring_stops_as_friction_at_its_feet_lets_it(bristle: bool) -> None:
    plant = ring(spindle_speed=0.0, mu_ratio=1.0, bristle=bristle, **ROUND)
    p = plant.parameters
    plant.data.qvel[plant.model.joint("ring_yaw").dofadr[0]] = 2.0
    angle = run(plant, at_rest(0.0), 0.4)["ring_yaw"][-1]
    inertia = 0.5 * p.mass * p.radius**2 * (1.0 + 0.85**2)
    assert angle == pytest.approx(0.5 * inertia * 4.0 / (0.2 * p.mass * G * p.feet_radius), rel=0.02)


def test_a_hit_without_loss_keeps_momentum_and_energy() -> None:
    # 8 kg at 50 mm/s on 1 kg; friction and servo are too weak to matter within a millisecond
    plant = ring(
        spindle_speed=0.0, mu_static=0.01, pusher_damping=0.0, servo_bandwidth=1.0, servo_force=1.0, **FREE
    )
    place(plant, slide=touch(plant, 0.0505) - 1e-5)
    joints = [plant.model.joint(name).dofadr[0] for name in ("slide", "ring_x")]
    plant.data.qvel[joints] = 0.05, 0.0
    plant.sense()
    plant.command(np.array([plant.data.qpos[joints[0]], 0.05, 1.0, plant.parameters.spindle_speed]))
    plant.advance(20)
    slide, thrown = plant.data.qvel[joints]
    assert (slide, thrown) == pytest.approx((0.05 * 7.0 / 9.0, -0.05 * 16.0 / 9.0), rel=0.01)


@pytest.mark.parametrize("speed", [RPM_20, -RPM_20])
@MODELS
def test_a_push_on_the_turning_table_follows_quasi_static_theory(bristle: bool, speed: float) -> None:
    # the ring turns with the table; in contact it slides along the force of the pusher, which is the normal
    # and the friction of the tip, until it is out of the way
    plant = ring(spindle_speed=speed, bristle=bristle, eccentricity_angle=-0.1, **FREE)
    p = plant.parameters
    start = touch(plant, p.radius + 550e-6)
    place(plant, slide=start)
    target = touch(plant, p.radius + 200e-6)
    trace = run(plant, strokes((0.02, start), (0.3, target), (0.1, start)), 0.45, 1e-4)
    x, y = in_room(trace, 0)
    turn, rub = speed * 1e-4, math.copysign(p.pusher_friction, speed)
    slipped = 0.0
    compression = 0.8 * p.mu_static * p.mass * G / p.pusher_stiffness
    for slide in trace["slide_position"][1:]:
        x, y = rotated(x, y, turn)
        normal = np.array([math.sqrt(p.radius**2 - y * y), -y]) / p.radius
        force = -normal + rub * np.array([normal[1], -normal[0]])
        excess = x + p.radius * normal[0] - touch(plant, slide) - compression
        if excess > 0.0:
            step = excess / -(force @ normal) * normal[0]
            x, y, slipped = x + step * force[0], y + step * force[1], slipped + step
    assert slipped > 150e-6
    assert in_room(trace, -1) == pytest.approx((x, y), abs=3e-6)


@MODELS
def test_friction_of_the_tip_turns_the_ring_on_three_feet_twice_as_fast_as_on_a_bristle(
    bristle: bool,
) -> None:
    # mu_p N radius against mu m g feet_radius^2 yaw' / slip', or half of that on feet that slip differently
    plant = ring(bristle=bristle, eccentricity_angle=-0.1, pusher_friction=0.02, **FREE)
    p = plant.parameters
    start = touch(plant, p.radius + 550e-6)
    place(plant, slide=start)
    trace = run(
        plant, strokes((0.02, start), (0.3, touch(plant, p.radius + 200e-6)), (0.1, start)), 0.45, 1e-4
    )
    slipped = trace["slip_speed"].sum() * 1e-4
    turned = (1.0 if bristle else 2.0) * -p.pusher_friction * p.radius / p.feet_radius**2 * slipped
    assert trace["ring_yaw"][-1] == pytest.approx(turned, rel=0.05)


def test_friction_under_each_foot_varies_over_the_table() -> None:
    # one period in x and y: the mean is that of the friction model, the extremes are off by the spread
    plant = ring(spindle_speed=0.0, part_present=True, mu_static=0.2, mu_spread=0.3, mu_patch=1e-4, **FREE)
    found = []
    for i in range(16):
        for j in range(16):
            place(plant, ring_x=1e-4 * i / 16, ring_y=1e-4 * j / 16)
            plant.data.qvel[:] = 0.0
            plant.sense()
            plant.advance(1)
            found.append(plant.model.pair_friction[:, :2].copy())
    coefficients = np.array(found)
    assert np.all(coefficients[:, :, 0] == coefficients[:, :, 1])
    assert coefficients.mean(axis=0) == pytest.approx(0.2, rel=1e-2)
    assert coefficients.max(axis=0) == pytest.approx(0.2 * 1.3, rel=0.02)
    assert coefficients.min(axis=0) == pytest.approx(0.2 * 0.7, rel=0.02)
    with pytest.raises(ParameterError, match=r"`plant.mu_spread`.*`0.3`.*`0`"):
        ring(mu_spread=0.3, bristle=True)
