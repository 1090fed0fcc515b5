"""JSON schemas of the files from their dataclasses, for completion and checks in editors."""

from __future__ import annotations

import dataclasses
import functools
import inspect
import math
import re
import types
import typing
from collections.abc import Callable, Mapping
from typing import Any, Literal

from cosim.optimize.problem import Problem
from cosim.scenario.injection import INJECTED
from cosim.scenario.model import Scenario
from cosim.scenario.ranges import LARGEST
from cosim.scenario.tables import is_required, toml_key
from cosim.sweep.study import Study

DIALECT = "http://json-schema.org/draft-07/schema#"
"""JSON schema draft that TOML editors support."""
TYPES = {str: "string", bool: "boolean", int: "integer", float: "number"}


def scenario_schema() -> dict[str, Any]:
    """JSON schema of a scenario file; a file that extends another gives only the differences."""
    layered = {
        "extends": {"type": "string", "description": "Name or file of the scenario that this one extends."},
        "drop": {
            "type": "array",
            "items": {"type": "string"},
            "description": "Items that are not inherited, such as `criterion` or `criterion.<id>`.",
        },
    }
    found = schema_of(Scenario, "Scenario of cosim", **layered)
    parts = found["properties"]
    parts["inject"]["items"]["allOf"] = [one_of("from_time", "when"), one_of(*INJECTED)]
    alone = {
        "required": found.pop("required"),
        **one_of("controller", "fmu"),
        "properties": {
            name: {"required": parts[name].pop("required")} for name in ("loop", "controller", "plant")
        },
    }
    return {**found, "if": {"not": {"required": ["extends"]}}, "then": alone}


def one_of(*keys: str) -> dict[str, Any]:
    """JSON schema of a table that holds exactly one of some keys."""
    return {"oneOf": [{"required": [key]} for key in keys]}


def schema_of(kind: Any, title: str, **more: Any) -> dict[str, Any]:
    """JSON schema of the file of a dataclass; `more` are additional keys of the file."""
    found = described(kind)
    return {"$schema": DIALECT, "title": title, **found, "properties": {**more, **found["properties"]}}


def described(kind: Any) -> dict[str, Any]:
    """Describe a dataclass without additional keys."""
    hints, texts = typing.get_type_hints(kind), parameter_texts(kind)
    fields = [field for field in dataclasses.fields(kind) if toml_key(field)]
    properties = {}
    for field in fields:
        entry = {**schema(hints[field.name]), **limits(field.metadata)}
        text = texts.get(field.name, "") or field.metadata.get("description", "")
        properties[toml_key(field)] = entry | explained(text, field.metadata.get("unit", ""))
        # TOML has no null, and an empty text is not set
        if isinstance(field.default, str | bool | int | float) and field.default != "":
            properties[toml_key(field)]["default"] = field.default
    return {
        "type": "object",
        "description": (inspect.getdoc(kind) or "").partition("\n")[0],
        "properties": properties,
        "required": [toml_key(field) for field in fields if is_required(field)],
        "additionalProperties": False,
    }


def explained(text: str, unit: str) -> dict[str, Any]:
    """Return the description and unit."""
    has_unit = unit in ("", "1") or re.search(rf" {re.escape(unit)}(\W|$)", text)
    text = text if has_unit else f"{text} ({unit})".lstrip()
    return {"description": text} if text else {}


def parameters(entries: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
    """Describe a table of parameters, whose dotted names can also be nested tables."""
    flat: dict[str, Any] = {"type": "object", "properties": {}, "additionalProperties": False}
    for name, entry in entries.items():
        flat["properties"][name] = entry
        table, (*around, last) = flat, name.split(".")
        for part in around:
            inner = {"type": "object", "properties": {}, "additionalProperties": False}
            table = table["properties"].setdefault(part, inner)
        table.get("properties", {})[last] = entry
    return flat


def schema(kind: Any) -> dict[str, Any]:
    """Describe an annotated type."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is types.UnionType or origin is typing.Union:
        # TOML has no null: what may be None may be left out
        choices = [schema(choice) for choice in arguments if choice is not types.NoneType]
        return choices[0] if len(choices) == 1 else {"anyOf": choices}
    if origin is Literal:
        return {"enum": list(arguments)}
    if origin is tuple:
        return {"type": "array", "items": schema(arguments[0])}
    if origin is dict:
        return {"type": "object", "additionalProperties": schema(arguments[1])}
    if dataclasses.is_dataclass(kind):
        return described(kind)
    return {"type": TYPES[kind]} if kind in TYPES else {}


def limits(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Range of a number; infinite ends are omitted, because JSON has no infinity and NaN."""
    if "options" in metadata:
        return {"enum": list(metadata["options"])}
    low, high = metadata.get("minimum", -math.inf), metadata.get("maximum", math.inf)
    found: dict[str, Any] = {}
    if low == math.ulp(0.0):
        found["exclusiveMinimum"] = 0
    elif low > -LARGEST:
        found["minimum"] = low
    if high < LARGEST:
        found["maximum"] = high
    return found


def parameter_texts(kind: Any) -> dict[str, str]:
    """Texts of the fields in the docstring of a dataclass."""
    _, _, section = (inspect.getdoc(kind) or "").partition("Parameters\n----------\n")
    texts: dict[str, str] = {}
    for names, text in re.findall(r"^(\w[\w, ]*)\n((?:^ +.*\n?)+)", section, re.MULTILINE):
        texts |= dict.fromkeys(re.split(r", *", names), " ".join(text.split()))
    return texts


SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    "scenario": scenario_schema,
    "study": functools.partial(schema_of, Study, "Study of cosim"),
    "optimization": functools.partial(schema_of, Problem, "Optimization of cosim"),
}
