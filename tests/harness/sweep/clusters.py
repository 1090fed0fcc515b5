"""Dask on loopback, open or over TLS."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from . import studies


@contextlib.contextmanager
def running(folder: Path, scheme: str = "tcp", options: Sequence[str] = ()) -> Iterator[str]:
    """Scheduler and two workers of one thread each; gives the scheduler's address."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"{scheme}://127.0.0.1:{port}"
    common = ["--no-dashboard", *options]
    commands = [["scheduler", "--host", f"{scheme}://127.0.0.1", *common, "--port", str(port)]]
    threads = ["--nthreads", "1", "--nworkers", "1", "--local-directory", str(folder)]
    commands += [["worker", address, "--host", "127.0.0.1", *common, *threads] for _ in range(2)]
    environment = {**os.environ, "PYTHONPATH": str(studies.ROOT)}
    with (folder / "log").open("w") as log:
        processes = [
            subprocess.Popen(
                [sys.executable, "-m", "dask", *command], stdout=log, stderr=log, env=environment, cwd=folder
            )
            for command in commands
        ]
    try:
        yield address
    finally:
        for process in reversed(processes):
            process.terminate()
        for process in processes:
            process.wait(30)
