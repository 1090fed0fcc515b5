"""Runs of jobs: on several worker processes of this machine, or in this process."""

from __future__ import annotations

import contextlib
import functools
import itertools
import logging
import queue
import threading
from collections.abc import Generator, Iterable, Iterator

from cosim.loop.repeats import NewProcessError
from cosim.pool.job import EVENTS, Finished, Numbered, name
from cosim.pool.limits import Limits
from cosim.pool.supervisor import MAX_LINES, ClosedError, Line, Worker, report

log = logging.getLogger("cosim")
HIDDEN = "further log lines are hidden; show all with `-v`"


class LogRelay:
    """Log of parallel runs: each text once, up to a limit; with `-v` all lines are logged."""

    def __init__(self) -> None:
        self.seen: set[str] = set()
        self.lock = threading.Lock()

    def report(self, run: str, line: Line) -> None:
        """Log a line if the limit permits it."""
        if not log.isEnabledFor(EVENTS):
            with self.lock:
                if line[2] in self.seen or len(self.seen) > MAX_LINES:
                    return
                self.seen.add(line[2])
                if len(self.seen) > MAX_LINES:
                    line, run = (log.name, logging.WARNING, HIDDEN), ""
        report(line, run)


class JobQueue(queue.SimpleQueue["Numbered | None"]):
    """Jobs for running workers, which wait for more of them until it is closed."""

    def __iter__(self) -> Iterator[Numbered]:
        return iter(self.get, None)

    def close(self) -> None:
        """End the iteration and wake the waiting thread."""
        self.put(None)


def outcomes(jobs: Iterable[Numbered], workers: int, limits: Limits) -> Generator[Finished]:
    """Run numbered jobs on worker processes; yield outcomes in order of completion.

    Jobs are consumed when workers become free. Closing the generator ends the worker processes and closes a
    `JobQueue`. Raises CosimError if no worker process can be started.
    """
    done: queue.SimpleQueue[Finished | None] = queue.SimpleQueue()
    failures: list[BaseException] = []
    remaining, lock, relay = iter(jobs), threading.Lock(), LogRelay()

    def following() -> Numbered | None:
        """Task that follows; None after the last."""
        with lock:
            return next(remaining, None)

    def serve(worker: Worker) -> None:
        """Send jobs to one worker until the end, which None marks."""
        try:
            with contextlib.suppress(ClosedError):
                for number, job in iter(following, None):
                    on_line = functools.partial(relay.report, name(number, job))
                    done.put((number, worker.call(job, on_line=on_line)))
                worker.finish()
        except BaseException as error:
            failures.append(error)
        done.put(None)

    pool = [Worker(limits) for _ in range(workers)]
    threads = [threading.Thread(target=serve, args=(worker,), daemon=True) for worker in pool]
    try:
        for thread in threads:
            thread.start()
        for _ in threads:
            yield from iter(done.get, None)
            if failures:
                raise failures[0]
    finally:
        if isinstance(jobs, JobQueue):
            jobs.close()
        for worker in pool:
            worker.stop()
        for thread in threads:
            thread.join()
        for worker in pool:
            worker.close()


def inside(jobs: Iterable[Numbered]) -> Generator[Finished]:
    """Run jobs in this process, one after the other, without protection against crashes.

    When earlier runs in this process would change a result, that run and the others have their own processes.
    """
    from cosim.pool.worker import JobRunner

    rest = iter(jobs)
    with contextlib.closing(JobRunner()) as runner:
        for number, job in rest:
            log.info("%s:", name(number, job))
            outcome = runner.run(job)
            if isinstance(outcome, NewProcessError):
                if outcome.warning:
                    log.warning("%s", outcome.warning)
                yield from outcomes(itertools.chain([(number, job)], rest), 1, Limits())
                return
            yield number, outcome
