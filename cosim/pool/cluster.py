"""Runs on a Dask cluster, with the same supervision as on this machine.

A Dask worker keeps one supervised worker process for each of its threads, so that an FMU that crashes or
hangs never ends the Dask worker. If a Dask worker itself is lost, its runs are repeated once. If
the scheduler is lost, the runs continue when it or another one at its address is available again.
"""

from __future__ import annotations

import contextlib
import logging
import queue
import threading
import time
import uuid
from collections.abc import Generator, Iterable
from typing import Any

from cosim.errors import CosimError
from cosim.pool.batches import BATCH_TIME, Batch, Batches
from cosim.pool.connection import GOES_ON, RETURN_TIMEOUT, connect, dask, is_connected, returned
from cosim.pool.job import Finished, Job, Numbered, Outcome, name
from cosim.pool.limits import Limits
from cosim.pool.lines import Line, Lines
from cosim.pool.supervisor import Worker

WORKERS_TIMEOUT = 60.0
"""Time without any Dask worker after which a sweep stops, s."""
FETCH_TIMEOUT = 60.0
"""Timeout for fetching outcomes of a Dask worker, s."""
POLL_INTERVAL = 1.0
"""Time between two counts of the Dask workers, s."""
MAX_LOSSES = 5
"""Maximum consecutive losses of the scheduler without a completed run."""
Ended = tuple[str, str]
"""Key of a batch that ended, and the Dask worker if it was lost."""
Reported = tuple[Outcome, list[Line]]
"""Outcome of a run and what it logged."""

log = logging.getLogger("cosim")


class SchedulerLostError(Exception):
    """The scheduler and its state are lost."""


class WorkerLostError(Exception):
    """The outcomes of a Dask worker are lost."""


def outcomes(jobs: Iterable[Numbered], address: str, limits: Limits) -> Generator[Finished]:
    """Run jobs on a Dask cluster; yield outcomes in order of completion, as `local.outcomes`.

    Parameters
    ----------
    jobs
        Jobs with their numbers; taken as threads of Dask workers become free.
    address
        Address of the scheduler, its scheduler file or a security file, see `addresses.scheduler`.
    limits
        Limits of each run.

    Raises
    ------
    CosimError
        Dask is not installed, the address is invalid, no scheduler or worker answers, the scheduler was
        lost, or the workers lack the package `cosim`.
    """
    distributed, batches, lines = dask(), Batches(iter(jobs)), Lines()
    client, patience = connect(distributed, address), WORKERS_TIMEOUT
    losses = 0
    while True:
        done = batches.finished
        with client:
            try:
                yield from dispatched(client, batches, lines, limits, patience)
                return
            except SchedulerLostError:
                # otherwise it would retry for the whole connection timeout
                client.close(timeout=POLL_INTERVAL)
        losses = 1 if batches.finished > done else losses + 1
        if losses > MAX_LOSSES:
            raise CosimError(
                f"the Dask scheduler was lost {losses} times before a run was completed", GOES_ON
            )
        client, patience = returned(distributed, address), RETURN_TIMEOUT


def dispatched(
    client: Any, batches: Batches, lines: Lines, limits: Limits, patience: float
) -> Generator[Finished]:
    """Keep every thread of the cluster busy with one batch.

    Raises
    ------
    SchedulerLostError
        The scheduler is lost; unfinished batches are back in `batches`.
    """
    ended: queue.SimpleQueue[Ended] = queue.SimpleQueue()
    report_lost_runs(client, ended)
    running: dict[str, tuple[Batch, Any]] = {}
    size, token, level = ClusterSize(client, patience), uuid.uuid4().hex[:8], log.getEffectiveLevel()
    try:
        while True:
            free = size.threads() - len(running)
            for _ in range(free):
                if not (batch := batches.take()):
                    break
                key, work = f"cosim-{token}-{uuid.uuid4().hex}", [job for _, job in batch]
                future = client.submit(
                    run_supervised, token, work, limits, level, key=key, pure=False, retries=0
                )
                running[key] = batch, future
                future.add_done_callback(lambda done: ended.put((done.key, "")))
            if free > 0 and not running:
                break
            with contextlib.suppress(queue.Empty):
                key, lost = ended.get(timeout=POLL_INTERVAL)
                if key in running:
                    batch, future = running[key]
                    found = finished(client, batches, lines, batch, future, lost)
                    del running[key]
                    yield from found
    finally:
        for batch, _ in running.values():
            batches.put_back(batch)
        if is_connected(client):
            with contextlib.suppress(Exception):
                client.run(close_workers, token, on_error="ignore")


