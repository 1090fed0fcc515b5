"""`cosim run` as a process that can be interrupted, and what is left of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import IO

import psutil

File = int | IO[str]
ROOT = Path(__file__).resolve().parents[3]
STEPS = "--duration=1000"
"""A run without a waiting caller."""


def finished(*arguments: str, path: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run `cosim run lag.toml` with these arguments; nothing that outlives it is waited for."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        process = started(*arguments, path=path, stdout=out, stderr=err)
        try:
            status = process.wait(timeout=100.0)
        finally:
            process.kill()
        texts = [(file.seek(0), file.read())[1] for file in (out, err)]
    return subprocess.CompletedProcess(arguments, status, *texts)


def started(
    *arguments: str,
    path: Path = ROOT,
    command: tuple[str, ...] = ("run", "lag.toml"),
    stdout: File = subprocess.PIPE,
    stderr: File = subprocess.PIPE,
) -> subprocess.Popen[str]:
    """Start `cosim run lag.toml` with these arguments; modules are looked for in `path` as well."""
    return subprocess.Popen(
        [sys.executable, "-m", "cosim", *command, *arguments],
        stdout=stdout,
        stderr=stderr,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (path, ROOT)))},
        # a shell that starts the tests in the background lets them ignore the signal
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def interrupted(
    process: subprocess.Popen[str], presses: int = 1, number: int = signal.SIGINT
) -> tuple[str, str]:
    """Press Ctrl-C, or send another signal; return stdout and stderr when no process is left."""
    family = [psutil.Process(process.pid), *psutil.Process(process.pid).children(recursive=True)]
    for press in range(presses):
        # two signals that wait are one
        time.sleep(1.0 if press else 0.0)
        process.send_signal(number)
    try:
        stdout, stderr = process.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        # nothing waits for ever, `with` included
        process.kill()
        raise
    _, alive = psutil.wait_procs(family, timeout=60)
    assert not alive
    return stdout, stderr


def wait_for_line(process: subprocess.Popen[str], text: str) -> None:
    """Read stderr until a line holds the text; a process that never writes it is ended."""
    assert process.stderr is not None
    with_end = threading.Timer(60.0, process.kill)
    with_end.start()
    try:
        assert any(text in line for line in process.stderr), f"`{text}` did not come"
    finally:
        with_end.cancel()
