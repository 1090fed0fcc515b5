"""A worker process from the view of its supervisor: start, messages, kill."""

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
"""Maximum length of the last output of a worker process."""
COMMAND = "import gc; gc.disable(); from cosim.pool.worker import main; main({}, {}, {})"
"""Program of a worker process; imports leave no garbage worth collecting."""


@dataclass
class Child:
    """A worker process that was started.

    Parameters
    ----------
    output
        Its output; None if it goes to stderr of this process.
    memory
        Memory limit of the operating system in bytes, or None; sent with its first task.
    tasks
        Number of tasks sent to it.
    busy
        Whether its last task is unfinished.
    spoilt
        Whether a run changed it so that later results may differ.
    said
        The last line that it logged.
    offspring
        Processes that it started, as far as known.
    killed
        Whether it and all its child processes were killed.
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
        """Kill it and its child processes."""
        # once: what it started may outlive it, but the number is not its own for ever
        if not self.killed:
            self.killed = True
            self.note_offspring()
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self.process.pid, signal.SIGKILL)
            for process in self.offspring:
                with contextlib.suppress(Exception):  # psutil raises its own exception if it is gone
                    process.kill()
            self.process.wait()

    def note_offspring(self) -> None:
        """Record child processes outside of its process group while it is alive."""
        with contextlib.suppress(Exception):  # psutil raises its own exception if it is gone
            self.offspring += process_of(self.process.pid).children(recursive=True)

    def release(self) -> None:
        """Release its resources after its end."""
        self.process.wait()
        self.channel.close()
        if self.output:
            self.output.close()

    def last_output(self) -> str:
        """Last line that it printed or logged; empty if its output goes to stderr."""
        if self.output is None:
            return ""
        self.output.seek(-min(self.output.seek(0, os.SEEK_END), 4 * LONGEST_OUTPUT), os.SEEK_END)
        lines = self.output.read().decode(errors="replace").split("\n")
        printed = next((line.strip() for line in reversed(lines) if line.strip()), "")
        return (printed or self.said)[:LONGEST_OUTPUT]

    def resident(self) -> int:
        """Resident memory, bytes; 0 after its end."""
        try:
            return int(memory_of(self.process.pid).rss)
        except Exception:  # psutil raises its own exception if it is gone
            return 0


def spawn(page: int, relay: bool) -> Child:
    """Start a worker process.

    Parameters
    ----------
    page
        Descriptor of the file in which it records its position.
    relay
        Whether its output goes to stderr of this process.
    """
    ours, theirs = socket.socketpair()
    # it lives as long as the process
    output = None if relay else tempfile.TemporaryFile("a+b")  # noqa: SIM115
    with theirs:
        # `-P`: a `numpy.py` in the working directory does not replace the package
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
    """Return the description of the end of a process from its return code; None if it is alive."""
    if code is None:
        return "it does not answer"
    if code >= 0:
        return f"it ended the process with exit code {code}"
    try:
        return f"killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"killed by signal {-code}"


def no_start(how: str) -> CosimError:
    """Error of a process that does not start."""
    hint = f"Check that `{sys.executable}` can import the package `cosim`."
    return CosimError(f"a worker process does not start: {how}", hint)
