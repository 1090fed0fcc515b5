"""Runs from Python: one run, one scenario with many seeds, or many scenarios."""

from __future__ import annotations

import contextlib
import dataclasses
import logging
from collections.abc import Generator, Sequence
from pathlib import Path

from cosim.errors import CosimError
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.repeats import NewProcessError
from cosim.loop.result import Result
from cosim.loop.session import Session
from cosim.pool import executor
from cosim.pool.job import Job, Outcome
from cosim.pool.limits import Limits, processors
from cosim.pool.supervisor import Worker
from cosim.scenario.load import load
from cosim.scenario.model import Scenario
from cosim.trace import endings
from cosim.warned import once
from cosim.writing import whole_if

log = logging.getLogger("cosim")


@once()
def run(
    scenario: Scenario | str | Path,
    seed: int | None = None,
    progress: Progress | None = None,
    engine: Engine = "native",
    isolated: bool = False,
    limits: Limits | None = None,
    stream: str | Path | None = None,
) -> Result:
    """Run a scenario once with a fresh FMU and plant.

    Parameters
    ----------
    scenario
        The scenario, or its name or file as for `cosim.load`.
    seed
        Seed of all noise; None is the scenario's. Equal seeds give identical bytes.
    progress
        Called with the completed and the total number of steps.
    engine
        `native` or `reference`, see `Session`; the results are bit-identical.
    isolated
        Whether it runs in a separate process, so that a crash or hang of an FMU or plant is an ordinary
        error; the imports of that process take about a second.
    limits
        Limits of an isolated run.
    stream
        Parquet file for the trace, written during the run with little memory; None keeps it in memory.

    Raises
    ------
    CosimError
        The run failed; it leaves no file.
    """
    scenario = loaded(scenario)
    if not isolated:
        if limits is not None:
            raise CosimError("`limits` apply only to isolated runs", "Set `isolated=True`.")
        try:
            with Session(scenario, engine=engine) as session:
                return session.run(seed, progress, stream)
        except NewProcessError as error:
            log.warning("%s", error.warning or f"{error.message}; the run gets a new process")
    file = None if stream is None else endings.streamed(Path(stream))
    seed = scenario.loop.seed if seed is None else seed
    with whole_if(file) as part:
        job = Job(scenario, seed, engine, keep_trace=True, stream=part and part.absolute())
        with Worker(limits or Limits(keys=("timeout", "memory")), relay=True) as worker:
            outcome = worker.call(job, progress)
        if isinstance(outcome, CosimError):
            raise outcome
    done: Result = dataclasses.replace(outcome, file=file)
    return done


@once()
def run_many(
    scenario: Scenario | str | Path,
    seeds: Sequence[int],
    workers: int | None = None,
    keep_trace: bool = False,
    engine: Engine = "native",
) -> list[Result]:
    """Run a scenario with many seeds; results in the order of the seeds, equal to those of `run`.

    Parameters
    ----------
    scenario
        The scenario, or its name or file.
    seeds
        One run each.
    workers
        Number of processes; None is one per available processor, 1 runs in this process.
    keep_trace
        Whether the results hold their traces.
    engine
        `native` or `reference`, see `Session`; the results are bit-identical.

    Raises
    ------
    CosimError
        A run failed, or its worker process died.
    """
    results = []
    scenario = loaded(scenario)
    jobs = [Job(scenario, seed, engine, keep_trace) for seed in seeds]
    with contextlib.closing(ordered(jobs, workers)) as done:
        for outcome in done:
            if isinstance(outcome, CosimError):
                raise outcome
            results.append(outcome)
    return results


def loaded(scenario: Scenario | str | Path) -> Scenario:
    """Load a scenario given by name or file."""
    return scenario if isinstance(scenario, Scenario) else load(scenario)


@once()
def run_each(
    scenarios: Sequence[Scenario | str | Path],
    workers: int | None = None,
    keep_trace: bool = False,
    engine: Engine = "native",
) -> list[Outcome]:
    """Run many scenarios, each with its own seed; outcomes in the order of the scenarios.

    Parameters
    ----------
    scenarios
        One run each; names and files are loaded.
    workers, keep_trace, engine
        As for `run_many`.

    Returns
    -------
    list of Result or CosimError
        A failed run, or one whose worker process died, gives its error; the others continue.
    """
    found = [loaded(scenario) for scenario in scenarios]
    jobs = [Job(scenario, scenario.loop.seed, engine, keep_trace) for scenario in found]
    return list(ordered(jobs, workers))


def ordered(jobs: Sequence[Job], workers: int | None, limits: Limits | None = None) -> Generator[Outcome]:
    """Execute the runs and yield their outcomes in order; closing it drops the runs that were not started.

    One worker without limits is this process.
    """
    count = min(workers or processors(), len(jobs))
    numbered = enumerate(jobs)
    inside = count <= 1 and limits is None
    pool = executor.inside(numbered) if inside else executor.outcomes(numbered, count, limits or Limits())
    early: dict[int, Outcome] = {}
    wanted = 0
    with contextlib.closing(pool) as done:
        for number, outcome in done:
            early[number] = outcome
            while wanted in early:
                yield early.pop(wanted)
                wanted += 1
