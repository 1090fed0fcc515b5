"""The scenario of an optimization with any values of its keys."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from cosim import paths
from cosim.errors import ScenarioError, closest
from cosim.loop.engines import Engine
from cosim.optimize.objective import measured
from cosim.optimize.problem import Problem
from cosim.pool.job import Job
from cosim.scenario import overrides
from cosim.scenario.load import build
from cosim.scenario.model import Scenario
from cosim.study.parameters import value_at
from cosim.study.run import Run, check, things
from cosim.study.run_hash import digest, finished, leaf, plant_of, section, total

Values = dict[str, Any]
"""Keys with their values."""


class Variants:
    """The scenario of a problem with any values of its keys.

    Raises
    ------
    CosimError
        A key or an end of a range is wrong, the scenario has no such metric, or the measured trace is wrong.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.origin = f"`{paths.shown(problem.file)}`"
        near = problem.file.parent if problem.scenario.endswith(".toml") else None
        self.file = paths.find_scenario(problem.scenario, near).resolve()
        self.base = overrides.read(self.file)
        for key, value in problem.set.items():
            overrides.assign(self.base, key, value, f"{self.origin}, `set.{key}`")
        first, last = ({vary.key: value_at(vary, end) for vary in problem.vary} for end in (0.0, 1.0))
        self.scenario = self.at(first)
        plant_of.cache_clear()
        for scenario in (self.scenario, self.at(last)):
            check(scenario)
        metric, names = problem.objective.metric, [entry.name for entry in self.scenario.metric]
        if metric and metric not in names:
            text = f"{self.origin}: `objective.metric` = `{metric}` is not a metric of the scenario"
            raise ScenarioError(text, closest(metric, names))
        self.target = measured(problem, self.scenario)
        self.criteria = self.scenario.criterion if metric else ()
        self.seeds = problem.search.seeds or (self.scenario.loop.seed,)
        wanted = {
            "target": "" if self.target is None else digest(self.target.file),
            "columns": problem.objective.columns,
        }
        parts = (total(section(name, part)) for name, part in self.base.table.items())
        self.identity = sum(parts) + total(wanted)

    def at(self, values: Values) -> Scenario:
        """Scenario with some values."""
        merged = self.base.copy()
        for key, value in values.items():
            overrides.assign(merged, key, value, f"{self.origin}, `{key}` = `{value}`")
        return replace(build(merged), name=paths.scenario_name(self.file), file=self.file)

    def job(self, run: Run, engine: Engine) -> Job:
        """Job of one run, which keeps its trace if it is compared; its row is evaluated later."""
        scenario = replace(self.at(run.changes), criterion=())
        fmus = tuple(digest(paths.find_fmu(choice.fmu, scenario.folder)) for choice in scenario.fmus)
        return Job(scenario, run.seed, engine, self.target is not None, fmus)

    def runs(self, number: int, values: Values) -> list[Run]:
        """Make the runs of a trial, one for each seed."""
        scenario = self.at(values)
        files, _, plant = check(scenario)
        changed = self.identity + total(things(scenario, files, plant))
        changed += sum(leaf(f"set.{key}", value) for key, value in values.items())
        first = number * len(self.seeds)
        return [
            Run(first + index, number, seed, values, finished(changed, seed).hex())
            for index, seed in enumerate(self.seeds)
        ]
