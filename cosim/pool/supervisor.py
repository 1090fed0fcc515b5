"""A supervised worker process: a crash, a hang or too much memory affects only one run."""

from __future__ import annotations

import contextlib
import logging
import math
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from cosim.closing import Closing
from cosim.errors import CosimError
from cosim.loop import repeats
from cosim.loop.repeats import NewProcessError
from cosim.pool.channel import Frame, NoMessageError
from cosim.pool.job import EVENTS, Request, Task, WorkerError
from cosim.pool.limits import Limits
from cosim.pool.worker_handle import WorkerHandle, ending, spawn
from cosim.process import LINUX
from cosim.warned import warn_once

START_TIMEOUT = 120.0
"""Maximum time for the imports of a worker process, s."""
MEMORY_INTERVAL = 0.02
"""Period of memory checks of a worker process without a limit of the operating system, s."""
GRACE = 2.0
"""Maximum time for a worker process to close FMU and plant and to end, s."""
ALIVE_INTERVAL = 1.0
"""Period of checks that the process is alive, s: its child processes may keep its connection open."""
PROGRESS_INTERVAL = 0.1
"""Period of progress messages, s."""
LAST_MESSAGE = 0.2
"""Maximum time for a message of an ended process to be read, s."""
KILLED = (-9, -15)
"""Return codes of a process that SIGKILL or SIGTERM ended, as others send them."""
MAX_LINES = 20
"""Maximum log lines of one run, and of all runs together, without `-v`."""
Line = tuple[str, int, str]
"""Name of a logger, level and text."""
OnLine = Callable[[Line], None]

if TYPE_CHECKING:
    from cosim.loop.reference import Progress

log = logging.getLogger("cosim")


def report(line: Line, run: str = "") -> None:
    """Log a line of another process, with the name of its run."""
    name, level, text = line
    logging.getLogger(name).log(level, "%s", f"{run}: {text}" if run else text)


class ClosedError(Exception):
    """The worker is no longer needed."""


