"""The motion of a run: a MuJoCo model and its coordinates row by row."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from cosim.errors import CosimError
from cosim.loop import plant as plants
from cosim.loop.reference import reset_plant
from cosim.loop.result import Result
from cosim.loop.wires.transform import child
from cosim.scenario.model import Scenario
from cosim.trace.columns import Array, Columns
from cosim.trace.stored import StoredTrace

Enlarged = Callable[[str, float], float]
"""Value of a coordinate as it is drawn, by its name without `plant.qpos.`."""
COORDINATE = "plant.qpos."
"""Prefix of the columns of coordinates."""
RECORD = "loop.record_qpos=true"
"""Override with which a run keeps its coordinates."""


@dataclass(frozen=True)
class Recorded:
    """A recorded run for replay: its scenario with the plant, and the trace with MuJoCo's coordinates.

    The seed gives random initial values without coordinates. `items` are those of enumerations.
    """

    scenario: Scenario
    seed: int
    columns: Columns
    units: dict[str, str] = field(default_factory=dict)
    items: dict[str, dict[str, int]] = field(default_factory=dict)


def of_result(scenario: Scenario, result: Result) -> Recorded:
    """Return the recorded run of a result."""
    return Recorded(scenario, result.seed, result.columns, result.units, result.items)


def of_trace(scenario: Scenario, trace: StoredTrace) -> Recorded:
    """Return the recorded run of a file; the default seed is that of the scenario."""
    seed = trace.about.get("seed")
    seed = seed if type(seed) is int and seed >= 0 else scenario.loop.seed
    return Recorded(scenario, seed, trace.data, trace.units, trace.items)


@dataclass(frozen=True)
class Motion:
    """A model of MuJoCo with its data, and its coordinates `qpos`, shape (rows, coordinates).

    `names` and `units` are those of the coordinates, `times` those of the rows, s. Model and data may be
    changed, because they are drawn and never stepped. `draw` moves parts that are only drawn to a row, after
    its coordinates are set.
    """

    model: Any
    data: Any
    names: tuple[str, ...]
    units: tuple[str, ...]
    times: Array
    qpos: Array
    draw: Callable[[int, Enlarged], None] = lambda row, enlarged: None


def motion(recorded: Recorded) -> Motion:
    """Build the plant of a run, which must be one of MuJoCo, and take its coordinates from the trace."""
    scenario = recorded.scenario
    plant: Any = plants.build(scenario.plant.name, scenario.plant.parameters, scenario.folder)
    plants.record_qpos(plant, scenario.plant.name)
    coordinates = plant.coordinates
    names = tuple(f"plant.{one.name}" for one in coordinates)
    own = [name for name in recorded.columns if name.startswith("plant.")]
    shown = {name.removeprefix("plant."): recorded.columns[name] for name in own}
    check(recorded.columns, names, scenario)
    if hasattr(plant, "drawn"):
        # drawing may need any ground-truth signal of the plant
        check(recorded.columns, tuple(f"plant.{one.name}" for one in plant.truths), scenario)
        plant = plant.drawn(shown)
    # what is placed at the start and has no coordinates
    reset_plant(plant, scenario, child(recorded.seed, "plant"))
    units = tuple(one.unit for one in coordinates)
    qpos = np.column_stack([recorded.columns[name] for name in names])
    draw = {"draw": partial(plant.draw, shown)} if hasattr(plant, "draw") else {}
    return Motion(plant.model, plant.data, names, units, recorded.columns["time"], qpos, **draw)


def check(columns: Columns, names: tuple[str, ...], scenario: Scenario) -> None:
    """Check that a trace holds the coordinates of a plant."""
    if not names:
        raise CosimError(f"the plant `{scenario.plant.name}` has no joint, so nothing moves")
    if not any(name.startswith(COORDINATE) for name in columns):
        hint = f"Record them with `cosim run {scenario.name} --set {RECORD} --trace FILE`."
        raise CosimError("the trace holds no coordinates", hint)
    if missing := [name for name in names if name not in columns]:
        problem = f"the trace has no column `{missing[0]}`, which the plant `{scenario.plant.name}` has"
        raise CosimError(problem, "Name the scenario of the run, with the same `--set`.")
