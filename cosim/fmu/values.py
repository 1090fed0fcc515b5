"""Values of FMI variables: conversion from TOML to FMI types, and back to names."""

from __future__ import annotations

from typing import Any

from cosim.errors import FmuError, closest, concerning, show, similar
from cosim.fmu.archive import Variable
from cosim.fmu.named import ALONE, NamedFmu

Value = float | int | bool | str


def encode(variable: Variable, value: Any, owner: NamedFmu = ALONE) -> Value:
    """Value of the FMI type of a variable; `owner` is its FMU, for messages.

    Enumerations take the item's name or number, Booleans `true`, `false`, 0 or 1; numbers are never rounded.

    Raises
    ------
    FmuError
        The value does not fit the type; names the variable, the value and the type.
    """
    match variable.kind:
        case "Real" if is_number(value):
            return float(value)
        case "Integer" if is_whole(value) and abs(value) < 2**31:
            return int(value)
        case "Boolean" if isinstance(value, bool) or (is_number(value) and value in (0, 1)):
            return bool(value)
        case "String" if isinstance(value, str) and "\0" not in value:
            return value
        case "Enumeration":
            return item_number(variable, value, owner)
    kinds = {
        "Real": "a number",
        "Integer": "an integer of 32 bits",
        "Boolean": "true or false",
        "String": "a text without NUL characters",
    }
    raise FmuError(f"`{owner.name}.{variable.name}` is {show(value)}, it must be {kinds[variable.kind]}")


def item_number(variable: Variable, value: Any, owner: NamedFmu) -> int:
    """Find the number of an enumeration item given by name or number."""
    items = dict(variable.items)
    if isinstance(value, str) and value in items:
        return items[value]
    if is_whole(value) and int(value) in items.values():
        return int(value)
    names = ", ".join(f"`{name}`" for name in items)
    raise FmuError(
        f"`{owner.name}.{variable.name}` is {show(value)}, it must be one of {names}",
        similar(value, items) if isinstance(value, str) else "",
    )


def expand(
    variables: dict[str, Variable], parameters: dict[str, Any], owner: NamedFmu = ALONE
) -> list[tuple[Variable, Value]]:
    """Variables and values of a table of parameters; `bias = [1, 2]` sets `bias[1]` and `bias[2]`.

    Parameters
    ----------
    owner
        The FMU, for messages.

    Raises
    ------
    FmuError
        Unknown variable, wrong type, wrong array length, or a variable that cannot be set.
    """
    flat: list[tuple[str, Any]] = []
    for name, value in parameters.items():
        if isinstance(value, list) and name not in variables:
            length = sum(known.startswith(f"{name}[") for known in variables)
            if 0 < length != len(value):
                raise FmuError(f"`{owner.name}.{name}` has {len(value)} values instead of {length}")
            flat += [(f"{name}[{index}]", item) for index, item in enumerate(value, start=1)]
        else:
            flat.append((name, value))
    pairs = []
    for name, value in flat:
        with concerning(f"{owner.name}.parameters.{name}"):
            pairs.append((settable(variables, name, owner), encode(variables[name], value, owner)))
    return pairs


def settable(variables: dict[str, Variable], name: str, owner: NamedFmu) -> Variable:
    """Variable that accepts a start value."""
    variable = lookup(variables, name, owner)
    if not variable.settable:
        what = (
            "is constant"
            if variable.variability == "constant"
            else f"of causality `{variable.causality}` is calculated"
        )
        raise FmuError(
            f"`{owner.name}.{name}` {what} and cannot be set", "Set parameters or start values of inputs."
        )
    return variable


def beyond(variable: Variable, value: Any) -> str:
    """Text of the limit of a variable that a value exceeds; empty if there is none."""
    if is_number(value) and variable.minimum and value < float(variable.minimum):
        return f"below its minimum `{variable.minimum}`"
    if is_number(value) and variable.maximum and value > float(variable.maximum):
        return f"above its maximum `{variable.maximum}`"
    return ""


def lookup(variables: dict[str, Variable], name: str, owner: NamedFmu = ALONE) -> Variable:
    """Variable by name, or an error with the closest name."""
    if name not in variables:
        raise FmuError(f"{owner.who} has no variable `{name}`", closest(name, variables))
    return variables[name]


def is_number(value: Any) -> bool:
    """Whether the value is a number and not a Boolean."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def is_whole(value: Any) -> bool:
    """Whether the value is a number without a fraction."""
    return is_number(value) and float(value).is_integer()
