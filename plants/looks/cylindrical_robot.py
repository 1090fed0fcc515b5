"""The casting with its burr, which the tool removes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from plants.looks import solids
from plants.looks.solids import Array

PIECES = 160
"""Number of drawn pieces of the burr."""
THICK, DEEP = 0.018, 0.09
"""Half the height of the casting, and its width inward from the edge, m."""
BELOW = 0.012
"""Length of the tool below its tip, m."""
SEEN = 1e-4
"""Minimum drawn burr, m."""
SEED = 1e-3
"""Initial half size of a piece of burr, m."""


def dress(spec: Any, p: Any, edge: tuple[Any, ...], length: float) -> None:
    """Add the casting next to the path of the tool, with pieces of burr along its edge."""
    mill = [p.tool_radius, 0.5 * (p.tool_length - 0.145 + BELOW), 0.0]
    looks, at = spec.find_default("looks"), [0.0, 0.0, -0.145 - mill[1]]
    spindle = spec.body("spindle")
    spindle.add_geom(looks, type=solids.CYLINDER, size=mill, pos=at, material="brass")
    stations = np.linspace(p.burr_begin, max(length - p.burr_end, p.burr_begin), PIECES + 1)
    places, sides = along(edge, np.concatenate([[0.0], stations, [length]]))
    rim = places - p.tool_radius * sides
    inside = places.mean(axis=0) - 2.0 * DEEP * sides.mean(axis=0)
    # from the edge towards a place behind it: the casting is a plate of this outline
    outline = np.concatenate([rim, [inside]])
    world = spec.worldbody
    solids.add(world, spec, "casting", *solids.prism(outline, -THICK, THICK), "cast")
    if stations[-1] == stations[0]:
        return
    pieces, normals = along(edge, 0.5 * (stations[1:] + stations[:-1]))
    for i, (place, normal) in enumerate(zip(pieces, normals, strict=True)):
        turned = [math.cos(0.5 * heading(normal)), 0.0, 0.0, math.sin(0.5 * heading(normal))]
        root = place + (SEED - p.tool_radius) * normal
        size = [SEED, 0.55 * (stations[1] - stations[0]), SEED]
        world.add_geom(
            looks, name=f"burr{i}", type=solids.BOX, size=size, pos=root, quat=turned, material="burr"
        )


def heading(normal: Array) -> float:
    """Angle of a direction about the vertical, rad."""
    return math.atan2(float(normal[1]), float(normal[0]))


def along(edge: tuple[Any, ...], stations: Array) -> tuple[Array, Array]:
    """Points of the edge at distances from its start, and outward directions; shapes (stations, 3)."""
    start, corner, end = (np.array(point, dtype=float) for point in edge[:3])
    radius = float(edge[3])
    lines = [(b - a) / np.linalg.norm(b - a) for a, b in ((start, corner), (corner, end))]
    turn = np.cross(*lines)
    sine = float(np.linalg.norm(turn))
    angle = math.atan2(sine, float(lines[0] @ lines[1]))
    axis = turn / sine if sine > 1e-9 else np.array([0.0, 0.0, 1.0])
    enter = float(np.linalg.norm(corner - start)) - radius * math.tan(0.5 * angle)
    leave = corner + lines[1] * radius * math.tan(0.5 * angle)
    normals = [np.cross(line, axis) for line in lines]
    centre = start + enter * lines[0] - radius * normals[0]
    places, sides = [], []
    for station in stations:
        beyond = station - enter - radius * angle
        if station <= enter:
            place, normal = start + station * lines[0], normals[0]
        elif beyond >= 0.0:
            place, normal = leave + beyond * lines[1], normals[1]
        else:
            about = (station - enter) / radius
            normal = math.cos(about) * normals[0] + math.sin(about) * lines[0]
            place = centre + radius * normal
        places.append(place)
        sides.append(normal)
    return np.array(places), np.array(sides)


def draw(plant: Any, shown: Mapping[str, Array], row: int) -> None:
    """Set every piece of burr to its remaining size at this row."""
    p, model = plant.parameters, plant.model
    if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, "burr0") < 0:
        # nothing of the edge has a burr
        return
    heights, thicknesses = plant.burr
    there = np.concatenate([[False], np.diff(shown["burr_left"]) != 0.0]) | (shown["burr_left"] > 0.0)
    bins = np.linspace(0, len(heights), PIECES + 1).astype(int)
    for i in range(PIECES):
        height, thickness = (
            float(part[bins[i] : max(bins[i + 1], bins[i] + 1)].max()) for part in (heights, thicknesses)
        )
        station = p.burr_begin + p.burr_pitch * 0.5 * (bins[i] + bins[i + 1])
        passed = (shown["distance"][: row + 1] >= station) & there[: row + 1]
        if passed.any():
            height = min(height, max(float(shown["deviation"][int(np.argmax(passed))]), 0.0))
        geom = model.geom(f"burr{i}")
        geom.pos[:] += (0.5 * height - geom.size[0]) * outward(geom)
        geom.size[0], geom.size[2] = 0.5 * height, 0.5 * thickness
        geom.rgba[3] = float(height > SEEN)


def outward(geom: Any) -> Array:
    """Direction of a piece of burr away from the casting."""
    angle = 2.0 * math.atan2(float(geom.quat[3]), float(geom.quat[0]))
    return np.array([math.cos(angle), math.sin(angle), 0.0])
