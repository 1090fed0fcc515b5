"""A worker process: receives tasks from a channel and answers each with its outcome."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import io
import logging
import os
import queue
import signal
import sys
import threading
import traceback
from pathlib import Path
from typing import Any

from cosim import process
from cosim.closing import Closing
from cosim.errors import CosimError, UnforeseenError, unforeseen
from cosim.loop import fmus, repeats
from cosim.loop.engines import Engine
from cosim.loop.position import Position, Stage
from cosim.loop.reference import Progress
from cosim.loop.session import Session
from cosim.pool.channel import Frame, MessageChannel
from cosim.pool.job import Request, Task, WorkerError
from cosim.process import LINUX
from cosim.scenario.model import Scenario
from cosim.warned import once

PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36

log = logging.getLogger("cosim")


class JobRunner(Closing):
    """Executes tasks in sequence as their context; FMU and plant stay open for jobs that share them."""

    def __init__(self, position: Position | None = None) -> None:
        self.position = position or Position()
        self.progress: Progress | None = None
        self.opened: Session | None = None
        self.wanted: tuple[Scenario, Engine, bool] | None = None

    def run(self, task: Task, progress: Progress | None = None) -> Any:
        """Execute one task; an error is an outcome, and the next task then has a new FMU and plant."""
        self.progress = progress
        try:
            return task.run(self)
        except CosimError as error:
            self.close()
            if isinstance(error.__cause__, MemoryError):
                return WorkerError("memory", error.message, error.hint)
            return error
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # any error concerns only this run
            self.close()
            return unforeseen(error)

    def session(self, scenario: Scenario, engine: Engine, log_events: bool = False) -> Session:
        """Session of a scenario; suitable open FMUs and plants are reused."""
        wanted = scenario, engine, log_events
        if self.opened is None or self.wanted != wanted:
            self.opened = Session(scenario, log_events, engine, self.opened, self.position)
            self.wanted = wanted
        return self.opened

    def close(self) -> None:
        """Free the FMU and close the plant."""
        session, self.opened = self.opened, None
        if session is not None:
            session.close()
        self.position.at(Stage.NONE)


class Forward(logging.Handler):
    """Sends log lines to the supervisor, up to a maximum per task."""

    def __init__(self, channel: MessageChannel) -> None:
        super().__init__()
        self.channel = channel
        self.left: float = 0

    def emit(self, record: logging.LogRecord) -> None:
        """Send one line."""
        if self.left > 0 and self.channel.own:
            self.left -= 1
            self.channel.send(("log", (record.name, record.levelno, self.format(record))))


def main(page: str, parent: int) -> None:
    """Serve stdin and stdout until the end is requested, or until the other side closes them."""
    gc.enable()
    die_with(parent)
    channel, position = channel_of_streams(), Position(Path(page))
    # Windows keeps it until both sides are done
    with contextlib.suppress(OSError):
        Path(page).unlink()
    tasks: queue.SimpleQueue[Frame] = queue.SimpleQueue()
    threading.Thread(target=listen, args=(channel, tasks), daemon=True).start()
    forward = Forward(channel)
    fmus.strict = True
    exceeded = confined(tasks)
    with JobRunner(position) as runner, once():
        channel.send(("ready", os.getpid()))
        before = process.belongings()
        while (request := awaited(tasks)) is not None:
            outcome, fit = inspected(exceeded or done(runner, request, forward), before, position)
            channel.send(("done", (outcome, fit and not repeats.spoilt(), repeats.verdicts)))
    # a last search for reference cycles in all imported modules would take longer than the rest of the end
    gc.freeze()


def channel_of_streams() -> MessageChannel:
    """Channel of the pipes on stdin and stdout; runs then read nothing and print to stderr."""
    # the copies are not inherited: what a run starts must not keep the channel open
    source, sink = os.dup(0), os.dup(1)
    null = os.open(os.devnull, os.O_RDONLY)
    os.dup2(null, 0)
    os.close(null)
    os.dup2(2, 1)
    if isinstance(sys.stdout, io.TextIOWrapper):
        # a crash loses no line
        sys.stdout.reconfigure(line_buffering=True)
    return MessageChannel(os.fdopen(source, "rb"), os.fdopen(sink, "wb"))


def confined(tasks: queue.SimpleQueue[Frame]) -> WorkerError | None:
    """Set the memory limit of this process, sent first; an error if it is exceeded already."""
    memory: float | None = tasks.get()()
    if memory is None:
        return None
    import resource

    import psutil

    now = psutil.Process().memory_info()
    if now.rss > memory:
        used = f"`{now.rss / 1e6:.0f}` MB of memory, which a run needs before its start,"
        return WorkerError("memory", f"{used} exceed its limit of `{memory / 1e6:g}` MB")
    # what is reserved but not touched, such as stacks of threads, is no memory that it has
    most = int(now.data + memory - now.rss)
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    soft = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
    return None


def awaited(tasks: queue.SimpleQueue[Frame]) -> Request | CosimError | None:
    """Wait for a request; None is the request to end."""
    frame = tasks.get()
    try:
        request: Request | None = frame()
    except Exception as error:
        text = f"a worker process cannot read its task: {type(error).__name__}: {error}"
        return CosimError(text, "Make its module importable in every process.")
    return request


def done(runner: JobRunner, request: Request | CosimError, forward: Forward) -> Any:
    """Outcome of one task; forwards its log."""
    if isinstance(request, CosimError):
        return request
    forward.left = request.lines
    repeats.verdicts.update(request.verdicts)
    log.handlers[:], log.propagate = [forward], False
    log.setLevel(request.level)
    outcome = runner.run(request.task)
    if isinstance(outcome, CosimError) and log.isEnabledFor(logging.DEBUG):
        # a traceback does not travel, its text does
        outcome.add_note("".join(traceback.format_exception(outcome)))
    return outcome


def inspected(outcome: Any, before: dict[str, object], position: Position) -> tuple[Any, bool]:
    """Outcome, and whether the process state is unchanged; logs a change."""
    changed = process.changed(before)
    if not changed:
        return outcome, True
    problem = f"{position.ran() or 'a task'} changed {changed} of its process"
    if isinstance(outcome, UnforeseenError):
        outcome.message = f"{problem}: {outcome.__cause__}"
    elif isinstance(outcome, CosimError) and process.LIMITS in changed:
        outcome.message = f"{problem}: {outcome.message}"
    else:
        log.warning("%s: the next run has a new process", problem)
    return outcome, False


def listen(channel: MessageChannel, tasks: queue.SimpleQueue[Frame]) -> None:
    """Receive tasks; when the other side is gone the process ends immediately, even within a run."""
    try:
        while True:
            tasks.put(channel.receive())
    finally:
        os._exit(0)


def die_with(parent: int) -> None:
    """End with the parent process, even while C code holds the GIL.

    Child processes of a run stay below this process, to be found and ended with it.
    """
    if LINUX:
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
        if os.getppid() != parent:
            os._exit(0)
