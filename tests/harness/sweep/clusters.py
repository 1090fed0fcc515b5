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


class Cluster:
    """Scheduler and workers of one thread each, on a port that stays the same.

    A nanny starts its worker anew when that was killed.
    """

    def __init__(
        self, folder: Path, scheme: str = "tcp", options: Sequence[str] = (), nanny: bool = True
    ) -> None:
        self.folder, self.scheme, self.options, self.nanny = folder, scheme, options, nanny
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.address = f"{scheme}://127.0.0.1:{self.port}"
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self, workers: int = 2) -> None:
        """Start scheduler and workers, if they are not running."""
        if self.processes:
            return
        host = f"{self.scheme}://127.0.0.1"
        self.run("scheduler", "--host", host, "--port", str(self.port))
        for _ in range(workers):
            threads = ["--nthreads", "1", "--nworkers", "1", "--local-directory", str(self.folder)]
            nanny = "--nanny" if self.nanny else "--no-nanny"
            self.run("worker", self.address, "--host", "127.0.0.1", nanny, *threads)

    def run(self, *command: str) -> None:
        """Start one process."""
        environment = {**os.environ, "PYTHONPATH": str(studies.ROOT)}
        with (self.folder / "log").open("a") as log:
            line = [sys.executable, "-m", "dask", *command, "--no-dashboard", *self.options]
            self.processes.append(
                subprocess.Popen(line, stdout=log, stderr=log, env=environment, cwd=self.folder)
            )

    def kill_worker(self) -> None:
        """Kill a worker that has no nanny."""
        self.processes[-1].kill()

    def restart(self, workers: int) -> None:
        """Kill the scheduler, with which its workers end, and start all anew."""
        self.processes[0].kill()
        for process in self.processes:
            process.wait(60)
        self.processes.clear()
        self.start(workers)

    def stop(self) -> None:
        """End all."""
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            process.wait(30)
        self.processes.clear()


@contextlib.contextmanager
def running(
    folder: Path, scheme: str = "tcp", options: Sequence[str] = (), nanny: bool = True
) -> Iterator[Cluster]:
    """Cluster that ends with the block."""
    cluster = Cluster(folder, scheme, options, nanny)
    try:
        cluster.start()
        yield cluster
    finally:
        cluster.stop()
