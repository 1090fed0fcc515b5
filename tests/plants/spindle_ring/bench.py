"""The ring on its spindle, driven along paths of its slide."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from plants.spindle_ring import SpindleRing
from plants.spindle_ring_parameters import SpindleRingParameters

Trace = dict[str, NDArray[np.float64]]
Path = Callable[[float], tuple[float, float]]
"""Position and velocity setpoint of the slide over time."""

TURN = 2.0 * math.pi
RPM_20 = TURN / 3.0
G = 9.80665
MODELS = pytest.mark.parametrize("bristle", [False, True], ids=["contacts", "bristle"])

# a round ring 0.5 mm off along the line of the slide
ROUND: dict[str, Any] = {
    "lobe_2": 0.0, "lobe_3": 0.0, "lobe_5": 0.0, "roughness": 0.0, "eccentricity_angle_spread": 0.0,
}  # fmt: skip
# and a probe without force
FREE: dict[str, Any] = {**ROUND, "probe_force_free": 0.0, "probe_force_full": 0.0}


def ring(duration: float = 4.0, seed: int = 1, **changes: Any) -> SpindleRing:
    plant = SpindleRing(SpindleRingParameters(**changes))
    plant.reset(seed, duration)
    return plant


def place(plant: SpindleRing, **joints: float) -> None:
    for joint, position in joints.items():
        plant.data.qpos[plant.model.joint(joint).qposadr[0]] = position


def truth(plant: SpindleRing) -> dict[str, float]:
    return {channel.name: float(v) for channel, v in zip(plant.truths, plant.truth(), strict=True)}


def run(plant: SpindleRing, path: Path, duration: float, period: float = 1e-3) -> Trace:
    """Drive the slide along a path; ground truth and measurements by name, one row per communication step."""
    substeps = round(period / plant.timestep)
    rows = []
    for k in range(round(duration / period) + 1):
        if k > 0:
            plant.advance(substeps)
        readings = plant.sense()
        rows.append(np.append(plant.truth(), readings[2]))
        plant.command(np.array([*path(k * period), 1.0, plant.parameters.spindle_speed]))
    names = [channel.name for channel in plant.truths] + ["probe_position"]
    return dict(zip(names, np.array(rows).T, strict=True))


def at_rest(position: float) -> Path:
    return lambda _: (position, 0.0)


def strokes(*pieces: tuple[float, float]) -> Path:
    """Smooth strokes one after the other, each (duration, end position); the first starts where it ends."""

    def path(t: float) -> tuple[float, float]:
        start = pieces[0][1]
        for duration, end in pieces:
            if t < duration:
                u, step = t / duration, end - start
                bend = math.sin(TURN * u) / TURN
                return start + step * (u - bend), step / duration * (1.0 - math.cos(TURN * u))
            t, start = t - duration, end
        return start, 0.0

    return path


def rotated(x: float, y: float, angle: float) -> tuple[float, float]:
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)


def in_room(trace: Trace, row: int) -> tuple[float, float]:
    """Center of the ring in the fixed frame, not on the table."""
    return rotated(*(float(trace[name][row]) for name in ("ring_x", "ring_y", "spindle_angle")))


def touch(plant: SpindleRing, surface: float) -> float:
    """Slide position with the pusher tip at a position on the surface."""
    return plant.pusher_start - surface
