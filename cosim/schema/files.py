"""JSON schema of each kind of file."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from cosim.optimize.problem import Problem
from cosim.scenario.injection import INJECTED
from cosim.scenario.model import Scenario
from cosim.schema.tables import schema_of
from cosim.sweep.study import Study


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


SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    "scenario": scenario_schema,
    "study": functools.partial(schema_of, Study, "Study of cosim"),
    "optimization": functools.partial(schema_of, Problem, "Optimization of cosim"),
}
"""Functions that make the schemas, by the kind of the file."""
