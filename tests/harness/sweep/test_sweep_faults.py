"""Whatever goes wrong in a run of a sweep costs that run's row and no other."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import psutil
import pytest

import cosim

from ..conftest import DATA, SCENARIO
from . import studies

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="signals and limits of Linux")
WORKERS = ("--workers", "2")

FAULTS = {
    "controller.gain = 0.1": ("passed", ""),
    "controller.crash_at = 3": ("crashed", "killed by SIGSEGV; its last output: about to write to nowhere"),
    "controller.gain = 0.2": ("passed", ""),
    "controller.hang_at = 3": ("timeout", "no result within `limits.timeout` = `4` s"),
    "controller.fail_at = 3": ("error", "failed on request at 0.003 s (fmi2DoStep returned fmi2Error)"),
    "controller.fatal_at = 3": ("error", "(fmi2DoStep returned fmi2Fatal)"),
    "controller.eat_at = 3": ("memory", "are more than `limits.memory` = `500` MB"),
    "controller.gain = 0.3": ("passed", ""),
    "plant.fail_at = 3": ("error", "RuntimeError: failed on request"),
    "controller.nan_at = 3": ("error", "must be finite at t = 0.003 s (step 3)"),
    "controller.gain = 0.4": ("passed", ""),
}
"""Cases of the lag, and what becomes of them."""
RUNS = 100_000
MANY = f"""
scenario = "lag.toml"
vary = [{{key = "plant.pole", minimum = 0.1, maximum = 0.9}}]

[design]
kind = "monte-carlo"
samples = {RUNS}

