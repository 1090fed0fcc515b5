"""An optimization as data: one scenario, what may vary, and what is wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, NoReturn

from cosim import paths
from cosim.errors import ScenarioError
from cosim.scenario.tables import parse
from cosim.scenario.toml import flatten, parse_file
from cosim.sweep.study import Vary, check_values

MOST_TRIALS = 100_000
"""More than a search that learns from all its trials has time for."""


@dataclass(frozen=True)
class Objective:
    """What is wanted: an extreme of a metric with all criteria holding, or a course like a measured one.

    Parameters
    ----------
    metric
        Name of a metric of the scenario.
    direction
        Which of its values are wanted.
    trace
        File of a measured trace, beside the study; the scenario's own criteria do not count then.
    columns
        Columns of the trace that count; none is all that the file has.
    """

    metric: str = ""
    direction: Literal["minimize", "maximize"] = "minimize"
    trace: str = ""
    columns: tuple[str, ...] = ()


@dataclass(frozen=True)
class Search:
    """How long, and how.

    Parameters
    ----------
    trials
        Points that are tried.
    batch
        Points that are chosen at a time, and can run side by side; what is found depends on it, but not on
        the number of workers.
    seeds
        Seeds of the runs of each trial, of which the mean counts; none is the scenario's.
    """

    trials: int = 100
    batch: int = 8
    seeds: tuple[int, ...] = ()


@dataclass(frozen=True)
class Problem:
    """An optimization; load it with `load`. `seed` is that of the search."""

    scenario: str
    objective: Objective
    vary: tuple[Vary, ...]
    search: Search = Search()
    title: str = ""
    description: str = ""
    seed: int = 1
    set: dict[str, Any] = field(default_factory=dict)
    file: Path = field(default=Path(), metadata={"key": ""})

    @property
    def name(self) -> str:
        """Stem of the file."""
        return self.file.stem


def load(file: Path) -> Problem:
    """Load and check an optimization.

    Raises
    ------
    ScenarioError
        Missing or broken file, unknown key, wrong type, contradictory values; names file and key.
    """
    origin = f"`{paths.shown(file)}`"
    table = parse_file(file)

    def fail(key: str, problem: str, hint: str = "") -> NoReturn:
        raise ScenarioError(f"{origin}: `{key}` {problem}", hint)

    if "design" in table:
        fail(
            "design", "is of a study for `cosim sweep`", "an optimization has tables `objective` and `search`"
        )
    problem = parse(Problem, table, "", fail)
    problem = replace(problem, set=flatten(problem.set), file=file)
    check(problem, fail)
    return problem


def check(problem: Problem, fail: Any) -> None:
    """Check what types cannot say."""
    objective, search = problem.objective, problem.search
    if bool(objective.metric) == bool(objective.trace):
        hint = "a metric that is to be small or large, or a measured trace to come close to"
        fail("objective", "needs one of `metric` and `trace`", hint)
    if objective.columns and not objective.trace:
        fail("objective.columns", "belongs to `objective.trace`")
    if objective.trace and objective.direction != "minimize":
        fail("objective.direction", "is `maximize`, what is measured can only be come close to")
    if not 1 <= search.trials <= MOST_TRIALS:
        fail("search.trials", f"is `{search.trials}`, it must lie in 1 .. {MOST_TRIALS}")
    if search.batch < 1:
        fail("search.batch", f"is `{search.batch}`, it must be at least 1")
    if problem.seed < 0 or any(seed < 0 for seed in search.seeds):
        fail("seed" if problem.seed < 0 else "search.seeds", "must not be negative")
    if len(set(search.seeds)) != len(search.seeds):
        fail("search.seeds", "holds a seed twice", "it would count twice")
    check_varied(problem, fail)


def check_varied(problem: Problem, fail: Any) -> None:
    """Check the ranges."""
    if not problem.vary:
        fail("vary", "is empty: there is nothing to choose", "give it tables `[[vary]]`")
    seen = set(problem.set)
    for index, vary in enumerate(problem.vary):
        key = f"vary[{index}]"
        if vary.key in seen:
            fail(f"{key}.key", f"= `{vary.key}` is there twice", "a key has one place")
        seen.add(vary.key)
        if vary.distribution == "normal" or vary.mean is not None or vary.deviation is not None:
            fail(f"{key}.distribution", "cannot be `normal` here", "a search needs `minimum` and `maximum`")
        check_values(vary, key, "search", fail)
        for value in vary.values:
            if not isinstance(value, bool | int | float | str):
                fail(f"{key}.values", f"holds `{value}`, which is no number, text or truth value")
            if isinstance(value, float) and not math.isfinite(value):
                fail(f"{key}.values", f"holds `{value}`, which is not finite")
