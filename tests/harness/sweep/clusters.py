"""Dask on loopback, open or over TLS."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from distributed import Client

from . import studies

START_TIMEOUT = 120.0
"""Time for all workers to join their scheduler, s."""


class Cluster:
    """Scheduler and workers of one thread each, on a port that stays the same.

    A nanny restarts its worker when that was killed.
    """

    def __init__(
        self, folder: Path, scheme: str = "tcp", options: Sequence[str] = (), nanny: bool = True
    ) -> None:
        self.folder, self.scheme, self.options, self.nanny = folder, scheme, options, nanny
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.address = f"{scheme}://127.0.0.1:{self.port}"
        self.log = folder / "log"
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self, workers: int = 2) -> None:
        """Start scheduler and workers, if they are not running."""
        if self.processes:
            return
        self.log.unlink(missing_ok=True)
        host = f"{self.scheme}://127.0.0.1"
        self.run("scheduler", "--host", host, "--port", str(self.port))
        for _ in range(workers):
            threads = ["--nthreads", "1", "--nworkers", "1", "--local-directory", str(self.folder)]
            nanny = "--nanny" if self.nanny else "--no-nanny"
            self.run("worker", self.address, "--host", "127.0.0.1", nanny, *threads)
        self.wait_for_workers(workers)

    def wait_for_workers(self, count: int) -> None:
        """Wait until the scheduler knows that many: a starting worker can be neither lost nor ended."""
        end = time.monotonic() + START_TIMEOUT
        while self.log.read_text().count("Registered to:") < count:
            if time.monotonic() > end:
                pytest.fail(f"no {count} workers after {START_TIMEOUT} s:\n{self.log.read_text()}")
            time.sleep(0.05)

    def run(self, *command: str) -> None:
        """Start one process."""
        environment = {**os.environ, "PYTHONPATH": str(studies.ROOT)}
        with self.log.open("a") as log:
            line = [sys.executable, "-m", "dask", *command, "--no-dashboard", *self.options]
            self.processes.append(
                subprocess.Popen(line, stdout=log, stderr=log, env=environment, cwd=self.folder)
            )

    def kill_worker(self) -> None:
        """Kill a worker that has no nanny while runs lie with it."""
        worker = self.processes[-1]
        with Client(self.address) as client:  # type: ignore[no-untyped-call]
            (address,) = (name for name, pid in client.run(os.getpid).items() if pid == worker.pid)
            end = time.monotonic() + START_TIMEOUT
            while True:
                worker.send_signal(signal.SIGSTOP)
                # its results are reported, and new runs are sent, or all with another worker
                time.sleep(1.0)
                if client.processing().get(address):
                    break
                worker.send_signal(signal.SIGCONT)
                if time.monotonic() > end:
                    pytest.fail(f"no run lay with the worker `{address}` for {START_TIMEOUT} s")
                time.sleep(0.1)
        worker.kill()

    def restart(self, workers: int) -> None:
        """Kill the scheduler, with which its workers end, and restart all."""
        self.processes[0].kill()
        for process in self.processes:
            process.wait(60)
        self.processes.clear()
        self.start(workers)

    def stop(self) -> None:
        """End all, the scheduler last: a worker that is ended twice at a time may hang in Dask."""
        for process in reversed(self.processes):
            process.terminate()
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
