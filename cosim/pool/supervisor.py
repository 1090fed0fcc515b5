"""A supervised worker process: a crash, a hang or too much memory affects only one run."""

from __future__ import annotations

import contextlib
import logging
import math
import subprocess
import threading
import time
from collections.abc import Callable
from typing import Any

from cosim.closing import Closing
from cosim.loop import repeats
from cosim.loop.place import Place
from cosim.loop.repeats import NewProcessError
from cosim.pool.channel import NoMessageError, Parcel
from cosim.pool.child import Child, ending, no_start, spawn
from cosim.pool.job import Order, Task, WorkerError
from cosim.pool.limits import Limits, system_confines
from cosim.pool.lines import OnLine, most, report
from cosim.warned import warn_once

START_TIMEOUT = 120.0
"""Maximum time for the imports of a worker process, s."""
MEMORY_INTERVAL = 0.02
"""Period of memory checks of a worker process without a limit of the operating system, s."""
GRACE = 2.0
"""Maximum time for a worker process to close FMU and plant and to end, s."""
LOOK_INTERVAL = 1.0
"""Period of checks that the process is alive, s: its child processes may keep its connection open."""
WATCH_INTERVAL = 0.1
"""Period of progress messages, s."""
LAST_MESSAGE = 0.2
"""Maximum time for a message of an ended process to be read, s."""
KILLED = (-9, -15)
"""Return codes of a process that SIGKILL or SIGTERM ended, as others send them."""
AGAIN = "Increase `{}`, or check the scenario for a hang."

log = logging.getLogger("cosim")
Watch = Callable[[int, int], None]
"""Called periodically with the completed and the total number of steps."""


class ClosedError(Exception):
    """The worker is no longer needed."""


