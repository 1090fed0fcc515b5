"""Worker processes under supervision: a crash, a hang or too much memory costs the one run that caused it."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from cosim.errors import CosimError
from cosim.sweep.worker import READY, Job, Outcome

START_TIMEOUT = 120.0
"""Time for a worker process to import everything, s."""
MEMORY_INTERVAL = 0.2
"""How often the memory of a worker process is looked at, s."""
LONGEST_OUTPUT = 300
"""Characters kept of what a worker process said last."""
COMMAND = "from cosim.sweep.worker import main; main({})"


@dataclass(frozen=True)
class Limits:
    """What one run may take.

    Parameters
    ----------
    timeout
        Wall time in s; None is without limit.
    memory
        Resident memory of the worker process in bytes; None is without limit.
    """

    timeout: float | None = None
    memory: float | None = None


class WorkerError(CosimError):
    """A run that took its worker process with it.

    Attributes
    ----------
    status
        `crashed`, `timeout`, `memory` or `lost`.
    """

    def __init__(self, status: str, message: str, hint: str = "") -> None:
        super().__init__(message, hint)
        self.status = status

    def __reduce__(self) -> tuple[Any, ...]:
        return WorkerError, (self.status, self.message, self.hint)


class ClosedError(Exception):
    """The worker is not wanted any more."""


class Worker:
    """One worker process: started when a job comes, killed when it exceeds a limit, replaced when gone."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.process: subprocess.Popen[bytes] | None = None
        self.lock = threading.Lock()
        self.closed = False

    def call(self, job: Job) -> Outcome:
        """Run one job and wait for its outcome.

        Raises
        ------
        CosimError
            No worker process can be started.
        """
        self.start()
        self.output.truncate(0)
        try:
            self.connection.send(job)
            return self.answer()
        except (EOFError, OSError):
            return self.crashed()

    def start(self) -> None:
        """Start a process unless one is alive; returns when it is ready."""
        with self.lock:
            if self.closed:
                raise ClosedError
            if self.process is not None and self.process.poll() is None:
                return
            self.release()
            ours, theirs = socket.socketpair()
            self.output = tempfile.TemporaryFile("a+b")  # noqa: SIM115 - it lives as long as the process
            with theirs:
                self.process = subprocess.Popen(
                    [sys.executable, "-c", COMMAND.format(theirs.fileno())],
                    stdin=subprocess.DEVNULL,
                    stdout=self.output,
                    stderr=self.output,
                    pass_fds=(theirs.fileno(),),
                    start_new_session=True,  # Ctrl-C is for us to handle
                    env={**os.environ, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))},
                )
            self.connection = Connection(ours.detach())
        with contextlib.suppress(EOFError, OSError):
            if self.connection.poll(START_TIMEOUT) and self.connection.recv() == READY:
                return
        problem = f"a worker process does not start: {self.crashed().message}"
        raise CosimError(problem, f"it runs `{sys.executable}`, which must find the package `cosim`")

    def answer(self) -> Outcome:
        """Outcome of the job that was sent, or the limit it did not keep."""
        timeout, memory = self.limits.timeout, self.limits.memory
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            left = None if end is None else max(0.0, end - time.monotonic())
            waits = [wait for wait in (left, MEMORY_INTERVAL if memory else None) if wait is not None]
            if self.connection.poll(min(waits, default=None)):
                outcome: Outcome = self.connection.recv()
                return outcome
            if left == 0.0:
                self.kill()
                hint = "a longer `limits.timeout`, or a scenario that hangs"
                return WorkerError("timeout", f"no result within `limits.timeout` = `{timeout:g}` s", hint)
            if memory and (used := self.resident()) > memory:
                self.kill()
                problem = (
                    f"`{used / 1e6:.0f}` MB of memory are more than `limits.memory` = `{memory / 1e6:.0f}` MB"
                )
                return WorkerError("memory", problem)

    def crashed(self) -> WorkerError:
        """Error that tells how the process ended and what it said last."""
        assert self.process is not None
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(1.0)
        code = self.process.poll()
        if code is None:
            self.kill()
            how = "it does not answer"
        elif code < 0:
            how = f"killed by {signal.Signals(-code).name}"
        else:
            how = f"ended with exit code {code}"
        said = self.last_output()
        return WorkerError(
            "crashed", f"the worker process crashed: {how}" + (f"; its last words: {said}" if said else "")
        )

    def last_output(self) -> str:
        """Last line that the process printed."""
        self.output.seek(-min(self.output.seek(0, os.SEEK_END), 4 * LONGEST_OUTPUT), os.SEEK_END)
        lines = self.output.read().decode(errors="replace").split("\n")
        return next((line.strip()[:LONGEST_OUTPUT] for line in reversed(lines) if line.strip()), "")

    def resident(self) -> int:
        """Resident memory of the process, bytes; 0 where it is gone."""
        assert self.process is not None
        try:
            pages = Path(f"/proc/{self.process.pid}/statm").read_text().split()[1]
        except (OSError, IndexError):
            return 0
        return int(pages) * os.sysconf("SC_PAGE_SIZE")

    def kill(self) -> None:
        """End the process, and what it may have started, at once."""
        if self.process is not None and self.process.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()

    def release(self) -> None:
        """Give back what belonged to a process that is gone."""
        if self.process is not None:
            self.process.wait()
            self.connection.close()
            self.output.close()
            self.process = None

    def close(self) -> None:
        """End the process; a `call` under way returns."""
        with self.lock:
            self.closed = True
            self.kill()


Numbered = tuple[int, Job]
Finished = tuple[int, Outcome]


def outcomes(jobs: Iterable[Numbered], workers: int, limits: Limits) -> Generator[Finished]:
    """Run jobs on worker processes of this machine; outcomes come as they are done.

    Closing the generator ends the worker processes at once.

    Parameters
    ----------
    jobs
        Jobs with their numbers; taken from the iterable as workers become free.
    workers
        Processes.
    limits
        What each run may take.

    Raises
    ------
    CosimError
        No worker process can be started.
    """
    done: queue.SimpleQueue[Finished | BaseException | None] = queue.SimpleQueue()
    pool = [Worker(limits) for _ in range(workers)]
    take = shared(jobs)
    threads = [threading.Thread(target=serve, args=(worker, take, done), daemon=True) for worker in pool]
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
        for worker in pool:
            worker.close()
        for thread in threads:
            thread.join()
        for worker in pool:
            worker.release()


def shared(jobs: Iterable[Numbered]) -> Callable[[], Numbered | None]:
    """Next job for whichever thread asks; None when there are no more."""
    iterator: Iterator[Numbered] = iter(jobs)
    lock = threading.Lock()

    def take() -> Numbered | None:
        with lock:
            return next(iterator, None)

    return take


def serve(worker: Worker, take: Callable[[], Numbered | None], done: Any) -> None:
    """Give jobs to one worker until there are no more; None tells the end, an exception the failure."""
    try:
        while (job := take()) is not None:
            done.put((job[0], worker.call(job[1])))
        done.put(None)
    except ClosedError:
        done.put(None)
    except BaseException as error:
        done.put(error)
