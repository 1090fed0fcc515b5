"""The scenario of an optimization with any values of its keys."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from cosim import paths
from cosim.errors import CosimError, ScenarioError, closest
from cosim.loop.engines import Engine
from cosim.optimize.problem import Problem
from cosim.pool.job import Job
from cosim.scenario.load import build
from cosim.scenario.model import Scenario
from cosim.study.parameters import value_at
from cosim.study.run import Run, Variation, check, dependencies, job_of
from cosim.study.run_hash import digest, finished, leaf, total
from cosim.trace.files import read
from cosim.trace.stored import StoredTrace


class Variants(Variation):
    """The scenario of a problem with any values of its keys, checked at both ends of its ranges."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        self.problem = problem
        first, last = ({vary.key: value_at(vary, end) for vary in problem.vary} for end in (0.0, 1.0))
        self.scenario = self.at(first)
        for scenario in (self.scenario, self.at(last)):
            check(scenario)
        metric, columns = problem.objective.metric, problem.objective.columns
        self.check_metric("objective.metric", metric, self.scenario)
        self.target = measured(problem, self.scenario)
        self.criteria = self.scenario.criterion if metric else ()
        self.seeds = problem.search.seeds or (self.scenario.loop.seed,)
        target = "" if self.target is None else digest(self.target.file)
        self.total = sum(self.totals.values()) + total({"target": target, "columns": columns})

    def at(self, values: dict[str, Any]) -> Scenario:
        """Scenario with some values."""
        return replace(build(self.merged(values)), name=self.name, file=self.file)

    def job(self, run: Run, engine: Engine) -> Job:
        """Job of one run, which keeps its trace if it is compared; its row is evaluated later."""
        return job_of(replace(self.at(run.changes), criterion=()), run, engine, self.target is not None)

    def runs(self, number: int, values: dict[str, Any]) -> list[Run]:
        """Make the runs of a trial, one for each seed."""
        scenario = self.at(values)
        files, _, plant = check(scenario)
        changed = self.total + total(dependencies(scenario, files, plant))
        changed += sum(leaf(f"set.{key}", value) for key, value in values.items())
        seeds = enumerate(self.seeds, number * len(self.seeds))
        return [Run(index, number, seed, values, finished(changed, seed).hex()) for index, seed in seeds]


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
        raise CosimError(f"{file} has no columns except `time`")
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
