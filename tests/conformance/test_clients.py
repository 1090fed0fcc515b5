"""FMUs in importers that `cargo xtask test --clients` builds."""

from __future__ import annotations

import csv
import subprocess
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

from .conftest import NAMES, PROBE, ROOT, need

FMI_SIM = ROOT / "target/clients/bin/fmi-sim"
COMMANDS = {"CoSimulation": "co-simulation", "ModelExchange": "model-exchange"}
STEPS = 1000
ROUNDING = 1e-14
"""Of the largest value of an output: fmi-sim interpolates inputs, which rounds them."""
RESTS = {
    "CoSimulation": {"fmu-deburr"},
    "ModelExchange": {"fmu-centering", "fmu-deburr", "fmu-fts"},
}
"""FMUs whose Real outputs are constant: fmi-sim takes only Real inputs from a file: no cycle starts."""

pytestmark = pytest.mark.clients


@pytest.mark.client("fmi-sim", "does by steps and by events what FMPy does")
@pytest.mark.parametrize("kind", COMMANDS)
@pytest.mark.parametrize("fmu", [name for name in NAMES if name != PROBE])
def test_fmi_sim_does_what_fmpy_does(fmu: str, kind: str, tmp_path: Path) -> None:
    program = need("fmi-sim", str(FMI_SIM) if FMI_SIM.is_file() else None)
    file, given, out = ROOT / f"target/fmu/{fmu}.fmu", tmp_path / "in.csv", tmp_path / "out.csv"
    description = fmpy.read_model_description(str(file))
    step = float(description.defaultExperiment.stepSize)

    reals = [v for v in description.modelVariables if v.type == "Real"]
    inputs = [v.name for v in reals if v.causality == "input"]
    signal = np.zeros(STEPS + 1, dtype=[(name, np.float64) for name in ["time", *inputs]])
    signal["time"] = step * np.arange(STEPS + 1)
    for k, name in enumerate(inputs):
        signal[name] = 1e-4 * np.sin(20.0 * np.arange(STEPS + 1) / STEPS + k)
    with given.open("w", newline="") as lines:
        csv.writer(lines).writerows([["time", *inputs], *signal.tolist()])

    files = ["--model", str(file), "--input-file", str(given), "--output-file", str(out)]
    times = ["-f", repr(STEPS * step), "--output-interval", repr(step)]
    command = [program, *files, COMMANDS[kind], *times]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout[-1000:] + run.stderr
    with out.open() as lines:
        # of several rows at one time the last holds what came of the event
        rows = {round(float(row["time"]) / step): row for row in csv.DictReader(lines)}
    assert sorted(rows) == list(range(STEPS + 1))

    euler: dict[str, Any] = {"solver": "Euler", "step_size": step} if kind == "ModelExchange" else {}
    outputs = [v.name for v in reals if v.causality == "output"]
    alone = fmpy.simulate_fmu(
        str(file),
        fmi_type=kind,
        stop_time=STEPS * step,
        output_interval=step,
        input=signal,
        output=outputs,
        record_events=False,
        **euler,
    )
    moved = False
    for name in outputs:
        seen = np.array([float(rows[k][name]) for k in range(STEPS + 1)])
        moved |= bool(np.ptp(seen) > 0.0)
        np.testing.assert_allclose(seen, alone[name], rtol=0.0, atol=ROUNDING * np.max(np.abs(seen)))
    assert moved or fmu in RESTS[kind]
