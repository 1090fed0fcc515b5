"""A worker process: takes tasks from a channel one after the other and answers each with its outcome."""

from __future__ import annotations

import ctypes
import logging
import os
import queue
import signal
import socket
import sys
import threading
import traceback
from typing import Any

from cosim.closing import Closing
from cosim.errors import CosimError
from cosim.loop.engines import Engine
from cosim.loop.place import Place
from cosim.loop.reference import Progress
from cosim.loop.session import Session
from cosim.pool.channel import MessageChannel, Parcel
from cosim.pool.job import Task, WorkerError
from cosim.pool.limits import confine
from cosim.scenario.model import Scenario

READY, LOG, DONE = "ready", "log", "done"
"""Kinds of messages of a worker process: everything is imported; a line of its log; the outcome."""
IDLE = 600.0
"""A worker process that got no task for so long ends, s; the next task starts another one."""
PR_SET_PDEATHSIG = 1

log = logging.getLogger("cosim")


class JobRunner(Closing):
    """Does tasks one after the other; FMU and plant stay open for jobs that share them.

    Parameters
    ----------
    place
        Where it notes what it is doing.
    progress
        Told the steps done and in all.
    """

    def __init__(self, place: Place | None = None, progress: Progress | None = None) -> None:
        self.place = place or Place()
        self.progress = progress
        self.opened: Session | None = None
        self.wanted: tuple[Scenario, Engine, bool] | None = None

    def run(self, task: Task) -> Any:
        """Do one task; its errors are outcomes, and after one the next gets a fresh FMU and plant."""
        try:
            return task.run(self)
        except CosimError as error:
            self.close()
            if isinstance(error.__cause__, MemoryError):
                return WorkerError("memory", error.message, error.hint)
            return error
        except (Exception, SystemExit) as error:  # whatever it is, it concerns only this run
            self.close()
            failure = CosimError(f"the run failed: {type(error).__name__}: {error}", "`-v` shows where")
            failure.__cause__ = error
            return failure

    def session(self, scenario: Scenario, engine: Engine, log_events: bool = False) -> Session:
        """Session of a scenario; what fits of the one before stays open."""
        wanted = scenario, engine, log_events
        if self.opened is None or self.wanted != wanted:
            self.opened = Session(scenario, log_events, engine, self.opened, self.place)
            self.wanted = wanted
        return self.opened

    def close(self) -> None:
        """Free the FMU."""
        session, self.opened = self.opened, None
        if session is not None:
            session.close()


class Forward(logging.Handler):
    """Sends what is logged to the process that watches over this one."""

    def __init__(self, channel: MessageChannel) -> None:
        super().__init__()
        self.channel = channel

    def emit(self, record: logging.LogRecord) -> None:
        """Send one line."""
        self.channel.send((LOG, (record.name, record.levelno, self.format(record))))


def main(end: int, page: int, parent: int, memory: float | None) -> None:
    """Serve the channel until the other side closes it."""
    die_with(parent)
    for descriptor in (end, page):
        # what FMU or plant may start must not keep the channel open
        os.set_inheritable(descriptor, False)
    channel = MessageChannel(socket.socket(fileno=end))
    tasks: queue.SimpleQueue[Parcel] = queue.SimpleQueue()
    threading.Thread(target=listen, args=(channel, tasks), daemon=True).start()
    runner = JobRunner(Place(page))
    refusal = refused(memory) if memory is not None else None
    channel.send((READY, None))
    while True:
        try:
            parcel = tasks.get(timeout=IDLE)
        except queue.Empty:
            return
        channel.send((DONE, refusal or done(runner, parcel, channel)))


def refused(memory: float) -> WorkerError | None:
    """Put a limit to the memory of this process; an error if that cannot be kept."""
    try:
        confine(memory)
    except MemoryError as error:
        used = f"`{error.args[0] / 1e6:.0f}` MB of memory, which a run needs before it begins,"
        return WorkerError("memory", f"{used} are more than its limit of `{memory / 1e6:g}` MB")
    return None


def done(runner: JobRunner, parcel: Parcel, channel: MessageChannel) -> Any:
    """Outcome of one task; its log is forwarded if a level is given with it."""
    try:
        task, level = parcel.open()
    except Exception as error:
        text = f"a worker process cannot read its task: {type(error).__name__}: {error}"
        return CosimError(text, "its module must be found by every process")
    if level is not None:
        log.handlers[:], log.propagate = [Forward(channel)], False
        log.setLevel(level)
    outcome = runner.run(task)
    if isinstance(outcome, CosimError) and log.isEnabledFor(logging.DEBUG):
        # a traceback does not travel, its text does
        outcome.add_note("".join(traceback.format_exception(outcome)))
    return outcome


def listen(channel: MessageChannel, tasks: queue.SimpleQueue[Parcel]) -> None:
    """Take in tasks; when the other side is gone the process ends at once, even from within a run."""
    try:
        while True:
            tasks.put(channel.receive())
    finally:
        os._exit(0)


def die_with(parent: int) -> None:
    """End with the parent process, however that ends and even while code of C keeps the GIL."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(0)
