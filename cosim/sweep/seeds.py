"""One scenario with many seeds: selection, runs and summary."""

from __future__ import annotations

import contextlib
import re
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.console import RenderableType

from cosim.errors import CosimError
from cosim.formatting.verdicts import STATUSES
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.result import Result
from cosim.pool.job import Job, Outcome
from cosim.pool.limits import Limits
from cosim.pool.runs import ordered
from cosim.scenario.model import Scenario
from cosim.sweep import summary_tables
from cosim.sweep.summary import Summary

MAX_SEEDS = 100_000
"""Maximum number of seeds; use a study for more."""
PART = re.compile(r"(\d{1,18})(?:\.\.(\d{1,18}))?")


def parse(text: str) -> list[int]:
    """Seeds of a text such as `1..20`, `3,5,8` or `1..10,100`; ranges include both ends."""
    seeds: list[int] = []
    for part in map(str.strip, text.split(",")):
        found = PART.fullmatch(part)
        if found is None:
            problem = f"`--seeds {text}`: `{part}` is not a seed or range"
            raise CosimError(problem, "Give seeds as `1..20`, `3,5,8` or `1..10,100`.")
        first, last = int(found[1]), int(found[2] or found[1])
        if last < first:
            raise CosimError(f"`--seeds {text}`: `{part}` ends before it starts", f"Use `{last}..{first}`.")
        if len(seeds) + last - first >= MAX_SEEDS:
            problem = f"`--seeds {text}` names more than {MAX_SEEDS} seeds"
            raise CosimError(problem, "Use a study of `cosim sweep`, which stores completed runs.")
        seeds += range(first, last + 1)
    again, times = Counter(seeds).most_common(1)[0]
    if times > 1:
        raise CosimError(f"`--seeds {text}` names the seed {again} twice")
    return seeds


def run(
    scenario: Scenario,
    seeds: Sequence[int],
    engine: Engine = "native",
    limits: Limits | None = None,
    progress: Progress | None = None,
    workers: int | None = None,
) -> list[Outcome]:
    """Run a scenario with many seeds; without limits in this process, one after the other.

    An error in one does not stop the others. `progress` is called with the completed and the total number.
    """
    found: list[Outcome] = []
    jobs = [Job(scenario, seed, engine) for seed in seeds]
    with contextlib.closing(ordered(jobs, 1 if limits is None else workers, limits)) as done:
        for outcome in done:
            found.append(outcome)
            if progress is not None:
                progress(len(found), len(seeds))
    return found


def summarize(seeds: Sequence[int], outcomes: Sequence[Outcome]) -> Summary:
    """Compute counts and distributions; runs without result are listed with their first seed."""
    found = Summary(len(seeds))
    values: dict[str, list[float]] = {}
    for seed, outcome in zip(seeds, outcomes, strict=True):
        if not isinstance(outcome, Result):
            found.count(outcome.status, outcome.message, seed)
            continue
        found.count(STATUSES[outcome.passed], "", seed)
        for metric in outcome.metrics.values():
            values.setdefault(metric.name, []).append(metric.value)
            found.units[metric.name] = metric.unit
        for verdict in outcome.criteria:
            found.held[verdict.criterion.id] += verdict.passed
    found.samples = found.rows
    found.values = {name: np.array(column) for name, column in values.items()}
    return found


def tables(scenario: Scenario, found: Summary) -> RenderableType:
    """Tables of criteria, metrics and runs without result, and the verdict."""
    return summary_tables.tables(f"{scenario.name}: {scenario.title}", scenario, found, (), "first seed")


def plain(seed: int, outcome: Outcome) -> dict[str, Any]:
    """One run as plain data for JSON: its result or its error."""
    if isinstance(outcome, Result):
        return outcome.to_dict()
    return {"seed": seed, "passed": False, **outcome.to_dict()}
