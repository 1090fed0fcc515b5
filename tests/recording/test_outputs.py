"""Every output and local variable is written in some scenario (`pytest -m recording`)."""

from __future__ import annotations

from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import cosim
from cosim.fmu.description import Variable

from . import record

pytestmark = pytest.mark.recording
UNUSED = {
    "DisturbanceObserverContactDetection": {"aborted"},
    "RotaryFastToolServo": {"saturated"},
    "StickSlipPolishing": {"ripple.stopped"},
    "VariableSpeedDeburring": {"saturated", "load.overload"},
}
"""Outputs and local variables that no scenario writes; tests in Rust do."""


def written(name: str) -> tuple[str, dict[str, bool]]:
    """Return the FMU of a scenario, and whether each numeric output, arrays as one, left its start value."""
    found: dict[str, bool] = defaultdict(bool)
    with cosim.Session(cosim.load(name), engine="native") as session:
        trace = session.run().trace
        assert trace is not None
        for output in (*session.file.named("output"), *session.file.named("local")):
            column = f"controller.{output.name}"
            if column in (trace.dtype.names or ()):
                values = trace[column]
                found[output.name.partition("[")[0]] |= bool(np.any(values != start(output)))
        return session.file.name, dict(found)


def start(output: Variable) -> float:
    """Start value of an output."""
    return float({"true": "1", "false": "0", "": "0"}.get(output.start, output.start))


def test_every_output_is_written_in_some_scenario() -> None:
    ever: dict[str, dict[str, bool]] = defaultdict(lambda: defaultdict(bool))
    with ProcessPoolExecutor() as pool:
        for fmu, found in pool.map(written, record.scenario_names()):
            for output, was in found.items():
                ever[fmu][output] |= was
    unused = {fmu: {output for output, was in found.items() if not was} for fmu, found in ever.items()}
    assert {fmu: names for fmu, names in unused.items() if names} == UNUSED
