"""JSON schemas of all kinds of files accept and reject the same files as cosim."""

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

from cosim.cli import tasks
from cosim.pool.worker import JobRunner
from cosim.scenario.kinds import kind_of
from cosim.schema.files import SCHEMAS, scenario_schema

from ..loop.several import LOOP, fmu

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
    reported = [metric["description"] for metric in metrics if metric.get("description")]
    assert len(set(reported)) == len(reported)


@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.name)
def test_every_study_of_the_project_fits(file: Path) -> None:
    table = tomllib.loads(file.read_text())
    kind = kind_of(table)
    assert kind is not None
    assert problems(SCHEMAS[kind](), table) == []


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
def test_what_cosim_rejects_is_rejected_by_the_schema(key: str, value: Any) -> None:
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


def filled(loop: str) -> dict[str, Any]:
    """Make the schema with the FMUs and the plant of a scenario."""
    with JobRunner() as runner:
        found: dict[str, Any] = runner.run(tasks.TaskCall(tasks.schema, (loop,)))
    return found


@pytest.mark.parametrize("file", SCENARIOS, ids=lambda file: file.relative_to(ROOT).as_posix())
def test_every_scenario_fits_the_schema_with_its_own_fmu_and_plant(file: Path) -> None:
    assert problems(filled(str(file)), tomllib.loads(file.read_text())) == []


@pytest.mark.parametrize(
    ("table", "name", "value", "place"),
    [
        ("controller", "approach.velocity", 1e-4, ""),
        ("controller", "approach.velocity", 1.0, "approach.velocity"),
        ("controller", "approach", {"velocitty": 1e-4}, "approach"),
        ("controller", "approach", {"velocity": "fast"}, "approach.velocity"),
        ("controller", "law", "Papper", "law"),
        ("controller", "approach.depth_limit", 1e-3, "."),
        ("plant", "mass", 5.0, ""),
        ("plant", "mass", -5.0, "mass"),
        ("plant", "mas", 5.0, "."),
    ],
)
def test_parameters_are_checked_by_their_own_names_and_ranges(
    table: str, name: str, value: Any, place: str
) -> None:
    changed = copy.deepcopy(DOB)
    changed[table]["parameters"] = {name: value}
    assert problems(scenario_schema(), changed) == []
    inside = f"{table}.parameters"
    wanted = {"": [], ".": [inside]}.get(place, [f"{inside}.{place}"])
    assert problems(filled("dob"), changed) == wanted


def test_parameters_carry_their_texts_units_and_defaults() -> None:
    tables = filled("dob")["properties"]
    plant = tables["plant"]["properties"]["parameters"]["properties"]
    assert plant["timestep"] == {
        "type": "number",
        "minimum": 1e-6,
        "maximum": 1e-3,
        "description": "Plant step (s)",
        "default": 5e-5,
    }
    controller = tables["controller"]["properties"]["parameters"]["properties"]
    assert controller["law"]["enum"][::2] == ["Default", "Paper"]
    assert controller["stage.mass"]["description"] == "Nominal moving mass (kg)"
    assert controller["stage"]["properties"]["mass"] == controller["stage.mass"]


def test_of_several_fmus_each_has_its_own_parameters(folder: Path) -> None:
    bias = LOOP + fmu("first", bias=[0.5, 0.25], gain=2) + fmu("second")
    (folder / "two.toml").write_text(bias)
    schema, table = filled("two.toml"), tomllib.loads(bias)
    assert problems(schema, table) == []
    table["fmu"][1]["parameters"] = {"bias": [0.5], "gian": 2.0}
    assert sorted(problems(schema, table)) == ["fmu.1.parameters", "fmu.1.parameters.bias"]


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
    assert problems(SCHEMAS["optimization"](), OPTIMIZATION) == []
    assert problems(SCHEMAS["optimization"](), {**OPTIMIZATION, key: value}) == place


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


@pytest.mark.parametrize("kind", [[], *([name] for name in SCHEMAS)])
def test_the_command_prints_strict_json(kind: list[str]) -> None:
    command = [sys.executable, "-m", "cosim", "schema", *kind]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    wanted = SCHEMAS[(kind or ["scenario"])[0]]()
    assert json.loads(done.stdout) == json.loads(json.dumps(wanted, allow_nan=False))


def test_the_command_takes_a_scenario_for_scenarios_alone() -> None:
    command = [sys.executable, "-m", "cosim", "schema"]
    done = subprocess.run([*command, "--for", "dob"], capture_output=True, text=True, cwd=ROOT, check=True)
    assert json.loads(done.stdout) == json.loads(json.dumps(filled("dob"), allow_nan=False))
    wrong = [*command, "study", "--for", "dob"]
    refused = subprocess.run(wrong, capture_output=True, text=True, cwd=ROOT, check=False)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert "error: `--for` works only for the schema of scenarios" in refused.stderr
