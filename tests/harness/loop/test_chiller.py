"""The example with three FMUs of PythonFMU, `examples/chiller`."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
from pythonfmu.builder import FmuBuilder

import cosim

EXAMPLE = Path(__file__).parents[3] / "examples" / "chiller"
EXPANSION, REFERENCE, FILTER, STEP = 4e-6, 20.0, 5.0, 0.1


def test_the_example_passes_and_each_fmu_gets_what_its_wires_say(tmp_path: Path) -> None:
    shutil.copy(EXAMPLE / "chiller.toml", tmp_path)
    for script in EXAMPLE.glob("*.py"):
        FmuBuilder.build_FMU(script, tmp_path)
    result = cosim.run(cosim.load(tmp_path / "chiller.toml"), isolated=True)
    assert result.passed, result
    trace = result.trace
    assert trace is not None
    # the chiller steps every second and holds its coolant
    assert not np.diff(trace["chiller.coolant"]).reshape(-1)[np.arange(1, len(trace)) % 10 != 0].any()
    assert trace["spindle.coolant"].tobytes() == trace["chiller.coolant"].tobytes()
    # one step later, with noise and in steps of 0.1 K
    measured, temperature = trace["compensation.measured"], trace["spindle.temperature"]
    assert np.abs(measured[1:] - temperature[:-1]).max() < 0.05 + 5 * 0.02
    assert np.allclose(measured, np.round(measured, 1), rtol=0.0, atol=1e-12)
    # the equation of the compensation
    filtered, offsets = REFERENCE, []
    for value in measured:
        filtered += STEP / (STEP + FILTER) * (value - filtered)
        offsets.append(EXPANSION * (filtered - REFERENCE))
    assert np.array_equal(trace["compensation.offset"], offsets)
