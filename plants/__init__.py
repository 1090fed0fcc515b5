"""MuJoCo plants: one `<plant>.py` and `<plant>.xml` each, found by name.

Importing this package is cheap; MuJoCo is imported when the first plant is loaded.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from plants.base.names import unknown

if TYPE_CHECKING:
    from plants.base.plant import Plant

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
    UnknownNameError
        There is no plant of that name, or its module lacks the class that `PLANTS` names.
    """
    if name not in PLANTS:
        raise unknown("plant", name, PLANTS)
    module = import_module(f"plants.{name}")
    plant: type[Plant] | None = getattr(module, PLANTS[name], None)
    if plant is None:
        classes = [key for key, value in vars(module).items() if isinstance(value, type)]
        own = [key for key in classes if getattr(module, key).__module__ == module.__name__]
        raise unknown(f"class for `PLANTS` in `plants/{name}.py` named", PLANTS[name], own)
    return plant
