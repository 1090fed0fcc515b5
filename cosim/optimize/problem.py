"""An optimization as data: one scenario, what may vary, and what is wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from cosim.scenario.kinds import check_kind
from cosim.scenario.schema import schema_of
from cosim.scenario.tables import Fail, parse
from cosim.scenario.toml import flatten, parse_file
from cosim.sweep.varied import Varied, check_keys, check_values, failing

MAX_TRIALS = 100_000
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
        Seeds of the runs of each trial, of which the mean counts; left out it is the scenario's alone.
    """

    trials: int = 100
    batch: int = 8
    seeds: tuple[int, ...] | None = None


@dataclass(frozen=True, kw_only=True)
class Problem(Varied):
    """An optimization; load it with `load`. `seed` is that of the search."""

    objective: Objective
    search: Search = Search()


def load(file: Path) -> Problem:
    """Load and check an optimization.

    Raises
    ------
    ScenarioError
        Missing or broken file, unknown key, wrong type, contradictory values; names file and key.
    """
    fail, table = failing(file), parse_file(file)
    check_kind(table, file, "optimization")
    if "design" in table:
        fail(
            "design", "is of a study for `cosim sweep`", "an optimization has tables `objective` and `search`"
        )
    problem = parse(Problem, table, "", fail)
    problem = replace(problem, set=flatten(problem.set), file=file)
    check(problem, fail)
    return problem


def problem_schema() -> dict[str, Any]:
    """JSON schema of an optimization file."""
    return schema_of(Problem, "Optimization of cosim")


def check(problem: Problem, fail: Fail) -> None:
    """Check what types cannot say."""
    objective, search = problem.objective, problem.search
    if bool(objective.metric) == bool(objective.trace):
        hint = "a metric that is to be small or large, or a measured trace to come close to"
        fail("objective", "needs one of `metric` and `trace`", hint)
    if objective.columns and not objective.trace:
        fail("objective.columns", "belongs to `objective.trace`")
    if objective.trace and objective.direction != "minimize":
        fail("objective.direction", "is `maximize`, what is measured can only be come close to")
    if not 1 <= search.trials <= MAX_TRIALS:
        fail("search.trials", f"is `{search.trials}`, it must lie in 1 .. {MAX_TRIALS}")
    if search.batch < 1:
        fail("search.batch", f"is `{search.batch}`, it must be at least 1")
    if search.seeds is not None:
        check_seeds(search.seeds, fail)
    check_varied(problem, fail)


def check_seeds(seeds: tuple[int, ...], fail: Fail) -> None:
    """Check that there is a seed, and each once."""
    if not seeds:
        fail("search.seeds", "is empty", "leave it out for the seed of the scenario")
    if any(seed < 0 for seed in seeds):
        fail("search.seeds", "must not be negative")
    if len(set(seeds)) != len(seeds):
        fail("search.seeds", "holds a seed twice", "it would count twice")


def check_varied(problem: Problem, fail: Fail) -> None:
    """Check the ranges."""
    if not problem.vary:
        fail("vary", "is empty: there is nothing to choose", "give it tables `[[vary]]`")
    check_keys(problem, fail)
    for index, vary in enumerate(problem.vary):
        key = f"vary[{index}]"
        if vary.key == "loop.seed":
            fail(
                f"{key}.key", "is `loop.seed`, which is no choice", "runs with several seeds: `search.seeds`"
            )
        if vary.distribution == "normal" or vary.mean is not None or vary.deviation is not None:
            fail(f"{key}.distribution", "cannot be `normal` here", "a search needs `minimum` and `maximum`")
        check_values(vary, key, "search", fail)
        for value in vary.values:
            if not isinstance(value, bool | int | float | str):
                fail(f"{key}.values", f"holds `{value}`, which is no number, text or truth value")
            if isinstance(value, float) and not math.isfinite(value):
                fail(f"{key}.values", f"holds `{value}`, which is not finite")
