"""A worker process under supervision: a crash, a hang or too much memory costs the one run that caused it."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import IO, Any

from cosim.closing import Closing
from cosim.errors import CosimError
from cosim.loop.place import Place
from cosim.pool.channel import MessageChannel
from cosim.pool.job import Task, WorkerError
from cosim.pool.limits import Limits, memory_of, system_confines

START_TIMEOUT = 120.0
"""Time for a worker process to import everything, s."""
MEMORY_INTERVAL = 0.02
"""How often the memory of a worker process is looked at where the operating system does not limit it, s."""
LOOK_INTERVAL = 1.0
"""How often it is looked whether the process is alive, s: what it started may keep its connection open."""
WATCH_INTERVAL = 0.1
"""How often a watcher is told the steps done, s."""
LONGEST_OUTPUT = 300
"""Characters kept of what a worker process said last."""
COMMAND = "from cosim.pool.worker import main; main({}, {}, {}, {})"
AGAIN = "a longer `{}`, or a scenario that hangs"

log = logging.getLogger("cosim")
Watch = Callable[[int, int], None]
"""Told the steps done and in all, now and then."""


class ClosedError(Exception):
    """The worker is not wanted any more."""


@dataclass
class Child:
    """A worker process that was started.

    Parameters
    ----------
    memory
        Bytes that the operating system lets it have, None for any amount.
    output
        What it prints, None where that goes to our stderr.
    tasks
        Tasks that it was given.
    """

    process: subprocess.Popen[bytes]
    channel: MessageChannel
    memory: float | None
    output: IO[bytes] | None
    ready: bool = False
    tasks: int = field(default=0)


class Worker(Closing):
    """One worker process: started when a task comes, killed when it exceeds a limit, replaced when gone.

    Parameters
    ----------
    limits
        What each task may take.
    relay
        Whether its log and all it prints goes to our log and stderr; else only the last line is kept, for the
        text of an error.
    """

    def __init__(self, limits: Limits, relay: bool = False) -> None:
        self.limits = limits
        self.relay = relay
        self.confined = limits.memory if system_confines() else None
        self.child: Child | None = None
        self.lock = threading.Lock()
        self.closed = False
        with tempfile.TemporaryFile() as page:
            page.truncate(4096)
            self.page = os.dup(page.fileno())
        self.place = Place(self.page)

    def prepare(self) -> None:
        """Start the process, which imports what it needs while others have something else to do."""
        self.start(self.confined)

    def call(self, task: Task, watch: Watch | None = None) -> Any:
        """Do one task and wait for its outcome, which is a `CosimError` if it could not be done.

        A process may die of what an earlier run did to it, of a memory limit, or be killed from outside: then
        the task is done once more in a fresh process, whose memory is only watched.

        Raises
        ------
        CosimError
            No worker process can be started.
        """
        outcome = self.attempt(task, watch, self.confined)
        if self.doubtful(outcome):
            log.info("%s; the run is done once more in a fresh process", outcome.message)
            outcome = self.attempt(task, watch, None)
        if self.limits.process_per_run or (self.child and self.child.memory != self.confined):
            self.kill()
        return outcome

    def doubtful(self, outcome: Any) -> bool:
        """Whether a crash may have another cause than the run it came in."""
        if not isinstance(outcome, WorkerError) or outcome.status != "crashed" or self.child is None:
            return False
        killed = self.child.process.returncode in (-signal.SIGKILL, -signal.SIGTERM)
        return killed or self.child.tasks > 1 or self.child.memory is not None

    def attempt(self, task: Task, watch: Watch | None, memory: float | None) -> Any:
        """Do one task in a process that is confined to so much memory."""
        child = self.start(memory)
        if child.output:
            child.output.truncate(0)
        self.place.clear()
        child.tasks += 1
        try:
            # a process that dies while it starts is told of by `outcome`
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                child.channel.send((task, log.getEffectiveLevel() if self.relay else None))
            return self.outcome(child, watch)
        except (EOFError, OSError):
            return self.crashed(child)

    def start(self, memory: float | None) -> Child:
        """Process that is alive and confined to so much memory; another is started where there is none."""
        with self.lock:
            if self.closed:
                raise ClosedError
            child = self.child
            if child is not None and child.process.poll() is None and child.memory == memory:
                return child
            self.kill()
            self.release()
            ours, theirs = socket.socketpair()
            # it lives as long as the process
            output = None if self.relay else tempfile.TemporaryFile("a+b")  # noqa: SIM115
            with theirs:
                process = subprocess.Popen(
                    [
                        sys.executable,
                        "-c",
                        COMMAND.format(theirs.fileno(), self.page, os.getpid(), memory),
                    ],
                    stdin=subprocess.DEVNULL,
                    stdout=output or 2,
                    stderr=output,
                    pass_fds=(theirs.fileno(), self.page),
                    start_new_session=True,  # Ctrl-C is for us to handle
                    env={**os.environ, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))},
                )
            self.child = Child(process, MessageChannel(ours), memory, output)
            return self.child

    def outcome(self, child: Child, watch: Watch | None) -> Any:
        """Outcome of the task that was sent, or the limit it did not keep."""
        memory = self.limits.memory if child.memory is None else None
        end = self.deadline(child)
        while True:
            left = None if end is None else max(0.0, end - time.monotonic())
            waits = (left, WATCH_INTERVAL if watch else None, MEMORY_INTERVAL if memory else None)
            if child.channel.waits(min((wait for wait in waits if wait is not None), default=LOOK_INTERVAL)):
                kind, content = child.channel.receive().open()
                match kind:
                    case "ready":
                        child.ready = True
                        end = self.deadline(child)
                    case "log":
                        name, level, text = content
                        logging.getLogger(name).log(level, "%s", text)
                    case "done":
                        return content
            elif left == 0.0:
                return self.too_long(child)
            elif child.process.poll() is not None and not child.channel.waits(0.0):
                return self.crashed(child)
            if watch and self.place.page.steps:
                watch(self.place.page.step, self.place.page.steps)
            if memory and (used := resident(child)) > memory:
                return self.too_much(used)

    def deadline(self, child: Child) -> float | None:
        """Time until which there must be an answer."""
        longest = self.limits.timeout if child.ready else START_TIMEOUT
        return None if longest is None else time.monotonic() + longest

    def too_long(self, child: Child) -> WorkerError:
        """End a process that took too long; returns the error."""
        self.kill()
        if not child.ready:
            raise no_start(f"it is not ready within {START_TIMEOUT:g} s")
        key, timeout = self.limits.keys[0], self.limits.timeout
        who = self.place.who()
        where = f"{who} did not return {self.place.when()}".rstrip() if who else ""
        text = f"no result within `{key}` = `{timeout:g}` s"
        return WorkerError("timeout", f"{text}: {where}" if where else text, AGAIN.format(key))

    def too_much(self, used: float) -> WorkerError:
        """End a process that took too much memory; returns the error."""
        self.kill()
        assert self.limits.memory is not None
        key, memory = self.limits.keys[1], self.limits.memory / 1e6
        text = f"`{used / 1e6:.0f}` MB of memory are more than `{key}` = `{memory:g}` MB"
        who = self.place.who()
        return WorkerError("memory", f"{text}, {who} took them {self.place.when()}".rstrip() if who else text)

    def crashed(self, child: Child) -> WorkerError:
        """Error that tells how the process ended, what it was doing and what it said last."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.process.wait(1.0)
        how = ending(child.process.poll())
        self.kill()
        said = last_line(child.output) if child.output else ""
        how += f"; its last words: {said}" if said else ""
        if not child.ready:
            raise no_start(how)
        who = self.place.who() or "the worker process"
        return WorkerError("crashed", f"{who} crashed {self.place.when()}".rstrip() + f": {how}")

    def kill(self) -> None:
        """End the process, and what it may have started, at once."""
        if self.child is not None and self.child.process.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.child.process.pid, signal.SIGKILL)
            self.child.process.wait()

    def release(self) -> None:
        """Give back what belonged to a process that is gone."""
        child, self.child = self.child, None
        if child is not None:
            child.process.wait()
            child.channel.close()
            if child.output:
                child.output.close()

    def stop(self) -> None:
        """End the process; a `call` under way in another thread returns, and no other begins."""
        with self.lock:
            self.closed = True
            self.kill()

    def close(self) -> None:
        """End the process and give back what belonged to it; no `call` is under way any more."""
        self.stop()
        self.release()
        if self.page >= 0:
            os.close(self.page)
            self.page = -1


def ending(code: int | None) -> str:
    """How a process ended, from its code as subprocess gives it; None is alive."""
    if code is None:
        return "it does not answer"
    if code >= 0:
        return f"it ended the process with exit code {code}"
    try:
        return f"killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"killed by signal {-code}"


def no_start(how: str) -> CosimError:
    """Error of a process that does not come up."""
    hint = f"it runs `{sys.executable}`, which must find the package `cosim`"
    return CosimError(f"a worker process does not start: {how}", hint)


def last_line(output: IO[bytes]) -> str:
    """Last line of a file that is not empty."""
    output.seek(-min(output.seek(0, os.SEEK_END), 4 * LONGEST_OUTPUT), os.SEEK_END)
    lines = output.read().decode(errors="replace").split("\n")
    return next((line.strip()[:LONGEST_OUTPUT] for line in reversed(lines) if line.strip()), "")


def resident(child: Child) -> int:
    """Resident memory of a process, bytes; 0 where it is gone."""
    try:
        return int(memory_of(child.process.pid).rss)
    except Exception:  # psutil says with an exception of its own that it is gone
        return 0
