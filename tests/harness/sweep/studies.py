"""Studies for the tests of sweeps: the lag with a noisy metric, and how to read what a sweep leaves."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[3]

MEASURED = """
noise = 0.1

[[metric]]
name = "end"
unit = "m"
value = "last(plant.x) + last(plant.random)"

[[criterion]]
id = "end"
claim = "ends low"
metric = "end"
maximum = 1.5
"""
"""Ends the lag scenario: noise on its last wire, a metric and a criterion."""

GRID = """
scenario = "lag.toml"
vary = [
    {key = "controller.gain", values = [0.2, 0.4]},
    {key = "plant.pole", minimum = 0.1, maximum = 0.9, points = 3},
]

[design]
kind = "grid"
repeats = 2
"""
"""Twelve runs of the lag."""


def environment(**more: str) -> dict[str, str]:
    """Environment in which `cosim` is found from any folder."""
    return {**os.environ, "PYTHONPATH": str(ROOT), **more}


def sweep(study: str, *options: str, **more: str) -> subprocess.CompletedProcess[str]:
    """Run `cosim sweep` in the working directory; with one worker by default, because the runs are short."""
    where = () if "--workers" in options else ("--workers", "1")
    command = [sys.executable, "-m", "cosim", "sweep", study, "--no-plots", *where, *options]
    env = environment(**more)
    done = subprocess.run(command, capture_output=True, text=True, env=env, check=False, timeout=120)
    # the runs of each sweep of the lag warn once that its plant is no native code
    done.stderr = re.sub(r"(?m)^warning: .*: it is written in Python\n", "", done.stderr)
    return done


def repeated(command: str) -> dict[str, Any]:
    """Run a command line `cosim run ...`; returns its result."""
    _, *words = shlex.split(command)
    line = [sys.executable, "-m", "cosim", *words, "--json", "-"]
    done = subprocess.run(line, capture_output=True, text=True, env=environment(), check=False, timeout=120)
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def rows(folder: Path) -> list[dict[str, Any]]:
    """Rows of `results.jsonl`, the last one for each run, by number."""
    lines = (folder / "results.jsonl").read_text().splitlines()
    found = {row["hash"]: row for row in map(json.loads, lines)}
    return sorted(found.values(), key=lambda row: int(row["run"]))


def numbers(folder: Path) -> list[dict[str, Any]]:
    """Rows without the times that differ from run to run."""
    return [{key: value for key, value in row.items() if key != "wall_s"} for row in rows(folder)]


def statuses(folder: Path) -> list[str]:
    """Status of each run."""
    return [row["status"] for row in rows(folder)]


def case_list(cases: Sequence[str], limits: str = "") -> str:
    """Study of a list of cases of the lag; each is the body of a `[[case]]`."""
    tables = "\n".join(f"[[case]]\n{case}" for case in cases)
    return f'scenario = "lag.toml"\n[design]\nkind = "list"\n[limits]\n{limits}\n{tables}\n'


def wait_for(condition: Callable[[], bool]) -> None:
    """Wait until something has happened; what never does is an error and not a test that hangs."""
    for _ in range(1000):
        if condition():
            return
        time.sleep(0.1)
    pytest.fail("what the test waits for did not happen")
