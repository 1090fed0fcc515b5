"""A sweep repeats runs of lost Dask workers, waits for a lost scheduler, and resumes without a cluster."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from distributed.comm.core import CommClosedError

import cosim
from cosim.errors import CosimError
from cosim.pool.batches import MAX_RUNS, Batches
from cosim.pool.cluster import SchedulerLostError, reported_by
from cosim.pool.job import Job
from cosim.study.store import Store

from ..conftest import SCENARIO
from . import clusters, studies

Write = Callable[..., Path]

PLANT = """
import time
import probe_plants


class Slow(probe_plants.Lag):
    def reset(self, *arguments):
        time.sleep({})
        super().reset(*arguments)
"""
SAME = """
scenario = "lag.toml"
case = [{plant.pole = 0.5}]

[design]
kind = "list"
repeats = 400
"""
VARIED = """
scenario = "lag.toml"
vary = [{key = "plant.pole", minimum = 0.1, maximum = 0.9}]

[design]
kind = "monte-carlo"
samples = 100_000

[traces]
failed = 0
"""
PATIENCE = 300.0
"""Time without a new row after which nothing more is expected, s."""
MAX_PER_RUN = 1000.0
"""Memory of the command for each run, bytes: where its row is, and its cells in the table."""


class Sweep:
    """The command on a cluster, its rows and its memory."""

    def __init__(self, folder: Path, address: str) -> None:
        self.results = folder / "many.sweep" / "results.jsonl"
        command = [sys.executable, "-m", "cosim", "sweep", "many.toml", "--no-plots", "--cluster", address]
        self.began = time.monotonic()
        self.process = subprocess.Popen(
            command, env=studies.environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        self.memory: list[tuple[int, int]] = []
        self.count, self.place = 0, 0

    def wait_for(self, rows: int) -> None:
        """Wait for a number of rows or the end; records the memory about once a second."""
        moved, looked = time.monotonic(), 0.0
        while self.count < rows and self.process.poll() is None:
            now = time.monotonic()
            if found := self.new_rows():
                moved, self.count = now, self.count + found
            if now > looked + 1.0:
                looked = now
                self.memory.append((self.count, psutil.Process(self.process.pid).memory_info().rss))
            if now > moved + PATIENCE:
                self.process.kill()
                pytest.fail(f"no row after the first {self.count} for {PATIENCE} s")
            time.sleep(0.05)

    def new_rows(self) -> int:
        """Count the rows that came since the last look."""
        if not self.results.exists():
            return 0
        with self.results.open("rb") as file:
            file.seek(self.place)
            text = file.read()
        self.place += len(text)
        return text.count(b"\n")

    def wait(self) -> str:
        """Wait for the end; returns what it said on stderr."""
        self.wait_for(sys.maxsize)
        return self.process.communicate()[1]


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[clusters.Cluster]:
    """Scheduler and two workers."""
    with clusters.running(tmp_path_factory.mktemp("dask"), nanny=False) as found:
        yield found


# the second is what is measured: `pytest -m full -s tests/harness/sweep/test_losses.py`
@pytest.mark.skipif(sys.platform != "linux", reason="signals of Linux")
@pytest.mark.parametrize(
    ("runs", "study", "pause", "workers"),
    [(400, SAME, 0.02, 1), pytest.param(100_000, VARIED, 0.0, 2, marks=pytest.mark.full)],
)
def test_a_sweep_survives_a_killed_worker_and_a_restarted_scheduler(
    runs: int, study: str, pause: float, workers: int, write: Write, folder: Path, cluster: clusters.Cluster
) -> None:
    text = SCENARIO.replace("duration = 0.05", "duration = 0.005").replace("probe_plants:Lag", "slow:Slow")
    write(studies.MEASURED, text=text)
    (folder / "slow.py").write_text(PLANT.format(pause))
    (folder / "many.toml").write_text(study)
    cluster.start()
    sweep = Sweep(folder, cluster.address)
    sweep.wait_for(runs // 5)
    cluster.kill_worker()
    sweep.wait_for(2 * runs // 5)
    cluster.restart(workers)
    reported = sweep.wait()
    lines = sweep.results.read_text().splitlines()
    print(report(sweep, len(lines)))

    assert re.search("the Dask worker `tcp://127.0.0.1:[0-9]+` was lost: [0-9]+ runs are repeated", reported)
    assert "lost the Dask scheduler; waiting 300 s for its return" in reported
    assert "the Dask scheduler is available again" in reported
    rows = [json.loads(line) for line in lines]
    assert sorted(row["run"] for row in rows) == list(range(runs))
    assert len({row["hash"] for row in rows}) == runs
    assert {row["status"] for row in rows} == {"passed", "failed"}
    for row in rows[:: runs // 5]:
        single = cosim.run(cosim.load("lag.toml", [f"plant.pole={row['set']['plant.pole']}"]), row["seed"])
        assert row["metrics"] == {"end": single.metrics["end"].value}
    # the tables at the end are of the whole
    going = [memory for rows, memory in sweep.memory if runs // 10 < rows < runs]
    assert max(going) - going[0] < 30e6 + MAX_PER_RUN * runs


def report(sweep: Sweep, rows: int) -> str:
    """Numbers of a long sweep."""
    shown = [
        f"{count}: {memory / 1e6:.0f}" for count, memory in sweep.memory[:: len(sweep.memory) // 12 or 1]
    ]
    return f"{rows} rows after {time.monotonic() - sweep.began:.0f} s; rows and MB: {', '.join(shown)}"


def test_a_scheduler_that_does_not_return_is_reported_and_the_sweep_resumes(
    write: Write, folder: Path, cluster: clusters.Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    cluster.start()
    monkeypatch.setattr("cosim.pool.connection.RETURN_TIMEOUT", 0.0)
    monkeypatch.setattr("cosim.pool.connection.CONNECT_TIMEOUT", 5.0)
    write(studies.MEASURED)
    (folder / "grid.toml").write_text(studies.GRID)
    monkeypatch.setattr(Store, "append", stopping(Store.append, cluster.stop))
    with pytest.raises(
        CosimError, match="lost the Dask scheduler, which did not return within 0 s"
    ) as caught:
        cosim.sweep("grid.toml", cluster=cluster.address)
    assert caught.value.hint == "Run the same command again to continue."
    before = (folder / "grid.sweep" / "results.jsonl").read_text()
    assert 0 < len(before.splitlines()) < 12
    assert len(cosim.sweep("grid.toml", workers=1)) == 12
    assert (folder / "grid.sweep" / "results.jsonl").read_text().startswith(before)
    assert len(studies.rows(folder / "grid.sweep")) == 12


def stopping(append: Callable[..., None], stop: Callable[[], None]) -> Callable[..., None]:
    """Append that stops the cluster after the first row."""
    calls: list[None] = []

    def wrapped(*arguments: object) -> None:
        append(*arguments)
        if not calls:
            calls.append(None)
            stop()

    return wrapped


def test_a_connection_that_ends_while_outcomes_are_fetched_is_that_of_the_scheduler() -> None:
    def closed(timeout: float) -> None:
        raise CommClosedError("Stream is closed")

    link = SimpleNamespace(comm=SimpleNamespace(closed=lambda: False))
    client = SimpleNamespace(status="running", scheduler_comm=link)
    with pytest.raises(SchedulerLostError):
        reported_by(client, SimpleNamespace(cancelled=lambda: False, result=closed))


def jobs(count: int) -> Iterator[tuple[int, Job]]:
    """Numbered jobs, which the batches never look into."""
    scenario = cosim.load("dob")
    return ((number, Job(scenario, number)) for number in range(count))


def numbers(found: object) -> list[int]:
    """Their numbers."""
    return [number for number, _ in found]  # type: ignore[attr-defined]


DONE = CosimError("done")


def test_batches_grow_while_they_are_done_in_time_and_shrink_to_what_was() -> None:
    batches = Batches(jobs(1000))
    sizes = []
    for _ in range(9):
        batch = batches.take()
        sizes.append(len(batch))
        assert numbers(batches.finish(batch, [DONE] * len(batch))) == numbers(batch)
    assert sizes == [1, 2, 4, 8, 16, 32, 64, MAX_RUNS, MAX_RUNS]
    batch = batches.take()
    assert numbers(batches.finish(batch, [DONE] * 3)) == numbers(batch)[:3]
    assert numbers(batches.take()) == numbers(batch)[3:6]


def test_runs_of_a_lost_worker_are_done_once_more_alone() -> None:
    batches = Batches(jobs(6))
    batches.size = 4
    batch = batches.take()
    assert batches.lose(batch, "w") == []
    first, second = batches.take(), batches.take()
    assert numbers(first + second) == [0, 1]
    # the scheduler is lost, of these runs nothing is known
    batches.put_back(second)
    ((number, outcome),) = batches.lose(first, "w")
    assert (number, getattr(outcome, "status", "")) == (0, "lost")
    rest = [batches.take() for _ in range(5)]
    assert list(map(numbers, rest)) == [[1], [2], [3], [4, 5], []]
