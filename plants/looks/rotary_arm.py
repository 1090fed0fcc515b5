"""The lens that the tool turns: the surface that its path leaves behind, drawn to the rim."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from plants.looks import solids
from plants.looks.solids import Array

ORDERS = 24
"""Harmonics of a turn in the surface."""
BACK = 0.035
"""Back of the part, depth in m."""


def dress(spec: Any, p: Any, shown: Mapping[str, Array]) -> None:
    """Clamp the part, and take the tool to the end of an arm of this length."""
    arm = spec.geom("arm")
    arm.size[0], arm.pos[0] = 0.5 * p.arm_length, -0.5 * p.arm_length - 0.0042
    spec.geom("shank").pos[0], spec.geom("diamond").pos[0] = -p.arm_length - 0.002, -p.arm_length
    for name in ("arm", "shank", "diamond"):
        spec.geom(name).pos[1] = p.tool_height
    place, depth, reach = tool_path(shown)
    if not len(depth):
        place, depth, reach = np.zeros(1), np.full(1, p.part_face), p.part_radius
    lens = solids.disc(surface(place, depth, reach), p.part_radius, BACK)
    # seen from the tool: depth goes into the part
    vertices, faces = lens
    solids.add(spec.body("spindle"), spec, "lens", vertices, faces[:, ::-1], "lens")


def tool_path(shown: Mapping[str, Array]) -> tuple[Array, Array, float]:
    """Angle on the part (rad), depth (m) and mean distance from the axis (m) of the tool while it cuts."""
    cuts = shown["cutting_force"] != 0.0
    if cuts[3 * len(cuts) // 4 :].any():
        # the arm is on its path by then
        cuts[: 3 * len(cuts) // 4] = False
    lateral = shown["tip_lateral"][cuts]
    # the part turns away below the tool
    angle = np.where(lateral < 0.0, math.pi, 0.0) - shown["spindle_angle"][cuts]
    return angle, shown["tip_depth"][cuts], float(np.abs(lateral).mean()) if cuts.any() else 0.0


def harmonics(angle: Array) -> Array:
    """Waves of a turn at an angle, last axis the waves."""
    phase = angle[..., None] * np.arange(ORDERS + 1)
    return np.concatenate([np.cos(phase), np.sin(phase[..., 1:])], axis=-1)


def surface(place: Array, depth: Array, reach: float) -> Any:
    """Depth over the part: along each radius a parabola from the deepest place to that of the tool's path."""
    # a path of less than a turn says little of some waves
    waves, *_ = np.linalg.lstsq(harmonics(place), depth, rcond=1e-3)
    deepest = float((harmonics(2.0 * math.pi * np.arange(360) / 360) @ waves).max())

    def height(x: Array, y: Array) -> Array:
        at_path = harmonics(np.arctan2(y, x)) @ waves
        found: Array = deepest + (x**2 + y**2) / max(reach, 1e-3) ** 2 * (at_path - deepest)
        return found

    return height
