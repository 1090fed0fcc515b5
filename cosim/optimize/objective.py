"""The objective of a run: a metric with criteria as constraints, or the distance from a measured trace."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosim import paths
from cosim.errors import CosimError, ScenarioError, closest
from cosim.loop.result import Result
from cosim.metrics.criteria import RELATIONS, Verdict
from cosim.optimize.problem import Problem
from cosim.scenario.model import Criterion, Scenario
from cosim.study.store import DONE, Row, verdicts
from cosim.trace.columns import interpolated
from cosim.trace.files import read
from cosim.trace.stored import StoredTrace

MISFIT = "misfit"
"""Metric of a calibration: mean square of all deviations, each in standard deviations of its column."""
VIOLATED = 1e-12
"""Minimum violation of a failed criterion."""


@dataclass(frozen=True)
class Score:
    """Score of a trial."""

    value: float | None
    """Mean of the objective over its runs; None if a run gave no number."""
    violations: tuple[float, ...] = ()
    """Worst violation of each criterion over the runs; above 0 if it failed."""
    reason: str = ""
    """Reason for a missing value."""

    @property
    def feasible(self) -> bool:
        """Whether it has a value and passes all criteria."""
        return self.value is not None and all(violation <= 0.0 for violation in self.violations)


def measured(problem: Problem, scenario: Scenario) -> StoredTrace | None:
    """Target trace with the requested columns and no longer than the scenario; None if there is none."""
    if not problem.objective.trace:
        return None
    found = read(problem.file.parent / problem.objective.trace)
    origin, file = f"`{paths.shown(problem.file)}`", f"`{paths.shown(found.file)}`"
    for name in problem.objective.columns:
        if name not in found.columns:
            text = f"{origin}: `objective.columns` holds `{name}`, which {file} lacks"
            raise ScenarioError(text, closest(name, found.columns))
    if not found.columns:
        raise CosimError(f"{file} has no columns beside `time`")
    for name in problem.objective.columns or found.columns:
        known = found.data[name][np.isfinite(found.data[name])]
        if not known.size:
            raise CosimError(f"`{name}` in {file} holds no finite number")
        with np.errstate(over="ignore"):
            spread = np.std(known)
        if not np.isfinite(spread):
            ends = f"from {np.min(known):g} to {np.max(known):g}"
            raise CosimError(f"`{name}` in {file} ranges {ends}, whose spread is too large")
    end = scenario.loop.duration + scenario.loop.step
    if found.times[-1] > end:
        text = f"{file} ends at {found.times[-1]:g} s, the scenario at {end:g} s"
        raise CosimError(text, "Set `loop.duration` in `[set]`, or shorten the trace.")
    return found


def misfit(result: Result, target: StoredTrace, columns: Sequence[str]) -> float:
    """Mean square of the deviations from a measured trace, each in standard deviations of its column.

    The simulated trace is interpolated at the times of the measured one; NaN there is ignored.
    The distance is infinite if the run ended before the last of these times. The columns must have the units
    of the run.
    """
    simulation = result.columns
    times = simulation["time"]
    # a row represents the time up to the next
    end = result.simulated_s + (times[1] if len(times) > 1 else 0.0)
    squares = []
    file = f"`{paths.shown(target.file)}`"
    for name in columns or target.columns:
        if name not in simulation:
            text = f"{file} has the column `{name}`, which is not in the trace of a run"
            raise CosimError(text, closest(name, simulation))
        units = target.units.get(name, ""), result.units.get(name, "")
        if all(units) and units[0] != units[1]:
            raise CosimError(f"`{name}` in {file} is in `{units[0]}`, that of a run in `{units[1]}`")
        values = target.data[name]
        known = np.isfinite(values)
        if np.any(target.times[known] > end):
            return math.inf
        simulated = interpolated(times, simulation[name], target.times[known])
        scale = float(np.std(values[known])) or 1.0
        squares.append(np.square((simulated - values[known]) / scale))
    return float(np.mean(np.concatenate(squares)))


def score(problem: Problem, criteria: Sequence[Criterion], rows: Sequence[Row]) -> Score:
    """Score of a trial from the rows of its runs."""
    lost = next((row for row in rows if row["status"] not in DONE), None)
    if lost is not None:
        return Score(None, reason=str(lost["reason"]))
    name = problem.objective.metric or MISFIT
    value = float(np.mean([float(row["metrics"][name]) for row in rows]))
    if not math.isfinite(value):
        early = ": the run ended before the measured trace" if (name, value) == (MISFIT, math.inf) else ""
        return Score(None, reason=f"`{name}` is {value}{early}")
    runs = zip(*(verdicts(row, criteria) for row in rows), strict=True)
    return Score(value, tuple(max(map(violation, found)) for found in runs))


def violation(verdict: Verdict) -> float:
    """Violation of a criterion relative to its limit; 0 if it passed.

    The verdict decides; the distance only guides the search.
    """
    if verdict.passed:
        return 0.0
    if not math.isfinite(verdict.value):
        return 1.0 / VIOLATED
    value = verdict.value
    failed = [limit for relation, limit in verdict.limits if not RELATIONS[relation](value, limit)]
    return min(max(VIOLATED, *(abs(value - limit) / (abs(limit) or 1.0) for limit in failed)), 1.0 / VIOLATED)
