"""Captions of a picture: time, states, key numbers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cosim.formatting.quantity import PREFIXED, number, text
from cosim.replay.motion import COORDINATE, Recorded

MAX_STATES, MAX_NUMBERS = 2, 4
STEP = 1e-3
"""Resolution of a shown value, as a fraction of the maximum of its column."""
Line = Callable[[int], str]
"""Text for a row of the trace."""


def lines(recorded: Recorded) -> list[Line]:
    """Lines of a picture: time, changing enumerations, states first, then key numbers."""
    times = recorded.columns["time"]
    moving = [name for name in recorded.items if name in recorded.columns and np.ptp(recorded.columns[name])]
    states = sorted(moving, key=lambda name: not name.endswith(".state"))[:MAX_STATES]
    digits = max(0, min(6, 2 - int(np.floor(np.log10(max(times[-1], 1e-6) / 10.0)))))
    return [
        lambda row: f"t = {times[row]:.{digits}f} s",
        *(state(recorded, name) for name in states),
        *numbers(recorded)[:MAX_NUMBERS],
    ]


def state(recorded: Recorded, name: str) -> Line:
    """Name of the item at a row."""
    column = recorded.columns[name]
    items = {number: item for item, number in recorded.items[name].items()}
    label = name.partition(".")[2]
    return lambda row: f"{label}: {items.get(int(column[row]), number(float(column[row])))}"


def numbers(recorded: Recorded) -> list[Line]:
    """Key numbers: the first column of each panel, or changing ground-truth signals."""
    found = [
        quantity(recorded, name, panel.unit, panel.scale)
        for panel in recorded.scenario.plot.panels
        for name in panel.columns[:1]
        if name in recorded.columns and name not in recorded.items
    ]
    truths = [n for n in recorded.columns if n.startswith("plant.") and not n.startswith(COORDINATE)]
    return found or [quantity(recorded, name) for name in truths if np.ptp(recorded.columns[name]) > 0.0]


def quantity(recorded: Recorded, name: str, unit: str = "", scale: float = 1.0) -> Line:
    """Value of a column at a row, with a unit prefix or in the unit of its panel.

    Changes below a thousandth of the maximum are not shown, to avoid flicker.
    """
    label = name.partition(".")[2]
    own = recorded.units.get(name, "")
    column = recorded.columns[name]
    least = STEP * float(np.max(np.abs(column), where=np.isfinite(column), initial=0.0)) or 1.0

    def text_of(row: int) -> str:
        value = 0.0 if abs(column[row]) < least else float(column[row])
        if own not in PREFIXED and (unit or scale != 1.0):
            return f"{label}: {number(scale * value, 3)} {unit}".rstrip()
        return f"{label}: {text(value, own, 3)}"

    return text_of
