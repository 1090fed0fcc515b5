"""Tasks on the processors of this machine: several worker processes, or this process."""

from __future__ import annotations

import contextlib
import functools
import itertools
import logging
import queue
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from typing import Any

from cosim.loop.repeats import NewProcessError
from cosim.pool.inbox import Inbox
from cosim.pool.job import Finished, Numbered, name
from cosim.pool.limits import Limits
from cosim.pool.lines import Lines
from cosim.pool.supervisor import ClosedError, Worker

log = logging.getLogger("cosim")


def outcomes(jobs: Iterable[Numbered], workers: int, limits: Limits) -> Generator[Finished]:
    """Run jobs on worker processes of this machine; yield outcomes in order of completion.

    Closing the generator ends the worker processes.

    Parameters
    ----------
    jobs
        Jobs with their numbers; consumed when workers become free. An `Inbox` is closed at
        the end.
    workers
        Number of processes.
    limits
        Limits of each run.

    Raises
    ------
    CosimError
        No worker process can be started.
    """
    done: queue.SimpleQueue[Finished | BaseException | None] = queue.SimpleQueue()
    pool = [Worker(limits) for _ in range(workers)]
    take, lines = shared(jobs), Lines()
    threads = [
        threading.Thread(target=serve, args=(worker, take, done, lines), daemon=True) for worker in pool
    ]
    try:
        for thread in threads:
            thread.start()
        busy = len(threads)
        while busy:
            item = done.get()
            if isinstance(item, BaseException):
                raise item
            if item is None:
                busy -= 1
            else:
                yield item
    finally:
        if isinstance(jobs, Inbox):
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


def shared(jobs: Iterable[Numbered]) -> Callable[[], Numbered | None]:
    """Next entry for any thread; None at the end."""
    iterator: Iterator[Numbered] = iter(jobs)
    lock = threading.Lock()

    def take() -> Numbered | None:
        with lock:
            return next(iterator, None)

    return take


def serve(worker: Worker, take: Callable[[], Numbered | None], done: Any, lines: Lines) -> None:
    """Send jobs to one worker until the end; None marks the end, an exception a failure."""
    try:
        while (job := take()) is not None:
            done.put((job[0], worker.call(job[1], on_line=functools.partial(lines.report, name(*job)))))
        worker.finish()
        done.put(None)
    except ClosedError:
        done.put(None)
    except BaseException as error:
        done.put(error)
