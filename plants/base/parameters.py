"""Parameters of a plant: dataclass fields with unit, description, source and range."""

import math
from dataclasses import Field, field, fields
from typing import Any

CHOSEN = "default"
"""Source of a default without a paper."""


class ParameterError(ValueError):
    """A parameter has the wrong type or is outside its range."""


def parameter(
    default: float | bool,
    unit: str,
    description: str,
    minimum: float = -math.inf,
    maximum: float = math.inf,
    source: str = CHOSEN,
) -> Any:
    """Field of a parameter dataclass.

    Parameters
    ----------
    default : float or bool
        Value of the nominal plant.
    unit : str
        SI unit, `1` for a plain number and for a Boolean.
    description : str
        Description in one sentence.
    minimum, maximum : float
        Closed range of the value.
    source : str
        Source of the default.

    Raises
    ------
    ParameterError
        The default is outside its range.
    """
    if not minimum <= default <= maximum:
        limit = f"limit `{minimum:g}` to `{maximum:g}` {unit}"
        raise ParameterError(f"the default of `{description}`: value `{default:g}` {unit}, {limit}")
    metadata = {
        "unit": unit,
        "description": description,
        "source": source,
        "minimum": minimum,
        "maximum": maximum,
    }
    return field(default=default, metadata=metadata)


def choice(default: str, description: str, options: tuple[str, ...], source: str = CHOSEN) -> Any:
    """Field of a parameter dataclass with a list of names.

    Parameters
    ----------
    default : str
        Name for the nominal plant.
    description : str
        Description in one sentence.
    options : tuple of str
        The names.
    source : str
        Source of the default.
    """
    metadata = {"unit": "1", "description": description, "source": source, "options": options}
    return field(default=default, metadata=metadata)


def check(parameters: Any, plant: str) -> None:
    """Check the values of a parameter dataclass against type and range.

    Raises
    ------
    ParameterError
        The first invalid field: its name, value and limit.
    """
    for item in fields(parameters):
        name, value = item.metadata.get("key", item.name), getattr(parameters, item.name)
        # an MJCF may say what this range does not hold, such as a negative stiffness
        if value is not item.default:
            _check_field(f"plant.{name}", value, item, plant)


def _check_field(name: str, value: object, item: Field[Any], plant: str) -> None:
    if "options" in item.metadata:
        if value not in item.metadata["options"]:
            wanted = "`, `".join(item.metadata["options"])
            raise ParameterError(f"parameter `{name}` of plant `{plant}`: value `{value}`, one of `{wanted}`")
        return
    boolean = isinstance(item.default, bool)
    if isinstance(value, bool) != boolean or not isinstance(value, int | float):
        wanted = "true or false" if boolean else "a number"
        raise ParameterError(f"parameter `{name}` of plant `{plant}`: value `{value!r}`, expected {wanted}")
    low, high, unit = item.metadata["minimum"], item.metadata["maximum"], item.metadata["unit"]
    if not low <= value <= high:  # also refuses NaN
        limit = f"limit `{low:g}` to `{high:g}` {unit}"
        raise ParameterError(f"parameter `{name}` of plant `{plant}`: value `{value:g}` {unit}, {limit}")
