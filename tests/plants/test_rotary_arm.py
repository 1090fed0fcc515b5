"""The rotary arm against closed forms."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import plants
from plants.rotary_arm import RotaryArm, RotaryArmParameters

Columns = dict[str, np.ndarray[Any, Any]]
Torque = Callable[[float], float]

TURN = 2.0 * math.pi
TICK = 1e-4

# nothing but inertias, flexure, current loop and a spindle at constant speed
QUIET = RotaryArmParameters(
    viscous_friction=0.0, coulomb_friction=0.0, ripple_torque=0.0, hum_torque=0.0, cutting_force=0.0,
    cutting_force_twice=0.0, cutting_noise=0.0, spindle_ripple=0.0, spindle_ripple_twelfth=0.0, feed=0.0,
)  # fmt: skip


def arm(duration: float = 1.0, seed: int = 1, **changes: Any) -> RotaryArm:
    plant = RotaryArm(replace(QUIET, **changes))
    plant.reset(seed, duration)
    return plant


def order(plant: RotaryArm, **values: float) -> np.ndarray[Any, Any]:
    return np.array([values.get(channel.name, 0.0) for channel in plant.commands])


def truth(plant: RotaryArm) -> dict[str, float]:
    return {channel.name: value for channel, value in zip(plant.truths, plant.truth(), strict=True)}


def run(plant: RotaryArm, ticks: int, torque: Torque = lambda time: 0.0, **commands: float) -> Columns:
    """Truths by name, one row per tick and one at the end; the torque is held over each tick."""
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


# the arm as a linear system


def system(p: RotaryArmParameters) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """State matrix and input column; states: hub angle and speed, flexure angle and speed, motor torque."""
    speed = TURN * p.flexure_frequency
    stiffness, damping = p.arm_inertia * speed**2, 2.0 * p.flexure_damping * p.arm_inertia * speed
    hub = np.array([0.0, -p.viscous_friction, stiffness, damping, 1.0]) / p.hub_inertia
    tool = np.array([0.0, 0.0, -stiffness, -damping, 0.0]) / p.arm_inertia
    bandwidth = TURN * p.current_bandwidth
    state = np.array([[0, 1, 0, 0, 0], hub, [0, 0, 0, 1, 0], tool - hub, [0, 0, 0, 0, -bandwidth]])
    return state, np.array([0.0, 0.0, 0.0, 0.0, bandwidth])


def exponential(matrix: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Matrix exponential by its series after halving."""
    halvings = max(0, math.ceil(math.log2(np.abs(matrix).sum(axis=1).max())) + 4)
    scaled, result, term = matrix / 2.0**halvings, np.eye(len(matrix)), np.eye(len(matrix))
    for n in range(1, 20):
        term = term @ scaled / n
        result = result + term
    for _ in range(halvings):
        result = result @ result
    return result


def exact(p: RotaryArmParameters, torque: Torque, ticks: int) -> np.ndarray[Any, Any]:
    """States at every tick for a torque that is held over each tick."""
    state, column = system(p)
    block = np.zeros((6, 6))
    block[:5, :5], block[:5, 5] = state, column
    step = exponential(block * TICK)
    states = np.zeros((ticks + 1, 5))
    for k in range(ticks):
        states[k + 1] = step[:5, :5] @ states[k] + step[:5, 5] * torque(k * TICK)
    return states


def three_tones(time: float) -> float:
    return sum(
        amplitude * math.cos(TURN * frequency * time)
        for amplitude, frequency in ((0.1, 20.0), (0.4, 120.0), (1.0, 500.0))
    )


def tool_error(timestep: float) -> float:
    plant = arm(timestep=timestep, torque_resolution=0.0)
    reached = run(plant, 2000, three_tones)
    states = exact(plant.parameters, three_tones, 2000)
    angle = np.arcsin(reached["tip_depth"] / 0.08)
    error = 0.08 * (angle - states[:, 0] - states[:, 2])
    return float(np.sqrt(np.mean(error**2)))


def test_the_tool_follows_the_exact_solution_within_50_nanometres() -> None:
    assert tool_error(2e-5) < 50e-9


def test_the_error_of_the_plant_step_is_of_second_order() -> None:
    assert 3.0 < tool_error(1e-4) / tool_error(5e-5) < 5.0
