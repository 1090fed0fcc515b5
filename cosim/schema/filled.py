"""JSON schema of scenario files with the settings of given FMUs and a given plant."""

from __future__ import annotations

import contextlib
import itertools
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

from cosim.fmu.description import Variable
from cosim.fmu.named import ALONE
from cosim.scenario.model import Scenario
from cosim.schema import files as schema

TYPES = {"Real": "number", "Integer": "integer"}


def filled_schema(
    scenario: Scenario, variables: Mapping[str, Mapping[str, dict[str, Any]]], plant: Any
) -> dict[str, Any]:
    """JSON schema of a scenario file with the variables of its FMUs and the parameters of its plant."""
    found = schema.scenario_schema()
    parts = found["properties"]
    tables = {name: {"parameters": schema.parameters(entries)} for name, entries in variables.items()}
    if scenario.fmu:
        parts["fmu"]["items"]["allOf"] = [
            {"if": {"properties": {"name": {"const": name}}}, "then": {"properties": table}}
            for name, table in tables.items()
        ]
    else:
        parts["controller"]["properties"] |= tables[ALONE.name]
    parts["plant"]["properties"]["parameters"] = schema.parameters(schema.described(plant)["properties"])
    return {**found, "title": f"Scenario of cosim with FMU and plant of {scenario.name}"}


def settable_variables(variables: Iterable[Variable]) -> dict[str, dict[str, Any]]:
    """Describe the permitted parameters by name; an array as a whole and by its elements."""
    found: dict[str, dict[str, Any]] = {}
    for variable in (variable for variable in variables if variable.settable):
        found[variable.name] = entry = described(variable)
        if "," in variable.name.rpartition("[")[2]:
            found.setdefault(variable.array, {"type": "array", "items": {"type": "array", "items": entry}})
        elif array := re.fullmatch(r"(.+)\[\d+\]", variable.name):
            whole = found.setdefault(array[1], {"type": "array", "items": entry, "minItems": 0})
            whole["minItems"] = whole["maxItems"] = whole["minItems"] + 1
    return found


def described(variable: Variable) -> dict[str, Any]:
    """Describe one variable: type, range, start value and description."""
    labels = schema.explained(variable.description, variable.unit)
    if variable.kind == "Enumeration":
        names = {str(number): name for name, number in variable.items}
        return {"enum": [*itertools.chain(*variable.items)], **labels, **default(names.get(variable.start))}
    if variable.kind == "Boolean":
        start = variable.start in ("true", "1") if variable.start else None
        return {"enum": [True, False, 0, 1], **labels, **default(start)}
    if variable.kind == "String":
        return {"type": "string", **labels, **default(variable.start or None)}
    numbers = {"minimum": variable.minimum, "maximum": variable.maximum, "default": variable.start}
    found: dict[str, Any] = {"type": TYPES[variable.base], **labels}
    for name, text in numbers.items():
        with contextlib.suppress(ValueError):
            number = int(text) if variable.base == "Integer" else float(text)
            if math.isfinite(number):  # JSON has no infinity and NaN
                found[name] = number
    return found


def default(value: str | bool | None) -> dict[str, Any]:
    """Describe a start value, if there is one."""
    return {} if value is None else {"default": value}
