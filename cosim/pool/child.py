"""A worker process as the process that watches over it has it: started, listened to, killed."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from typing import IO, Any

from cosim.errors import CosimError
from cosim.pool.channel import MessageChannel
from cosim.pool.limits import memory_of, process_of

LONGEST_OUTPUT = 300
"""Characters kept of what a worker process said last."""
COMMAND = "from cosim.pool.worker import main; main({}, {}, {})"


@dataclass
class Child:
    """A worker process that was started.

    Parameters
    ----------
    output
        What it prints, None where that goes to our stderr.
    memory
        Bytes that the operating system lets it have, None for any amount; told with its first task.
    tasks
        Tasks that it was given.
    busy
        Whether it has not answered the last of them.
    spoilt
        Whether a run changed it so that the next would not be as in a fresh one.
    said
        The last line that it logged.
    offspring
        Processes that it started, as far as they were noted.
    killed
        Whether it was killed, and all that it started.
    """

    process: subprocess.Popen[bytes]
    channel: MessageChannel
    output: IO[bytes] | None
    memory: float | None = None
    ready: bool = False
    tasks: int = 0
    busy: bool = False
    spoilt: bool = False
    said: str = ""
    offspring: list[Any] = field(default_factory=list)
    killed: bool = False

    def kill(self) -> None:
        """End it, and what it may have started, at once."""
        # once: what it started may outlive it, but the number is not its own for ever
        if not self.killed:
            self.killed = True
            self.note_offspring()
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self.process.pid, signal.SIGKILL)
            for process in self.offspring:
                with contextlib.suppress(Exception):  # psutil says with one of its own that it is gone
                    process.kill()
            self.process.wait()

    def note_offspring(self) -> None:
        """Note, while it lives, what left its group of processes and would be lost to sight with it."""
        with contextlib.suppress(Exception):  # psutil says with one of its own that it is gone
            self.offspring += process_of(self.process.pid).children(recursive=True)

    def release(self) -> None:
        """Give back what belonged to it; it is gone."""
        self.process.wait()
        self.channel.close()
        if self.output:
            self.output.close()

    def last_output(self) -> str:
        """Last line that it printed, or logged; empty if that went to our stderr."""
        if self.output is None:
            return ""
        self.output.seek(-min(self.output.seek(0, os.SEEK_END), 4 * LONGEST_OUTPUT), os.SEEK_END)
        lines = self.output.read().decode(errors="replace").split("\n")
        printed = next((line.strip() for line in reversed(lines) if line.strip()), "")
        return (printed or self.said)[:LONGEST_OUTPUT]

    def resident(self) -> int:
        """Resident memory, bytes; 0 where it is gone."""
        try:
            return int(memory_of(self.process.pid).rss)
        except Exception:  # psutil says with an exception of its own that it is gone
            return 0


def spawn(page: int, relay: bool) -> Child:
    """Start a worker process.

    Parameters
    ----------
    page
        Descriptor of the file in which it notes what it is doing.
    relay
        Whether what it prints goes to our stderr.
    """
    ours, theirs = socket.socketpair()
    # it lives as long as the process
    output = None if relay else tempfile.TemporaryFile("a+b")  # noqa: SIM115
    with theirs:
        # `-P`: a `numpy.py` of the user in the working directory is not taken for the package
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", COMMAND.format(theirs.fileno(), page, os.getpid())],
            stdin=subprocess.DEVNULL,
            stdout=output or 2,
            stderr=output,
            pass_fds=(theirs.fileno(), page),
            start_new_session=True,  # Ctrl-C is for the parent to handle
            env={**os.environ, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))},
        )
    # psutil is imported while the process starts, and needed where that ends
    process_of(process.pid)
    return Child(process, MessageChannel(ours), output)


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