class Worker(Closing):
    """One worker process: started with a task, killed if it exceeds a limit, replaced after its end.

    With `relay` its output goes to stderr and all its log lines to the log; otherwise only the last line is
    kept for error texts, and the log is limited.
    """

    def __init__(self, limits: Limits, relay: bool = False) -> None:
        self.limits = limits
        self.relay = relay
        self.handle: WorkerHandle | None = None
        self.on_line: OnLine = report
        self.lock = threading.Lock()
        self.closed = False

    @property
    def confined(self) -> float | None:
        """Memory limit in bytes that the operating system enforces; None for no limit."""
        return self.limits.memory if LINUX else None

    def prepare(self) -> None:
        """Start the process, which imports its modules in the meantime.

        The limits are sent with its first task and can be changed until then.
        """
        self.start(self.confined)

    def call(self, task: Task, progress: Progress | None = None, on_line: OnLine = report) -> Any:
        """Execute one task and wait for its outcome, which is a `CosimError` if it failed.

        `on_line` receives its log lines. Raises CosimError if no worker process can be started.

        A process can die because of an earlier run, a memory limit or an external signal. The task is then
        repeated once in a new process, whose memory is only checked periodically. A run whose result would
        depend on earlier ones has a new process.
        """
        self.on_line = on_line
        outcome = self.attempt(task, progress, self.confined)
        if self.doubtful(outcome):
            log.info("%s; the run is repeated in a new process", outcome.message)
            outcome = self.attempt(task, progress, None)
        if isinstance(outcome, NewProcessError):
            if outcome.warning:
                self.on_line((log.name, logging.WARNING, outcome.warning))
            self.finish()
            outcome = self.attempt(task, progress, self.confined)
        handle = self.handle
        if self.limits.process_per_run or (handle and (handle.spoilt or handle.memory != self.confined)):
            self.finish()
        return outcome

    def doubtful(self, outcome: Any) -> bool:
        """Whether a crash may have another cause than the current run."""
        if not isinstance(outcome, WorkerError) or outcome.status != "crashed" or self.handle is None:
            return False
        killed = self.handle.process.returncode in KILLED
        return killed or self.handle.tasks > 1 or self.handle.memory is not None

    def attempt(self, task: Task, progress: Progress | None, memory: float | None) -> Any:
        """Execute one task in a process with a memory limit."""
        handle = self.start(memory)
        if handle.output:
            handle.output.kept = b""
        handle.position.clear()
        first = not handle.tasks
        handle.tasks += 1
        handle.busy, handle.last_log = True, ""
        lines = math.inf if self.relay or log.isEnabledFor(EVENTS) else MAX_LINES
        try:
            # a process that dies while it starts is reported by `outcome`
            with contextlib.suppress(OSError):
                if first:
                    handle.channel.send(memory)
                handle.channel.send(Request(task, log.getEffectiveLevel(), lines, dict(repeats.verdicts)))
            return self.outcome(handle, progress)
        except (EOFError, OSError):
            return self.crashed(handle)
        except NoMessageError:
            return self.garbled(handle)

    def start(self, memory: float | None) -> WorkerHandle:
        """Live process with this memory limit; a new one is started if necessary."""
        with self.lock:
            if self.closed:
                raise ClosedError
            handle = self.handle
            fits = handle is not None and (handle.memory == memory or not handle.tasks)
            if handle is None or not fits or handle.process.poll() is not None:
                self.release()
                handle = self.handle = spawn(self.relay)
            handle.memory = memory
            return handle

    def outcome(self, handle: WorkerHandle, progress: Progress | None) -> Any:
        """Outcome of the sent task, or the exceeded limit."""
        memory = self.limits.memory if handle.memory is None else None
        periods = progress and PROGRESS_INTERVAL, memory and MEMORY_INTERVAL, ALIVE_INTERVAL
        interval = min(filter(None, periods))
        page, end, repeated = handle.position.page, self.deadline(handle), 0
        while True:
            left = max(0.0, end - time.monotonic())
            frame = handle.receive(min(left, interval))
            ended = frame is None and handle.process.poll() is not None
            if ended:
                frame = handle.receive(LAST_MESSAGE)
            if frame is not None:
                kind, content = self.message(handle, frame)
                if kind == "ready":
                    handle.pid = content
                    end = self.deadline(handle)
                elif kind == "done":
                    handle.busy = False
                    outcome, fit, verdicts = content
                    handle.spoilt = not fit
                    repeats.verdicts.update(verdicts)
                    return outcome
            elif left == 0.0:
                if page.repeated == repeated:
                    return self.too_long(handle)
                # an earlier run was repeated before this one, and each has its own time
                repeated, end = page.repeated, self.deadline(handle)
            elif ended:
                return self.crashed(handle)
            if progress and page.steps:
                progress(page.step, page.steps)
            if memory and (used := handle.resident()) > memory:
                return self.too_much(handle, used, memory)

    def message(self, handle: WorkerHandle, frame: Frame) -> tuple[str, Any]:
        """Kind and content of a message of a process; passes on its log lines.

        `ready` has its number; `done` has the outcome, whether it is fit for another task, and verdicts.
        """
        try:
            kind, content = frame()
        except Exception:  # pickle has many
            raise NoMessageError from None
        if kind == "log":
            handle.last_log = content[2]
            self.on_line(content)
        return kind, content

    def deadline(self, handle: WorkerHandle) -> float:
        """Deadline of the answer."""
        longest = self.limits.timeout if handle.pid else START_TIMEOUT
        return time.monotonic() + (longest or math.inf)

    def end(self, handle: WorkerHandle, how: str) -> None:
        """End a process; raises CosimError with the reason if it did not start."""
        self.kill()
        if not handle.pid:
            hint = f"Check that `{sys.executable}` can import the package `cosim`."
            raise CosimError(f"a worker process does not start: {how}", hint)

    def too_long(self, handle: WorkerHandle) -> WorkerError:
        """End a process after a timeout; return the error."""
        self.end(handle, f"it is not ready within {START_TIMEOUT:g} s")
        key = self.limits.keys[0]
        text = f"no result within `{key}` = `{self.limits.timeout:g}` s"
        where = handle.where(handle.position.who(), "did not return")
        hint = f"Increase `{key}`, or check the scenario for a hang."
        return WorkerError("timeout", f"{text}: {where}" if where else text, hint)

    def too_much(self, handle: WorkerHandle, used: float, memory: float) -> WorkerError:
        """End a process that used too much memory; return the error."""
        self.kill()
        limit = f"`{self.limits.keys[1]}` = `{memory / 1e6:g}` MB"
        text = f"`{used / 1e6:.0f}` MB of memory are more than {limit}"
        where = handle.where(handle.position.who())
        return WorkerError("memory", f"{text}, used by {where}" if where else text)

    def garbled(self, handle: WorkerHandle) -> WorkerError:
        """End a process with a corrupted connection; return the error."""
        how = "the connection to the worker process is corrupted"
        self.end(handle, how)
        who = handle.position.ran() or "a task"
        return WorkerError("crashed", f"{who} wrote to a foreign file descriptor: {how}")

    def crashed(self, handle: WorkerHandle) -> WorkerError:
        """Error with the end of the process, its position and its last output."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            handle.process.wait(1.0)
        how = ending(handle.process.poll())
        self.kill()
        if output := handle.last_output():
            how += f"; its last output: {output}"
        self.end(handle, how)
        who = handle.position.who() or handle.position.ran() or "the worker process"
        return WorkerError("crashed", f"{handle.where(who, 'crashed')}: {how}")

    def finish(self) -> None:
        """Let an idle process close FMU and plant and end; kill it after a timeout.

        Logs an abnormal end, because the results of the process are complete.
        """
        handle = self.handle
        if handle is None or handle.busy or not handle.tasks or handle.process.poll() is not None:
            self.kill()
            return
        end = time.monotonic() + GRACE
        late = True
        try:
            handle.note_children()
            handle.channel.send(None)
            while (frame := handle.receive(max(0.0, end - time.monotonic()))) is not None:
                self.message(handle, frame)
        except (EOFError, OSError, NoMessageError):
            late = False
            with contextlib.suppress(subprocess.TimeoutExpired):
                handle.process.wait(max(0.0, end - time.monotonic()))
        finally:
            code = handle.process.poll()
            self.kill()
        who = handle.position.who()
        if not self.closed and (who or late or code):
            how = f"it did not end within {GRACE:g} s and was killed" if late else ending(code)
            where = handle.where(who or "a worker process", "hung" if late else "crashed")
            warn_once(f"{where}: {how}")

    def kill(self) -> None:
        """Kill the process and its child processes."""
        if self.handle is not None:
            self.handle.kill()

    def release(self) -> None:
        """End the process and release its resources."""
        self.kill()
        handle, self.handle = self.handle, None
        if handle is not None:
            handle.release()

    def stop(self) -> None:
        """End the process; a `call` in another thread returns, and no other starts."""
        with self.lock:
            self.closed = True
            self.kill()

    def close(self) -> None:
        """End the process and release its resources; no `call` may be active.

        FMU and plant are closed first, unless the process is executing an abandoned task.
        """
        self.finish()
        self.stop()
        self.release()
