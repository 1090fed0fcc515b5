"""JSON schemas of all kinds of files: they take what cosim takes, and refuse what it refuses."""

from __future__ import annotations

import copy
import importlib
import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from cosim.optimize.problem import problem_schema
from cosim.scenario.model import scenario_schema
from cosim.sweep.study import study_schema

ROOT = Path(__file__).resolve().parents[3]
SCENARIOS = sorted((ROOT / "scenarios").rglob("*.toml"))
STUDIES = sorted((ROOT / "studies").rglob("*.toml"))
DOB = tomllib.loads((ROOT / "scenarios" / "dob.toml").read_text())


def problems(schema: dict[str, Any], table: dict[str, Any]) -> list[str]:
    """List where a validator finds something wrong in a file."""
    validator = importlib.import_module("jsonschema").Draft7Validator
    validator.check_schema(schema)
    return [".".join(map(str, error.absolute_path)) for error in validator(schema).iter_errors(table)]


@pytest.mark.parametrize("file", SCENARIOS, ids=lambda file: file.relative_to(ROOT).as_posix())
def test_every_scenario_of_the_project_fits(file: Path) -> None:
    assert problems(scenario_schema(), tomllib.loads(file.read_text())) == []


@pytest.mark.parametrize("file", SCENARIOS, ids=lambda file: file.relative_to(ROOT).as_posix())
def test_no_two_metrics_of_a_scenario_are_described_alike(file: Path) -> None:
    metrics = tomllib.loads(file.read_text()).get("metric", [])
    told = [metric["description"] for metric in metrics if metric.get("description")]
    assert len(set(told)) == len(told)


@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.name)
def test_every_study_of_the_project_fits(file: Path) -> None:
    assert problems(study_schema(), tomllib.loads(file.read_text())) == []


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("loop.stpe", 1.0),
        ("loop.step", 0.0),
        ("loop.step", "fast"),
        ("loop.substeps", 0),
        ("loop.substeps", 1.5),
        ("loop.compute_delay", 2),
        ("wire.0.noise", -1.0),
        ("criterion.0.equals", "yes"),
        ("plot.panels.0.columns", "plant.depth"),
    ],
)
def test_what_cosim_refuses_is_refused_by_the_schema(key: str, value: Any) -> None:
    table = copy.deepcopy(DOB)
    *path, name = key.split(".")
    inner: Any = table
    for part in path:
        inner = inner[int(part)] if part.isdigit() else inner[part]
    inner[name] = value
    place = ".".join(path) if name == "stpe" else key
    assert problems(scenario_schema(), table) == [place]


@pytest.mark.parametrize(
    ("fault", "fits"),
    [
        ({"from_time": 0.1, "frozen": True}, True),
        ({"when": "controller.contact", "after": 0.1, "duration": 0.1, "late": 3}, True),
        ({"from_time": 0.1}, False),
        ({"from_time": 0.1, "scale": -1.0, "offset": 1.0}, False),
        ({"scale": -1.0}, False),
        ({"from_time": 0.1, "when": "controller.contact", "scale": -1.0}, False),
        ({"from_time": 0.1, "drop": 1.5}, False),
    ],
)
def test_an_injection_has_one_beginning_and_one_kind(fault: dict[str, Any], fits: bool) -> None:
    table = {**DOB, "inject": [{"to": "controller.position", **fault}]}
    assert (problems(scenario_schema(), table) == []) == fits


OPTIMIZATION = {
    "scenario": "dob",
    "vary": [{"key": "controller.gain", "minimum": 0.1, "maximum": 1.0, "distribution": "log-uniform"}],
    "objective": {"metric": "end", "direction": "maximize"},
    "search": {"trials": 10, "batch": 2, "seeds": [1, 2]},
    "limits": {"timeout": 10.0},
}


@pytest.mark.parametrize(
    ("key", "value", "place"),
    [
        ("search", {"trials": 10}, []),
        ("search", {"trails": 10}, ["search"]),
        ("search", {"seeds": [0.5]}, ["search.seeds.0"]),
        ("objective", {"metric": "end", "direction": "down"}, ["objective.direction"]),
        ("limits", {"timeout": 0.0}, ["limits.timeout"]),
        ("design", {"kind": "grid"}, [""]),
    ],
)
def test_an_optimization_has_a_schema(key: str, value: Any, place: list[str]) -> None:
    assert problems(problem_schema(), OPTIMIZATION) == []
    assert problems(problem_schema(), {**OPTIMIZATION, key: value}) == place


def test_only_a_scenario_that_extends_another_may_leave_things_out() -> None:
    short = {"title": "Short", "loop": {"duration": 1.0}}
    assert problems(scenario_schema(), short) != []
    assert problems(scenario_schema(), {"extends": "dob", **short}) == []


def test_keys_carry_their_texts_units_and_defaults() -> None:
    loop = scenario_schema()["properties"]["loop"]["properties"]
    assert loop["record_every"]["description"].startswith("Steps between two rows of the trace")
    assert (loop["seed"]["default"], loop["seed"]["minimum"]) == (1, 0)
    wire = scenario_schema()["properties"]["wire"]["items"]
    assert {"from", "to"} == set(wire["required"])


SCHEMAS = {"scenario": scenario_schema, "study": study_schema, "optimization": problem_schema}


@pytest.mark.parametrize("kind", [[], *([name] for name in SCHEMAS)])
def test_the_command_prints_strict_json(kind: list[str]) -> None:
    command = [sys.executable, "-m", "cosim", "schema", *kind]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    wanted = SCHEMAS[(kind or ["scenario"])[0]]()
    assert json.loads(done.stdout) == json.loads(json.dumps(wanted, allow_nan=False))
