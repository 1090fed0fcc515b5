"""Many runs on several processes: one scenario with many seeds, or many scenarios."""

from __future__ import annotations

import contextlib
from collections.abc import Generator, Sequence

from cosim.errors import CosimError
from cosim.loop.engines import Engine
from cosim.loop.result import Result
from cosim.scenario.model import Scenario
from cosim.sweep import cores
from cosim.sweep.supervisor import Limits, outcomes
from cosim.sweep.worker import Job, JobRunner, Outcome


def run_many(
    scenario: Scenario,
    seeds: Sequence[int],
    workers: int | None = None,
    keep_trace: bool = False,
    engine: Engine = "native",
) -> list[Result]:
    """Run a scenario with many seeds; results in the order of the seeds, each the same as `run` gives.

    Parameters
    ----------
    scenario
        The scenario.
    seeds
        One run each.
    workers
        Processes; None is one per core, 1 runs in this process.
    keep_trace
        Whether the results hold their traces.
    engine
        `native` or `reference`, see `Session`; both give the same numbers.

    Raises
    ------
    CosimError
        A run could not be done, or its worker process died.
    """
    results = []
    jobs = [Job(scenario, seed, engine, keep_trace) for seed in seeds]
    with contextlib.closing(ordered(jobs, workers)) as done:
        for outcome in done:
            if isinstance(outcome, CosimError):
                raise outcome
            results.append(outcome)
    return results


def run_each(
    scenarios: Sequence[Scenario],
    workers: int | None = None,
    keep_trace: bool = False,
    engine: Engine = "native",
) -> list[Outcome]:
    """Run many scenarios, each with its own seed; outcomes in the order of the scenarios.

    Parameters
    ----------
    scenarios
        One run each.
    workers, keep_trace, engine
        As for `run_many`.

    Returns
    -------
    list of Result or CosimError
        A run that could not be done, or whose worker process died, gives its error and stops no other.
    """
    jobs = [Job(scenario, scenario.loop.seed, engine, keep_trace) for scenario in scenarios]
    return list(ordered(jobs, workers))


def ordered(jobs: Sequence[Job], workers: int | None) -> Generator[Outcome]:
    """Run the jobs and yield their outcomes in order; closing it drops what was not begun."""
    count = min(workers or cores.available(), len(jobs))
    if count <= 1:
        with contextlib.closing(JobRunner()) as runner:
            yield from map(runner.run, jobs)
        return
    early: dict[int, Outcome] = {}
    wanted = 0
    with contextlib.closing(outcomes(enumerate(jobs), count, Limits())) as done:
        for number, outcome in done:
            early[number] = outcome
            while wanted in early:
                yield early.pop(wanted)
                wanted += 1
