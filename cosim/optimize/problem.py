"""An optimization as data: scenario, varied keys and objective."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from cosim.scenario.kinds import check_kind
from cosim.scenario.ranges import COUNT, NOT_NEGATIVE_COUNT, limited
from cosim.scenario.tables import Fail, parse
from cosim.scenario.toml import flatten, parse_file
from cosim.study.parameters import VariedScenario, check_ranges, failing

MAX_TRIALS = 100_000
"""Maximum number of trials; the search uses all earlier ones for each new trial."""


@dataclass(frozen=True)
class Objective:
    """Objective: an extreme of a metric with all criteria passed, or agreement with a measured trace.

    Parameters
    ----------
    metric
        Name of a metric of the scenario.
    direction
        Direction of the optimization.
    trace
        File of a measured trace, relative to the study; the criteria of the scenario are then ignored.
    columns
        Columns of the trace to compare; default: all columns of the file.
    """

    metric: str = ""
    direction: Literal["minimize", "maximize"] = "minimize"
    trace: str = ""
    columns: tuple[str, ...] = ()


@dataclass(frozen=True)
class Search:
    """Length and method of the search.

    Parameters
    ----------
    trials
        Number of points.
    batch
        Points that are proposed together and can run in parallel. The result depends on it, but not on
        the number of workers.
    seeds
        Seeds of the runs of each trial, which are averaged; default: the seed of the scenario.
    """

    trials: int = limited({"minimum": 1, "maximum": MAX_TRIALS}, 100)
    batch: int = limited(COUNT, 8)
    seeds: tuple[int, ...] | None = limited(NOT_NEGATIVE_COUNT, None)


@dataclass(frozen=True, kw_only=True)
class Problem(VariedScenario):
    """An optimization; load it with `load`. `seed` is that of the search."""

    objective: Objective
    search: Search = Search()


def load(file: Path) -> Problem:
    """Load and check an optimization; errors name file and key."""
    fail, table = failing(file), parse_file(file)
    check_kind(table, file, "optimization")
    if "design" in table:
        fail("design", "belongs to a study for `cosim sweep`", "Use the tables `objective` and `search`.")
    problem = parse(Problem, table, "", fail)
    problem = replace(problem, set=flatten(problem.set), file=file)
    check(problem, fail)
    check_varied(problem, fail)
    return problem


def check(problem: Problem, fail: Fail) -> None:
    """Check rules beyond types of objective and search."""
    objective, search = problem.objective, problem.search
    if bool(objective.metric) == bool(objective.trace):
        hint = "Give a metric to minimize or maximize, or a measured trace."
        fail("objective", "needs one of `metric` and `trace`", hint)
    if objective.columns and not objective.trace:
        fail("objective.columns", "belongs to `objective.trace`")
    if objective.trace and objective.direction != "minimize":
        fail("objective.direction", "is `maximize`, which is not possible for a measured trace")
    if search.seeds == ():
        fail("search.seeds", "is empty", "Omit it to use the seed of the scenario.")
    if search.seeds and len(set(search.seeds)) < len(search.seeds):
        fail("search.seeds", "holds a seed twice", "Give each seed once.")


def check_varied(problem: Problem, fail: Fail) -> None:
    """Check the ranges."""
    if not problem.vary:
        fail("vary", "is empty", "Add tables `[[vary]]`.")
    for index, vary in enumerate(problem.vary):
        key = f"vary[{index}]"
        if vary.key == "loop.seed":
            hint = "Use `search.seeds` for several seeds."
            fail(f"{key}.key", "is `loop.seed`, which cannot be optimized", hint)
        if vary.distribution == "normal" or vary.mean is not None or vary.deviation is not None:
            fail(f"{key}.distribution", "cannot be `normal` here", "Give `minimum` and `maximum`.")
        for value in vary.values:
            if not isinstance(value, bool | int | float | str):
                fail(f"{key}.values", f"holds `{value}`, which is not a number, text or Boolean")
            if isinstance(value, float) and not math.isfinite(value):
                fail(f"{key}.values", f"holds `{value}`, which is not finite")
    check_ranges(problem, "search", fail)
