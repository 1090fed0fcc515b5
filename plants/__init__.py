"""MuJoCo plants: one `<plant>.py` and `<plant>.xml` each, found by name.

Importing this package is cheap; MuJoCo is imported when the first plant is loaded.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from plants.plant import Plant

PLANTS = {
    "cylindrical_robot": "CylindricalRobot",
    "orthogonal_robot": "OrthogonalRobot",
    "rotary_arm": "RotaryArm",
    "slide": "Slide",
    "spindle_ring": "SpindleRing",
}
"""Class of each plant by the name of its module."""


def names() -> list[str]:
    """Names of the plants."""
    return sorted(PLANTS)


def load(name: str) -> "type[Plant]":
    """Class of a plant.

    Raises
    ------
    KeyError
        There is no plant of that name.
    """
    if name not in PLANTS:
        raise KeyError(f"no plant `{name}`\nhint: the plants are `{'`, `'.join(names())}`")
    plant: type[Plant] = getattr(import_module(f"plants.{name}"), PLANTS[name])
    return plant
