"""A worker process from the view of its supervisor: start, messages, kill."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from cosim.errors import CosimError
from cosim.loop.position import PAGE, Position
from cosim.pool.channel import Frame, MessageChannel, NoMessageError
from cosim.process import POSIX

LONGEST_OUTPUT = 300
"""Maximum length of the last output of a worker process."""
TAIL = 4 * LONGEST_OUTPUT
"""Bytes that are kept of the output of a worker process."""
LAST_OUTPUT = 0.5
"""Maximum time for the last output of an ended process, s: its child processes may keep the pipe open."""
COMMAND = (
    "import gc, sys; gc.disable(); sys.path[:] = {!r}; from cosim.pool.worker import main; main({!r}, {})"
)
"""Program of a worker process; imports leave no garbage worth collecting."""
GROUP = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)
"""Flag of Windows, equivalent to a session of POSIX: only the parent handles Ctrl-C."""
EXCEPTIONS = {0xC0000005: "access violation", 0xC0000094: "division by zero", 0xC00000FD: "stack overflow"}
"""Exit codes of Windows."""


def process_of(number: int) -> Any:
    """Process by number for psutil, whose import is slow."""
    import psutil

    return psutil.Process(number)


class Output:
    """The end of what a process prints, read in a thread so that it fills neither a pipe nor a disk."""

    def __init__(self, pipe: IO[bytes]) -> None:
        self.pipe = pipe
        self.kept = b""
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self) -> None:
        while chunk := os.read(self.pipe.fileno(), 1 << 16):
            self.kept = (self.kept + chunk)[-TAIL:]
        self.pipe.close()

    def last_line(self) -> str:
        """Last line of an ended process; empty if there is none."""
        self.thread.join(LAST_OUTPUT)
        lines = self.kept.decode(errors="replace").split("\n")
        return next((line.strip() for line in reversed(lines) if line.strip()), "")


@dataclass
class WorkerHandle:
    """A worker process that was started."""

    process: subprocess.Popen[bytes]
    channel: MessageChannel
    output: Output | None
    """The end of its output; None if it goes to stderr of this process."""
    position: Position
    page: Path
    """File in which it records its `position`."""
    memory: float | None = None
    """Memory limit of the operating system in bytes, or None; sent with its first task."""
    pid: int = 0
    """Process that executes Python, by its own account; 0 until its imports are done."""
    tasks: int = 0
    """Number of tasks sent to it."""
    busy: bool = False
    """Whether its last task is unfinished."""
    spoilt: bool = False
    """Whether a run changed it so that later results may differ."""
    last_log: str = ""
    children: list[Any] = field(default_factory=list)
    """Processes that it started, as far as known."""
    killed: bool = False
    """Whether it and all its child processes were killed."""
    received: queue.SimpleQueue[Frame | BaseException] = field(default_factory=queue.SimpleQueue)

    def __post_init__(self) -> None:
        """Receive in a thread: Windows cannot wait for a pipe with a timeout."""
        self.thread = threading.Thread(target=self._listen, daemon=True)
        self.thread.start()

    def _listen(self) -> None:
        try:
            while True:
                self.received.put(self.channel.receive())
        except (EOFError, OSError, ValueError, MemoryError, NoMessageError) as error:
            # without it the supervisor would wait forever
            self.received.put(error)

    def receive(self, timeout: float) -> Frame | None:
        """Next message, None after a timeout in s; raises the errors of `MessageChannel.receive`."""
        try:
            found = self.received.get(timeout=timeout)
        except queue.Empty:
            return None
        if isinstance(found, BaseException):
            self.received.put(found)
            raise found
        return found

    def kill(self) -> None:
        """Kill it and its child processes."""
        # only once: its number may belong to another process later
        if not self.killed:
            self.killed = True
            self.note_children()
            if POSIX:
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.killpg(self.process.pid, signal.SIGKILL)
            self.process.kill()
            for process in self.children:
                with contextlib.suppress(Exception):  # psutil raises its own exception if it is gone
                    process.kill()
            self.process.wait()

    def note_children(self) -> None:
        """Record child processes outside of its process group while it is alive."""
        with contextlib.suppress(Exception):  # psutil raises its own exception if it is gone
            self.children += process_of(self.process.pid).children(recursive=True)

    def release(self) -> None:
        """Release its resources after `kill`."""
        self.thread.join(LAST_OUTPUT)
        if not self.thread.is_alive():
            # a pipe that a thread reads cannot be closed
            self.channel.close()
        self.position.detach()
        with contextlib.suppress(OSError):
            self.page.unlink(missing_ok=True)

    def where(self, who: str, did: str = "") -> str:
        """Return what an FMU or plant did, and when; empty if there is none."""
        return " ".join(filter(None, (who, did, self.position.when()))) if who else ""

    def last_output(self) -> str:
        """Last line that it printed or logged; empty if its output goes to stderr."""
        if self.output is None:
            return ""
        return (self.output.last_line() or self.last_log)[:LONGEST_OUTPUT]

    def resident(self) -> int:
        """Resident memory, bytes; 0 after its end."""
        try:
            # in a virtual environment of Windows the started process only starts another one
            return int(process_of(self.pid or self.process.pid).memory_info().rss)
        except Exception:  # psutil raises its own exception if it is gone
            return 0


def spawn(relay: bool) -> WorkerHandle:
    """Start a worker process; with `relay` its output goes to stderr of this process.

    Raises CosimError if the system starts no more processes.
    """
    page = Path()
    try:
        with tempfile.NamedTemporaryFile(prefix="cosim-", delete=False) as file:
            page = Path(file.name)
            file.write(bytes(PAGE))
        position = Position(page)
        # `-P`: a `numpy.py` in the working directory does not replace the package; the environment is that of
        # the user, because a run may start another Python, without variables that C code of a run set here
        command = COMMAND.format([*map(os.path.abspath, sys.path)], str(page), os.getpid())
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=None if relay else subprocess.PIPE,
            env=dict(os.environ),
            start_new_session=POSIX,
            creationflags=GROUP,
        )
    except OSError as error:
        if page.name:
            page.unlink(missing_ok=True)
        problem = f"a worker process cannot be started: {error.strerror or error}"
        raise CosimError(problem, "Use fewer `--workers`, or raise the limits of the system.") from error
    # psutil is imported while the process starts, and needed where that ends
    process_of(process.pid)
    assert process.stdin is not None
    assert process.stdout is not None
    channel = MessageChannel(process.stdout, process.stdin)  # type: ignore[arg-type]
    return WorkerHandle(process, channel, Output(process.stderr) if process.stderr else None, position, page)


def ending(code: int | None) -> str:
    """Return the description of the end of a process from its return code; None if it is alive."""
    if code is None:
        return "it does not answer"
    if code >= min(EXCEPTIONS):
        return f"killed by exception 0x{code:08X} ({EXCEPTIONS.get(code, 'see NTSTATUS')})"
    if code >= 0:
        return f"it ended the process with exit code {code}"
    try:
        return f"killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"killed by signal {-code}"
