"""Values of FMI variables: conversion from TOML to FMI types, and back to names."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from cosim.errors import FmuError, closest, concerning, show, similar
from cosim.fmu.description import Variable
from cosim.fmu.named import ALONE, NamedFmu

Value = float | int | bool | str


def encode(variable: Variable, value: Any, owner: NamedFmu = ALONE) -> Value:
    """Value of the FMI type of a variable of an FMU, or an error with the type.

    Enumerations take the item's name or number, Booleans `true`, `false`, 0 or 1; integers are never rounded.
    """
    match variable.kind:
        case "Enumeration":
            return item_number(variable, value, owner)
        case "Boolean" if isinstance(value, bool) or (is_number(value) and value in (0, 1)):
            return bool(value)
        case "String" if isinstance(value, str) and "\0" not in value:
            return value
    match variable.base:
        case "Real" if is_number(value) and (variable.kind != "Float32" or fits_float32(value)):
            return float(value)
        case "Integer" if is_whole(value) and fits(int(value), integer_type(variable.kind)):
            return int(value)
    wanted = {"Boolean": "true or false", "String": "a text without NUL characters"}
    wanted["Float32"] = "a number of 32 bits"
    if variable.base == "Integer":
        wanted[variable.kind] = integer_text(integer_type(variable.kind))
    problem = f"`{owner.name}.{variable.name}` is {show(value)}"
    raise FmuError(f"{problem}, it must be {wanted.get(variable.kind, 'a number')}")


def integer_type(kind: str) -> np.dtype[Any]:
    """Type of the values of an integer type of FMI; that of FMI 2.0 has 32 bits."""
    return np.dtype("int32" if kind == "Integer" else kind.lower())


def fits(number: int, dtype: np.dtype[Any]) -> bool:
    """Whether an integer type holds a number."""
    limits = np.iinfo(dtype)
    return bool(limits.min <= number <= limits.max)


def integer_text(dtype: np.dtype[Any]) -> str:
    """Name of an integer type in messages."""
    return f"an integer of {8 * dtype.itemsize} bits" + (" without a sign" if dtype.kind == "u" else "")


def fits_float32(value: float) -> bool:
    """Whether a number is in the range of 32 bits; infinities are."""
    return not math.isfinite(value) or abs(value) <= float(np.finfo(np.float32).max)


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
    """Variables and values of a table of parameters, or an error if one cannot be set.

    `bias = [1, 2]` sets `bias[1]` and `bias[2]`; a list of lists sets a matrix, by `bias[1,1]`.
    """
    flat: list[tuple[str, Any]] = []
    for name, value in parameters.items():
        if isinstance(value, list) and name not in variables:
            given = [(f"{name}[{index}]", item) for index, item in elements(value)]
            length = sum(known.startswith(f"{name}[") for known in variables)
            if 0 < length != len(given):
                raise FmuError(f"`{owner.name}.{name}` has {len(given)} values instead of {length}")
            flat += given
        else:
            flat.append((name, value))
    pairs = []
    for name, value in flat:
        with concerning(f"{owner.name}.parameters.{name}"):
            pairs.append((settable(variables, name, owner), encode(variables[name], value, owner)))
    return pairs


def elements(value: list[Any], *outer: int) -> Iterator[tuple[str, Any]]:
    """Find indices and values of the items of a list of any depth."""
    for index, item in enumerate(value, start=1):
        if isinstance(item, list):
            yield from elements(item, *outer, index)
        else:
            yield ",".join(map(str, (*outer, index))), item


def settable(variables: dict[str, Variable], name: str, owner: NamedFmu) -> Variable:
    """Variable that accepts a start value."""
    variable = lookup(variables, name, owner)
    if not variable.settable:
        if variable.variability == "constant":
            what = "is constant"
        elif variable.causality == "structuralParameter":
            what = "is a structural parameter"
        elif variable.kind in ("Binary", "Clock") or (variable.kind == "String" and variable.array):
            what = f"is {'an array' if variable.array else 'a variable'} of type `{variable.kind}`"
        else:
            what = f"of causality `{variable.causality}` is calculated"
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
