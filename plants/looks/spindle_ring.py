"""The ring on its table, with probe and pusher in contact with an enlarged motion of the ring."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from plants.looks import solids
from plants.looks.solids import Array

BELOW, ABOVE = 0.002, 0.022
"""Bottom and top of the ring, m above the table."""
NEAR = 0.02
"""Gap between pusher and ring below which the slide follows the drawn ring, m."""


def dress(spec: Any, p: Any) -> None:
    """Add the ring on the table, with a mark that shows its rotation."""
    if not p.part_present:
        return
    ring, inner = spec.body("ring"), p.radius * (1.0 - p.wall)
    profile = np.array([(inner, BELOW), (p.radius, BELOW), (p.radius, ABOVE), (inner, ABOVE)])
    solids.add(ring, spec, "ring", *solids.lathe(profile), "brass")
    size = [0.4 * (p.radius - inner), 0.02 * p.radius, 2e-4]
    looks, middle = spec.find_default("looks"), 0.5 * (p.radius + inner)
    ring.add_geom(looks, type=solids.BOX, size=size, pos=[middle, 0.0, ABOVE], material="mark")


def draw(plant: Any, shown: Mapping[str, Array], row: int) -> None:
    """Move the probe and the slide to the drawn ring."""
    p, model, data = plant.parameters, plant.model, plant.data
    spindle, x, y = (float(data.joint(name).qpos[0]) for name in ("spindle", "ring_x", "ring_y"))
    along = math.cos(spindle) * x - math.sin(spindle) * y
    across = math.sin(spindle) * x + math.cos(spindle) * y
    surface = along + math.sqrt(max(p.radius**2 - across**2, 0.0))
    slide = data.joint("slide").qpos
    if p.part_present:
        share = min(max(1.0 - float(shown["pusher_gap"][row]) / NEAR, 0.0), 1.0)
        slide[0] -= share * (surface - float(shown["surface"][row]))
    free = plant.pusher_start - float(slide[0]) - surface if p.part_present else math.inf
    ahead = min(max(free, 0.0), p.probe_at_pusher)
    for name, behind in (("probe_ball", 0.0022), ("probe_rod", 0.0322)):
        model.geom(name).pos[0] = behind - ahead