class Worker(Closing):
    """One worker process: started with a task, killed if it exceeds a limit, replaced after its end.

    Parameters
    ----------
    limits
        Limits of each task.
    relay
        Whether its output goes to stderr and all its log lines to the log; otherwise only the last line is
        kept for error texts, and the log is limited.
    """

    def __init__(self, limits: Limits, relay: bool = False) -> None:
        self.limits = limits
        self.relay = relay
        self.child: Child | None = None
        self.on_line: OnLine = report
        self.lock = threading.Lock()
        self.closed = False
        self.place = Place()

    @property
    def confined(self) -> float | None:
        """Memory limit of the operating system in bytes; None for no limit."""
        return self.limits.memory if system_confines() else None

    def prepare(self) -> None:
        """Start the process, which imports its modules in the meantime.

        The limits are sent with its first task and can be changed until then.
        """
        self.start(self.confined)

    def call(self, task: Task, watch: Watch | None = None, on_line: OnLine = report) -> Any:
        """Execute one task and wait for its outcome, which is a `CosimError` if it failed.

        `on_line` receives its log lines.

        A process can die because of an earlier run, a memory limit or an external signal. The task is then
        repeated once in a new process, whose memory is only checked periodically. A run whose result would
        depend on earlier ones has a new process.

        Raises
        ------
        CosimError
            No worker process can be started.
        """
        self.on_line = on_line
        outcome = self.attempt(task, watch, self.confined)
        if self.doubtful(outcome):
            log.info("%s; the run is repeated in a new process", outcome.message)
            outcome = self.attempt(task, watch, None)
        if isinstance(outcome, NewProcessError):
            if outcome.warning:
                self.on_line((log.name, logging.WARNING, outcome.warning))
            self.finish()
            outcome = self.attempt(task, watch, self.confined)
        child = self.child
        if self.limits.process_per_run or (child and (child.spoilt or child.memory != self.confined)):
            self.finish()
        return outcome

    def doubtful(self, outcome: Any) -> bool:
        """Whether a crash may have another cause than the current run."""
        if not isinstance(outcome, WorkerError) or outcome.status != "crashed" or self.child is None:
            return False
        killed = self.child.process.returncode in KILLED
        return killed or self.child.tasks > 1 or self.child.memory is not None

    def attempt(self, task: Task, watch: Watch | None, memory: float | None) -> Any:
        """Execute one task in a process with a memory limit."""
        child = self.start(memory)
        if child.output:
            child.output.kept = b""
        self.place.clear()
        first = not child.tasks
        child.tasks += 1
        child.busy, child.said = True, ""
        lines = math.inf if self.relay else most()
        try:
            # a process that dies while it starts is reported by `outcome`
            with contextlib.suppress(OSError):
                if first:
                    child.channel.send(memory)
                child.channel.send(Order(task, log.getEffectiveLevel(), lines, dict(repeats.verdicts)))
            return self.outcome(child, watch)
        except (EOFError, OSError):
            return self.crashed(child)
        except NoMessageError:
            return self.garbled(child)

    def start(self, memory: float | None) -> Child:
        """Live process with this memory limit; a new one is started if necessary."""
        with self.lock:
            if self.closed:
                raise ClosedError
            child = self.child
            fits = child is not None and (child.memory == memory or not child.tasks)
            if child is None or not fits or child.process.poll() is not None:
                self.kill()
                self.release()
                child = self.child = spawn(self.relay)
                self.place = child.place
            child.memory = memory
            return child

    def outcome(self, child: Child, watch: Watch | None) -> Any:
        """Outcome of the sent task, or the exceeded limit."""
        memory = self.limits.memory if child.memory is None else None
        end, repeated = self.deadline(child), 0
        while True:
            left = None if end is None else max(0.0, end - time.monotonic())
            waits = (left, WATCH_INTERVAL if watch else None, MEMORY_INTERVAL if memory else None)
            parcel = child.receive(min((LOOK_INTERVAL, *(wait for wait in waits if wait is not None))))
            ended = parcel is None and child.process.poll() is not None
            if ended:
                parcel = child.receive(LAST_MESSAGE)
            if parcel is not None:
                kind, content = self.message(child, parcel)
                if kind == "ready":
                    child.ready = content
                    end = self.deadline(child)
                elif kind == "done":
                    child.busy = False
                    outcome, fit, verdicts = content
                    child.spoilt = not fit
                    repeats.verdicts.update(verdicts)
                    return outcome
            elif left == 0.0:
                if self.place.page.repeated == repeated:
                    return self.too_long(child)
                # an earlier run was repeated before this one, and each has its own time
                repeated, end = self.place.page.repeated, self.deadline(child)
            elif ended:
                return self.crashed(child)
            if watch and self.place.page.steps:
                watch(self.place.page.step, self.place.page.steps)
            if memory and (used := child.resident()) > memory:
                return self.too_much(used)

    def message(self, child: Child, parcel: Parcel) -> tuple[str, Any]:
        """Message of a process; passes on its log lines."""
        try:
            kind, content = parcel.open()
        except Exception:  # pickle has many
            raise NoMessageError from None
        if kind == "log":
            child.said = content[2]
            self.on_line(content)
        return kind, content

    def deadline(self, child: Child) -> float | None:
        """Deadline of the answer."""
        longest = self.limits.timeout if child.ready else START_TIMEOUT
        return None if longest is None else time.monotonic() + longest

    def too_long(self, child: Child) -> WorkerError:
        """End a process after a timeout; return the error."""
        self.kill()
        if not child.ready:
            raise no_start(f"it is not ready within {START_TIMEOUT:g} s")
        key, timeout = self.limits.keys[0], self.limits.timeout
        who = self.place.who()
        where = f"{who} did not return {self.place.when()}".rstrip() if who else ""
        text = f"no result within `{key}` = `{timeout:g}` s"
        return WorkerError("timeout", f"{text}: {where}" if where else text, AGAIN.format(key))

    def too_much(self, used: float) -> WorkerError:
        """End a process that used too much memory; return the error."""
        self.kill()
        assert self.limits.memory is not None
        key, memory = self.limits.keys[1], self.limits.memory / 1e6
        text = f"`{used / 1e6:.0f}` MB of memory are more than `{key}` = `{memory:g}` MB"
        who = self.place.who()
        return WorkerError("memory", f"{text}, used by {who} {self.place.when()}".rstrip() if who else text)

    def garbled(self, child: Child) -> WorkerError:
        """End a process with a corrupted connection; return the error."""
        self.kill()
        how = "the connection to the worker process is corrupted"
        if not child.ready:
            raise no_start(how)
        who = self.place.ran() or "a task"
        return WorkerError("crashed", f"{who} wrote to a foreign file descriptor: {how}")

    def crashed(self, child: Child) -> WorkerError:
        """Error with the end of the process, its position and its last output."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.process.wait(1.0)
        how = ending(child.process.poll())
        self.kill()
        said = child.last_output()
        how += f"; its last output: {said}" if said else ""
        if not child.ready:
            raise no_start(how)
        who = self.place.who() or self.place.ran() or "the worker process"
        return WorkerError("crashed", f"{who} crashed {self.place.when()}".rstrip() + f": {how}")

    def finish(self) -> None:
        """Let an idle process close FMU and plant and end; kill it after a timeout."""
        child = self.child
        if child is None or child.busy or not child.tasks or child.process.poll() is not None:
            self.kill()
            return
        end = time.monotonic() + GRACE
        late = True
        try:
            child.note_offspring()
            child.channel.send(None)
            while (parcel := child.receive(max(0.0, end - time.monotonic()))) is not None:
                self.message(child, parcel)
        except (EOFError, OSError, NoMessageError):
            late = False
            with contextlib.suppress(subprocess.TimeoutExpired):
                child.process.wait(max(0.0, end - time.monotonic()))
        finally:
            self.kill()
        self.look_back(child, late)

    def look_back(self, child: Child, late: bool) -> None:
        """Log an abnormal end of a process whose results are complete."""
        who, when, code = self.place.who(), self.place.when(), child.process.returncode
        if self.closed or not (who or late or (code and not child.forced)):
            return
        how = f"it did not end within {GRACE:g} s and was killed" if late else ending(code)
        warn_once(f"{who or 'a worker process'} {'hung' if late else 'crashed'} {when}".rstrip() + f": {how}")

    def kill(self) -> None:
        """Kill the process and its child processes."""
        if self.child is not None:
            self.child.kill()

    def release(self) -> None:
        """Release the resources of an ended process."""
        child, self.child = self.child, None
        if child is not None:
            child.release()

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
