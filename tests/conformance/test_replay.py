"""A saved state continues in a new process bit for bit, from any time."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from numpy.typing import NDArray

import cosim

from .conftest import ROOT, Fmu
from .replay import instance, put

STEPS = 400
AFTER = 1000


def replay(mode: str, folder: Path, files: Path) -> list[str]:
    """Run `replay.py` with the recording in `files`; its lines."""
    script = Path(__file__).with_name("replay.py")
    command = [
        sys.executable,
        str(script),
        mode,
        str(folder),
        str(files / "recording.npz"),
        str(files / "state"),
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    return run.stdout.splitlines()


def record(files: Path, rows: NDArray[Any], split: int, step: float, parameters: dict[str, Any]) -> None:
    """Write a recording for `replay.py`: inputs by name, and the row before which the state is saved."""
    texts = json.dumps(parameters)
    np.savez(files / "recording.npz", rows=rows, split=split, step=step, parameters=texts)


def test_between_two_samples_of_moving_inputs(fmu: Fmu, tmp_path: Path) -> None:
    names = [variable.name for variable in fmu.variables("input", "Real")]
    rows = np.zeros(STEPS, dtype=[(name, np.float64) for name in names])
    for i, name in enumerate(names):
        rows[name] = [1e-3 * math.sin(0.1 * k + i) for k in range(STEPS)]
    # not a multiple of the sample period: the state is taken between two samples
    step = 0.7317 * float(fmu.description.defaultExperiment.stepSize)
    record(tmp_path, rows, STEPS // 2, step, {})
    lines = replay("run", fmu.folder, tmp_path)
    assert len(lines) == STEPS
    assert lines[0] != lines[-1]
    assert replay("resume", fmu.folder, tmp_path) == lines[STEPS // 2 :]


@pytest.mark.client("FMPy", "saves and restores a closed loop")
@pytest.mark.parametrize(
    ("loop", "state"),
    [("dob", "Detect"), ("centering", "Push"), ("centering", "Wait"), ("deburr/learn", "Run")],
)
def test_in_the_middle_of_a_state_of_a_closed_loop(loop: str, state: str, tmp_path: Path) -> None:
    scenario = cosim.load(loop)
    result = cosim.run(scenario, 57_001, engine="native")
    trace = result.trace
    assert trace is not None
    busy = np.flatnonzero(trace["controller.state"] == result.items["controller.state"][state])
    split = int(busy[len(busy) // 4]) + 1
    assert trace["controller.state"][split - 1] == trace["controller.state"][split]

    file = ROOT / f"target/fmu/{scenario.controller.fmu}.fmu"
    folder = Path(fmpy.extract(str(file), str(tmp_path / "unpacked")))
    description = fmpy.read_model_description(str(file))
    names = {v.name: f"controller.{v.name}" for v in description.modelVariables if v.causality == "input"}
    rows = np.zeros(min(len(trace), split + AFTER), dtype=[(name, np.float64) for name in names])
    for name, column in names.items():
        rows[name] = trace[column][: len(rows)]
    record(tmp_path, rows, split, scenario.loop.step, scenario.controller.parameters)

    lines = replay("run", folder, tmp_path)
    assert len(lines) == len(rows)
    assert replay("resume", folder, tmp_path) == lines[split:]
    # and the bare FMU did what it did in the loop
    reals = [v.name for v in description.modelVariables if v.type == "Real"]
    seen = zip(*(line.split() for line in lines), strict=True)
    for name, numbers in zip(reals, seen, strict=False):
        if f"controller.{name}" in (trace.dtype.names or ()):
            reported = [float.fromhex(number) for number in numbers]
            assert reported == trace[f"controller.{name}"][: len(lines)].tolist(), name


@pytest.mark.parametrize("loop", ["centering", "deburr", "dob", "fts", "polish"])
def test_the_guide_shows_how_many_bytes_a_state_has(loop: str, tmp_path: Path) -> None:
    scenario = cosim.load(loop)
    trace = cosim.run(scenario, engine="native").trace
    assert trace is not None
    name = scenario.controller.fmu
    folder = Path(fmpy.extract(str(ROOT / f"target/fmu/{name}.fmu"), str(tmp_path / "unpacked")))
    description = fmpy.read_model_description(str(folder))
    inputs = {v: trace[f"controller.{v.name}"] for v in description.modelVariables if v.causality == "input"}
    slave = instance(description, str(folder), scenario.controller.parameters)

    def size() -> int:
        state = slave.getFMUstate()
        bytes_ = slave.serializeFMUstate(state)
        slave.freeFMUstate(state)
        return len(bytes_)

    sizes = [size()]
    for k in range(len(trace)):
        for variable, values in inputs.items():
            put(slave, variable, values[k])
        slave.doStep(k * scenario.loop.step, scenario.loop.step)
        if k % 10 == 0:
            sizes.append(size())
    slave.terminate()
    slave.freeInstance()
    text = (ROOT / "docs/import/c-library.md").read_text(encoding="utf-8")
    assert f"\n| `{name}` | {sizes[0]:,} | {max(sizes):,} |\n" in text