[traces]
failed = 0
"""
MAX_PER_RUN = 1000.0
"""Memory of the command for each run, bytes: the position of its row, and its cells in the table."""
LIMITS = "timeout = 4.0\nmemory = 500.0"


def test_each_fault_costs_its_own_row_with_a_reason(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    (folder / "faults.toml").write_text(studies.case_list(list(FAULTS), LIMITS))
    done = studies.sweep("faults.toml", "--quiet", *WORKERS)
    rows = studies.rows(folder / "faults.sweep")
    found = {text: (row["status"], row["reason"]) for text, row in zip(FAULTS, rows, strict=True)}
    for text, (status, reason) in FAULTS.items():
        assert found[text][0] == status, found[text]
        assert reason in found[text][1]
    assert done.returncode == 1
    # on a slow machine a line now and then
    assert all(line.startswith("faults: ") for line in done.stderr.splitlines())
    assert "11 of 11 runs: 4 passed" in done.stdout

    check_numbers(rows)


def test_what_runs_log_gives_an_error_with_the_run(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    (folder / "odd.toml").write_text(studies.case_list(["controller.gain = 0.3", "controller.warn_at = 3"]))
    done = studies.sweep("odd.toml", *WORKERS)
    reported = r"warning: run 1, seed [0-9]+: .*something is odd at 0\.003 s"
    assert re.search(reported, done.stderr), done.stderr


def test_an_error_of_mujoco_costs_its_own_row(write: Write, folder: Path) -> None:
    (folder / "breakable.py").write_text((DATA / "breakable.py").read_text())
    text = SCENARIO.replace("probe_plants:Lag", "breakable:Breakable").replace("plant.x", "plant.position")
    write(
        text=text.replace("plant.u", "plant.current").replace("step = 0.001", "step = 0.0001\nsubsteps = 2")
    )
    cases = ["plant.broken = 0.0", "plant.broken = 1.0", "plant.stiffness = 1e6"]
    (folder / "broken.toml").write_text(studies.case_list(cases))
    studies.sweep("broken.toml", *WORKERS)
    passed, failed, also_passed = studies.rows(folder / "broken.sweep")
    assert (passed["status"], also_passed["status"]) == ("done", "done")
    assert failed["status"] == "error"
    assert "unknown joint type 99" in failed["reason"]


def test_kill_9_of_a_worker_loses_no_run(write: Write, folder: Path) -> None:
    process, worker = stalled(write, folder)
    os.kill(worker, signal.SIGKILL)
    assert process.wait(60) == 0
    rows = studies.rows(folder / "kill.sweep")
    assert [row["status"] for row in rows] == ["passed"] * 5
    check_numbers(rows)


def test_what_a_run_does_to_its_process_falls_on_no_other(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    cases = ["controller.spoil_at = 3", *[f"controller.gain = 0.{k}" for k in range(1, 5)]]
    (folder / "spoilt.toml").write_text(studies.case_list(cases))
    assert studies.sweep("spoilt.toml", *WORKERS).returncode == 0
    rows = studies.rows(folder / "spoilt.sweep")
    assert [row["status"] for row in rows] == ["passed"] * 5
    check_numbers(rows)


def test_each_run_may_have_a_process_of_its_own(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    shutil.copy(DATA / "counting.py", folder / "counting.py")
    cases = [f'controller.gain = 0.{k}\nplant.name = "counting:Counting"' for k in range(1, 5)]
    # in one process the first run is repeated before the second
    for text, processes, runs in (("process_per_run = true", 4, 4), ("", 1, 5)):
        (folder / "own.toml").write_text(studies.case_list(cases, text))
        assert studies.sweep("own.toml", "--workers", "1", "--out", f"own-{processes}").returncode == 0
        seen = (folder / "processes").read_text().split()
        assert (len(seen), len(set(seen))) == (runs, processes)
        (folder / "processes").unlink()


def test_a_signal_without_a_name_costs_its_own_row(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    cases = ["controller.raise_at = 3\ncontroller.raised = 40", "controller.gain = 0.1"]
    (folder / "signal.toml").write_text(studies.case_list(cases))
    studies.sweep("signal.toml", *WORKERS)
    crashed, passed = studies.rows(folder / "signal.sweep")
    assert (crashed["status"], passed["status"]) == ("crashed", "passed")
    assert "the FMU `probe` crashed at t = 0.003 s (step 3): killed by signal 40" in crashed["reason"]


def test_too_little_memory_for_any_run_is_reported(write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    (folder / "small.toml").write_text(studies.case_list(["controller.gain = 0.1"], "memory = 1.0"))
    studies.sweep("small.toml")
    (row,) = studies.rows(folder / "small.sweep")
    assert row["status"] == "memory"
    assert "exceed its limit of `1` MB" in row["reason"]


@pytest.mark.full
def test_the_memory_of_a_long_sweep_is_bounded(write: Write, folder: Path) -> None:
    write(studies.MEASURED, text=SCENARIO.replace("duration = 0.05", "duration = 0.005"))
    (folder / "many.toml").write_text(MANY)
    command = [sys.executable, "-m", "cosim", "sweep", "many.toml", "--no-plots", *WORKERS]
    process = subprocess.Popen(command, env=studies.environment(), stdout=subprocess.DEVNULL)
    results, memory = folder / "many.sweep" / "results.jsonl", {}
    while process.poll() is None:
        with contextlib.suppress(FileNotFoundError, psutil.NoSuchProcess):
            memory[results.read_bytes().count(b"\n")] = psutil.Process(process.pid).memory_info().rss
        time.sleep(1.0)
    assert sorted(row["run"] for row in studies.rows(folder / "many.sweep")) == list(range(RUNS))
    # the tables at the end need the memory of all rows
    going = [used for rows, used in memory.items() if RUNS // 10 < rows < RUNS]
    assert max(going) - going[0] < 30e6 + MAX_PER_RUN * RUNS


def stalled(write: Write, folder: Path) -> tuple[subprocess.Popen[bytes], int]:
    """Start a sweep whose second run stalls; return it and the process of the run."""
    write(studies.MEASURED)
    cases = ["plant.pole = 0.1", "plant.stall_at = 3", *[f"plant.pole = 0.{k}" for k in range(2, 5)]]
    (folder / "kill.toml").write_text(studies.case_list(cases))
    command = [sys.executable, "-m", "cosim", "sweep", "kill.toml", "--no-plots", *WORKERS]
    environment = {**os.environ, "PYTHONPATH": str(studies.ROOT)}
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL)
    results = folder / "kill.sweep" / "results.jsonl"
    studies.wait_for(lambda: results.exists() and results.read_bytes().count(b"\n") == 4)
    studies.wait_for((folder / "stalled").exists)
    worker, _ = (folder / "stalled").read_text().split()
    return process, int(worker)


def check_numbers(rows: list[dict[str, Any]]) -> None:
    """Check that runs that passed have the numbers of single runs that nothing befell."""
    passed = [row for row in rows if row["status"] == "passed"]
    assert len(passed) >= 4
    for row in passed:
        # stalling changes no number
        changes = [f"{key}={value}" for key, value in row["set"].items() if key != "plant.stall_at"]
        single = cosim.run(cosim.load("lag.toml", changes), row["seed"])
        assert row["metrics"] == {"end": single.metrics["end"].value}
