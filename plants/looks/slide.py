"""The workpiece under the tool, at its drawn distance."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from plants.looks.solids import Array


def draw(plant: Any, shown: Mapping[str, Array], row: int, enlarged: Callable[[str, float], float]) -> None:
    """Put the top of the workpiece at its contact with the tool in the picture."""
    model, top = plant.model, -enlarged("z", float(shown["surface"][row]))
    workpiece = model.geom("workpiece")
    if plant.parameters.workpiece:
        workpiece.pos[2] = top - workpiece.size[2]
    else:
        workpiece.rgba[3] = 0.0