def finished(
    client: Any, batches: Batches, lines: Lines, batch: Batch, future: Any, lost: str
) -> list[Finished]:
    """Outcomes of a batch that ended, or whose Dask worker was lost; logs the messages of the runs."""
    try:
        if lost:
            raise WorkerLostError(lost)
        reported = reported_by(client, future)
        for (number, job), (_, logged) in zip(batch, reported, strict=False):
            for line in logged:
                lines.report(name(number, job), line)
        return batches.finish(batch, [outcome for outcome, _ in reported])
    except WorkerLostError as error:
        future.cancel()
        given_up = batches.lose(batch, str(error))
        if again := len(batch) - len(given_up):
            log.warning("the Dask worker `%s` was lost: %d runs are repeated", error, again)
        return given_up


class ClusterSize:
    """Threads of the Dask workers, which can join and leave; `patience` (s) is the maximum gap."""

    def __init__(self, client: Any, patience: float) -> None:
        self.client = client
        self.patience = patience
        self.count = 0
        self.counted = -POLL_INTERVAL
        self.last_worker = time.monotonic()

    def threads(self) -> int:
        """Return the number of threads, updated periodically.

        Raises
        ------
        CosimError
            There was no worker for too long.
        SchedulerLostError
            The scheduler does not answer.
        """
        if not is_connected(self.client):
            raise SchedulerLostError
        now = time.monotonic()
        if now - self.counted >= POLL_INTERVAL or not self.count:
            self.counted = now
            try:
                self.count = sum(self.client.nthreads().values())
            except Exception:
                raise SchedulerLostError from None
        if self.count:
            self.last_worker = now
        elif now - self.last_worker > self.patience:
            problem = f"the Dask scheduler has had no worker for {self.patience:g} s"
            raise CosimError(problem, "Start one with `dask worker ADDRESS`.")
        else:
            time.sleep(POLL_INTERVAL)
        return self.count


def reported_by(client: Any, future: Any) -> list[Reported]:
    """Outcomes and log lines of a batch that ended.

    Raises
    ------
    SchedulerLostError, WorkerLostError
        They are gone.
    CosimError
        The workers cannot do any run.
    """
    try:
        reported: list[Reported] = future.result(timeout=FETCH_TIMEOUT)
    except CosimError:
        raise
    except Exception as error:
        kind = type(error).__name__
        # it takes back all futures when its connection ends, and may not have seen that end
        if future.cancelled() or kind == "CommClosedError" or not is_connected(client):
            raise SchedulerLostError from None
        if kind == "KilledWorker" or isinstance(error, TimeoutError):
            raise WorkerLostError(error) from None
        hint = "Install the same packages on scheduler, workers and this machine."
        raise CosimError(f"the cluster failed: {kind}: {error}", hint) from None
    return reported


def report_lost_runs(client: Any, ended: queue.SimpleQueue[Ended]) -> None:
    """Report the runs of lost Dask workers."""

    def see(event: tuple[float, Any]) -> None:
        _, message = event
        if isinstance(message, dict) and message.get("action") == "remove-worker" and not message["expected"]:
            for key in message["processing-tasks"]:
                ended.put((key, str(message["worker"])))

    # topic of all worker events
    client.subscribe_topic("all", see)


_workers: dict[tuple[str, int], Worker] = {}
"""Supervised worker processes of a Dask worker, by sweep and thread."""


def run_supervised(token: str, jobs: list[Job], limits: Limits, level: int) -> list[Reported]:
    """Run the first jobs of a batch within the batch time, on a Dask worker that logs at `level`."""
    key = (token, threading.get_ident())
    if key not in _workers:
        _workers[key] = Worker(limits)
    log.setLevel(level)
    worker: Worker = _workers[key]
    reported: list[Reported] = []
    end = time.monotonic() + BATCH_TIME
    for job in jobs:
        logged: list[Line] = []
        reported.append((worker.call(job, on_line=logged.append), logged))
        if time.monotonic() > end:
            break
    return reported


def close_workers(token: str) -> None:
    """End the worker processes of a sweep; runs on a Dask worker."""
    for key in [key for key in _workers if key[0] == token]:
        _workers.pop(key).close()
