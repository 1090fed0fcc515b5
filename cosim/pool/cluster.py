"""Runs on a Dask cluster, each under the same supervision as on this machine.

A Dask worker keeps one supervised worker process for each of its threads, so that an FMU that crashes or
hangs never takes the Dask worker with it. If a Dask worker itself is lost, that costs the runs it was doing.
"""

from __future__ import annotations

import contextlib
import importlib
import logging
import queue
import threading
import time
import uuid
from collections.abc import Generator, Iterable, Iterator
from typing import Any

from cosim.errors import CosimError
from cosim.pool import address as addresses
from cosim.pool.job import Finished, Job, Numbered, Outcome, WorkerError
from cosim.pool.limits import Limits
from cosim.pool.supervisor import Worker

CONNECT_TIMEOUT = 20.0
"""Time to reach the scheduler, s."""
WORKERS_TIMEOUT = 60.0
"""Time without any Dask worker after which a sweep gives up, s."""
POLL_INTERVAL = 1.0
"""Time between two counts of the Dask workers, s."""
Ended = tuple[str, str]
"""Key of a run that ended, and the Dask worker if it was lost."""


def outcomes(jobs: Iterable[Numbered], address: str, limits: Limits) -> Generator[Finished]:
    """Run jobs on a Dask cluster; outcomes come as they are done, as from `local.outcomes`.

    Parameters
    ----------
    jobs
        Jobs with their numbers; taken as threads of Dask workers become free.
    address
        Address of the scheduler, its scheduler file or a security file, see `addresses.scheduler`.
    limits
        What each run may take.

    Raises
    ------
    CosimError
        Dask is not installed, the address is none, no scheduler or worker answers, or the workers lack the
        package `cosim`.
    """
    with connected(dask(), address) as client:
        token = uuid.uuid4().hex[:8]
        try:
            yield from dispatched(client, iter(jobs), limits, token)
        finally:
            with contextlib.suppress(Exception):
                client.run(close_workers, token, on_error="ignore")


def dispatched(client: Any, jobs: Iterator[Numbered], limits: Limits, token: str) -> Generator[Finished]:
    """Keep every thread of the cluster busy with one run; none waits on a worker that may be lost."""
    ended: queue.SimpleQueue[Ended] = queue.SimpleQueue()
    report_lost_runs(client, ended)
    running: dict[str, tuple[int, Any]] = {}
    size = ClusterSize(client)
    more = True
    while more or running:
        free = size.threads() - len(running)
        while more and free > 0:
            if (job := next(jobs, None)) is None:
                more = False
                break
            key = f"cosim-{token}-{job[0]}"
            future = client.submit(run_supervised, token, job[1], limits, key=key, pure=False, retries=0)
            running[key] = job[0], future
            future.add_done_callback(lambda done: ended.put((done.key, "")))
            free -= 1
        with contextlib.suppress(queue.Empty):
            key, lost = ended.get(timeout=POLL_INTERVAL)
            if key in running:
                number, future = running.pop(key)
                yield number, outcome_of(future, lost)


class ClusterSize:
    """Threads of all Dask workers; workers may come and go."""

    def __init__(self, client: Any) -> None:
        self.client = client
        self.count = 0
        self.counted = -POLL_INTERVAL
        self.last_worker = time.monotonic()

    def threads(self) -> int:
        """Return the number of threads, looked up now and then.

        Raises
        ------
        CosimError
            There has been no worker for too long.
        """
        now = time.monotonic()
        if now - self.counted >= POLL_INTERVAL or not self.count:
            self.counted = now
            try:
                self.count = sum(self.client.nthreads().values())
            except Exception as error:
                raise CosimError(
                    f"lost the Dask scheduler: {error}", "the next call goes on from here"
                ) from None
        if self.count:
            self.last_worker = now
        elif now - self.last_worker > WORKERS_TIMEOUT:
            problem = f"the Dask scheduler has had no worker for {WORKERS_TIMEOUT:g} s"
            raise CosimError(problem, "start one with `dask worker ADDRESS`")
        else:
            time.sleep(POLL_INTERVAL)
        return self.count


def outcome_of(future: Any, lost: str) -> Outcome:
    """Outcome of a future that is done, or whose Dask worker was lost."""
    if lost:
        future.cancel()
        return WorkerError(
            "lost", f"the Dask worker `{lost}` was lost during the run", "`--again` does it again"
        )
    try:
        outcome: Outcome = future.result()
    except CosimError:
        raise
    except Exception as error:
        name = type(error).__name__
        if name == "KilledWorker":
            return WorkerError(
                "lost", f"a Dask worker was lost during the run: {error}", "`--again` does it again"
            )
        hint = "scheduler and workers need the same packages as this machine"
        raise CosimError(f"the cluster failed: {name}: {error}", hint) from None
    return outcome


def dask() -> Any:
    """Return Dask's package `distributed`."""
    try:
        distributed = importlib.import_module("distributed")
    except ImportError:
        hint = "install the extra: `pip install machining-fmus[cluster]`"
        raise CosimError("Dask is not installed, it runs sweeps on a cluster", hint) from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    return distributed


@contextlib.contextmanager
def connected(distributed: Any, address: str) -> Iterator[Any]:
    """Client of a scheduler."""
    scheduler = addresses.scheduler(address)
    client = distributed.Client.__new__(distributed.Client)
    try:
        client.__init__(
            scheduler.address,
            security=security(distributed, scheduler),
            timeout=CONNECT_TIMEOUT,
            set_as_default=False,
        )
    except Exception as error:  # whatever listens there says whatever it says
        with contextlib.suppress(Exception):
            client.close(timeout=POLL_INTERVAL)
        # else it would try again when it is collected
        client.status = "closed"
        text = f"no Dask scheduler answers at `{scheduler.address}`: {error}"
        raise CosimError(text, "`dask scheduler` starts one") from None
    with client:
        yield client


def security(distributed: Any, scheduler: addresses.Scheduler) -> Any:
    """Return what Dask needs for TLS, None without."""
    if not scheduler.tls:
        return None
    tls = scheduler.tls
    return distributed.Security(
        tls_ca_file=tls["ca"],
        tls_client_cert=tls["certificate"],
        tls_client_key=tls["key"],
        require_encryption=True,
    )


def report_lost_runs(client: Any, ended: queue.SimpleQueue[Ended]) -> None:
    """Report the runs that lost Dask workers were doing."""

    def see(event: tuple[float, Any]) -> None:
        _, message = event
        if isinstance(message, dict) and message.get("action") == "remove-worker" and not message["expected"]:
            for key in message["processing-tasks"]:
                ended.put((key, str(message["worker"])))

    # all that happens to workers is told under this topic
    client.subscribe_topic("all", see)


_workers: dict[tuple[str, int], Worker] = {}
"""Supervised worker processes of a Dask worker, by sweep and thread."""


def run_supervised(token: str, job: Job, limits: Limits) -> Outcome:
    """Run one job; runs on a Dask worker."""
    key = (token, threading.get_ident())
    if key not in _workers:
        _workers[key] = Worker(limits)
    outcome: Outcome = _workers[key].call(job)
    return outcome


def close_workers(token: str) -> None:
    """End the worker processes of a sweep; runs on a Dask worker."""
    for key in [key for key in _workers if key[0] == token]:
        _workers.pop(key).close()
