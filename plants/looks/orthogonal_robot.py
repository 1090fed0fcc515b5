"""The mold under the ball, and the polished path on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from plants.looks import solids
from plants.looks.solids import Array
from plants.tools.molds import MOLDS

DOTS = 500
"""Number of drawn points of the path."""
RIM, FOOT = 7e-3, -3e-3
"""Radius and underside of the insert, m."""


def dress(spec: Any, p: Any, shown: Mapping[str, Array]) -> None:
    """Add the mold with its insert, and a dot on every polished point."""
    mold, radius = MOLDS[p.mold], p.mold_radius
    frame = spec.worldbody.add_body(name="insert", pos=[p.shift_x, p.shift_y, p.shift_z], quat=turned(p))
    solids.add(frame, spec, "surface", *solids.disc(mold.height, radius, FOOT), "steel")
    edge = np.linspace(0.0, 2.0 * math.pi, solids.AROUND)
    top = float(mold.height(radius * np.cos(edge), radius * np.sin(edge)).max())
    profile = np.array([(radius, FOOT), (RIM, FOOT), (RIM, top), (radius, top)])
    solids.add(frame, spec, "rim", *solids.lathe(profile), "cast")
    # the plane that touches the ball is no more than its tangent
    spec.geom("mold").rgba = [0.0, 0.0, 0.0, 0.0]
    looks = spec.find_default("looks")
    for i, row in enumerate(rubbed(shown)):
        at = [float(shown[f"contact_{axis}"][row]) for axis in "xyz"]
        # boxes: as balls they would be most of what is drawn
        dot = 3 * [0.045 * p.ball_radius]
        frame.add_geom(looks, name=f"rubbed{i}", type=solids.BOX, size=dot, pos=at, material="rubber")


def rubbed(shown: Mapping[str, Array]) -> Any:
    """Rows with a drawn point: those with contact, in equal steps."""
    rows = np.flatnonzero(shown["contact_force"] > 0.0)
    return rows[np.linspace(0, len(rows) - 1, min(DOTS, len(rows))).astype(int)] if len(rows) else rows


def turned(p: Any) -> list[float]:
    """Quaternion of a tilted mold."""
    vector, quaternion = np.array([p.tilt_x, p.tilt_y, p.tilt_z]), np.zeros(4)
    angle = float(np.linalg.norm(vector))
    mujoco.mju_axisAngle2Quat(quaternion, vector / (angle or 1.0), angle)
    return [float(part) for part in quaternion]


def draw(plant: Any, shown: Mapping[str, Array], row: int) -> None:
    """Show the dots polished so far."""
    for i, when in enumerate(rubbed(shown)):
        plant.model.geom(f"rubbed{i}").rgba[3] = float(when <= row)
