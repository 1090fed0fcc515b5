"""What a run is worth: a metric with criteria as constraints, or its distance from what was measured."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosim import paths
from cosim.compare.tube import interpolated
from cosim.errors import CosimError, ScenarioError, closest
from cosim.loop.result import Result
from cosim.optimize.problem import Problem
from cosim.scenario.model import Criterion, Scenario
from cosim.sweep.store import DONE, Row
from cosim.trace.files import read
from cosim.trace.stored import StoredTrace

MISFIT = "misfit"
"""Metric of a calibration: mean square of all deviations, each in standard deviations of its column."""
VIOLATED = 1e-12
"""Least violation of a criterion that does not hold."""


@dataclass(frozen=True)
class Score:
    """What a trial is worth.

    Parameters
    ----------
    value
        Mean of the objective over its runs; None if a run gave no number.
    violations
        Of each criterion the worst of its runs, above 0 where it does not hold.
    reason
        Why there is no value.
    """

    value: float | None
    violations: tuple[float, ...] = ()
    reason: str = ""

    @property
    def feasible(self) -> bool:
        """Whether it has a value and holds all criteria."""
        return self.value is not None and all(violation <= 0.0 for violation in self.violations)


def measured(problem: Problem, scenario: Scenario) -> StoredTrace | None:
    """Trace to come close to, None without one.

    Raises
    ------
    CosimError
        It cannot be read, lacks a column that is asked for, or is longer than the scenario.
    """
    if not problem.objective.trace:
        return None
    origin = f"`{paths.shown(problem.file)}`"
    found = read(problem.file.parent / problem.objective.trace)
    for name in problem.objective.columns:
        if name not in found.columns:
            text = f"{origin}: `objective.columns` holds `{name}`, which `{paths.shown(found.file)}` lacks"
            raise ScenarioError(text, closest(name, found.columns))
    if not found.columns:
        raise CosimError(f"`{paths.shown(found.file)}` has no columns beside `time`")
    for name in problem.objective.columns or found.columns:
        check_measured(name, found)
    end = scenario.loop.duration + scenario.loop.step
    if found.times[-1] > end:
        text = f"`{paths.shown(found.file)}` ends at {found.times[-1]:g} s, the scenario at {end:g} s"
        raise CosimError(text, "set `loop.duration` in `[set]`, or cut the trace")
    return found


def check_measured(name: str, found: StoredTrace) -> None:
    """Check that a column holds numbers from which a deviation can be told.

    Raises
    ------
    CosimError
        None of them is finite, or their spread is not.
    """
    known = found.data[name][np.isfinite(found.data[name])]
    if not known.size:
        raise CosimError(f"`{name}` in `{paths.shown(found.file)}` holds no finite number")
    with np.errstate(over="ignore"):
        spread = np.std(known)
    if not np.isfinite(spread):
        low, high = np.min(known), np.max(known)
        told = f"goes from {low:g} to {high:g}, whose spread is beyond all numbers"
        raise CosimError(f"`{name}` in `{paths.shown(found.file)}` {told}")


def misfit(result: Result, target: StoredTrace, columns: Sequence[str]) -> float:
    """Mean square of the deviations from a measured trace, each in standard deviations of its column.

    The simulated course is interpolated at the times of the measured one; where that has NaN nothing counts.
    A run that ended before the last of these times is infinitely far off.

    Raises
    ------
    CosimError
        The run has no trace or no such column, or it has another unit.
    """
    simulation = result.columns
    times = simulation["time"]
    # a row stands for the time up to the next
    end = result.simulated_s + (times[1] if len(times) > 1 else 0.0)
    squares = []
    for name in columns or target.columns:
        if name not in simulation:
            text = f"`{paths.shown(target.file)}` has the column `{name}`, which is not in the trace of a run"
            raise CosimError(text, closest(name, simulation))
        units = target.units.get(name, ""), result.units.get(name, "")
        if all(units) and units[0] != units[1]:
            text = (
                f"`{name}` in `{paths.shown(target.file)}` is in `{units[0]}`, that of a run in `{units[1]}`"
            )
            raise CosimError(text)
        wanted = target.data[name]
        known = np.isfinite(wanted)
        if np.any(target.times[known] > end):
            return math.inf
        simulated = interpolated(times, simulation[name], target.times[known])
        scale = float(np.std(wanted[known])) or 1.0
        squares.append(np.square((simulated - wanted[known]) / scale))
    return float(np.mean(np.concatenate(squares)))


def score(problem: Problem, scenario: Scenario, rows: Sequence[Row]) -> Score:
    """Score of a trial from the rows of its runs."""
    lost = next((row for row in rows if row["status"] not in DONE), None)
    if lost is not None:
        return Score(None, reason=str(lost["reason"]))
    name = problem.objective.metric or MISFIT
    value = float(np.mean([float(row["metrics"][name]) for row in rows]))
    if not math.isfinite(value):
        early = ": the run ended before what was measured" if (name, value) == (MISFIT, math.inf) else ""
        return Score(None, reason=f"`{name}` is {value}{early}")
    held = scenario.criterion if problem.objective.metric else ()
    return Score(value, tuple(max(violation(entry, row) for row in rows) for entry in held))


def violation(criterion: Criterion, row: Row) -> float:
    """How far a criterion is from holding, as a part of its limit; 0 where it holds.

    The verdict of the run decides, the distance only tells the search which way to go.
    """
    if row["criteria"][criterion.id]:
        return 0.0
    value = float(row["metrics"][criterion.metric])
    if not math.isfinite(value):
        return 1.0 / VIOLATED
    limits = (criterion.minimum, criterion.maximum, criterion.equals)
    signs = (-1.0, 1.0, 0.0)
    beyond = []
    for limit, sign in zip(limits, signs, strict=True):
        if limit is not None:
            distance = sign * (value - float(limit)) if sign else abs(value - float(limit))
            beyond.append(distance / (abs(float(limit)) or 1.0))
    return min(max(VIOLATED, *beyond), 1.0 / VIOLATED)
