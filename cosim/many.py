"""Many runs on several processes: one scenario with many seeds, or many scenarios."""

from __future__ import annotations

import contextlib
import dataclasses
import multiprocessing
from collections.abc import Generator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass

from cosim.errors import CosimError
from cosim.result import Result
from cosim.scenario import Scenario
from cosim.session import Session

Outcome = Result | CosimError
"""What became of a run: its result, or why it could not be done."""


@dataclass(frozen=True)
class Job:
    """One run; runs with the same `session` share an open FMU and plant."""

    session: int
    scenario: Scenario
    seed: int
    keep_trace: bool


def run_many(
    scenario: Scenario, seeds: Sequence[int], workers: int | None = None, keep_trace: bool = False
) -> list[Result]:
    """Run a scenario with many seeds; results in the order of the seeds, each the same as `run` gives.

    Parameters
    ----------
    scenario
        The scenario.
    seeds
        One run each.
    workers
        Processes; None is one per core, 1 runs in this process. Scripts need the usual
        `if __name__ == "__main__":` around their calls.
    keep_trace
        Whether the results hold their traces.

    Raises
    ------
    CosimError
        A run could not be done, or a worker process died.
    """
    results = []
    with contextlib.closing(
        outcomes([Job(0, scenario, seed, keep_trace) for seed in seeds], workers)
    ) as done:
        for outcome in done:
            if isinstance(outcome, CosimError):
                raise outcome
            results.append(outcome)
    return results


def run_each(
    scenarios: Sequence[Scenario], workers: int | None = None, keep_trace: bool = False
) -> list[Outcome]:
    """Run many scenarios, each with its own seed; outcomes in the order of the scenarios.

    Parameters
    ----------
    scenarios
        One run each.
    workers, keep_trace
        As for `run_many`.

    Returns
    -------
    list of Result or CosimError
        A run that could not be done gives its error and stops no other.

    Raises
    ------
    CosimError
        A worker process died.
    """
    jobs = [Job(i, scenario, scenario.loop.seed, keep_trace) for i, scenario in enumerate(scenarios)]
    return list(outcomes(jobs, workers))


def outcomes(jobs: Sequence[Job], workers: int | None) -> Generator[Outcome]:
    """Run the jobs and yield their outcomes in order; closing it drops what was not begun."""
    count = min(workers or multiprocessing.cpu_count(), len(jobs))
    if count <= 1:
        with contextlib.closing(Desk()) as desk:
            yield from map(desk.run, jobs)
        return
    pool = ProcessPoolExecutor(count, multiprocessing.get_context("spawn"))
    try:
        yield from pool.map(run_in_worker, jobs)
    except BrokenProcessPool:
        hint = '`workers=1` shows the run; a script needs `if __name__ == "__main__":` around its calls'
        names = ", ".join(f"`{name}`" for name in dict.fromkeys(job.scenario.name for job in jobs))
        raise CosimError(f"a worker process died while it ran {names}", hint) from None
    finally:
        pool.shutdown(cancel_futures=True)


class Desk:
    """Runs jobs one after the other; a session stays open for the jobs that share it."""

    def __init__(self) -> None:
        self.number = -1
        self.session: Session | None = None

    def run(self, job: Job) -> Outcome:
        """Run one job."""
        try:
            if self.session is None or job.session != self.number:
                self.close()
                self.session, self.number = Session(job.scenario), job.session
            result = self.session.run(job.seed)
        except CosimError as error:
            return error
        return result if job.keep_trace else dataclasses.replace(result, trace=None)

    def close(self) -> None:
        """Free the FMU."""
        if self.session is not None:
            self.session.close()
        self.session = None


_desk = Desk()


def run_in_worker(job: Job) -> Outcome:
    """Run one job in a worker process."""
    return _desk.run(job)
