"""FMUs in FMPy, driven in the ways of the importers that are in use."""

from __future__ import annotations

import csv
import math
import subprocess
import sys
from collections.abc import Iterator
from ctypes import byref, c_double
from pathlib import Path
from typing import Any
from urllib.parse import quote

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2LastSuccessfulTime
from numpy.typing import NDArray

from .conftest import Fmu

SAMPLES = 10_001


def slave_of(fmu: Fmu) -> Any:
    return FMU2Slave(
        instanceName="slave",
        guid=fmu.description.guid,
        unzipDirectory=str(fmu.folder),
        modelIdentifier=fmu.description.coSimulation.modelIdentifier,
    )


def step_size(fmu: Fmu) -> float:
    return float(fmu.description.defaultExperiment.stepSize)


@pytest.mark.client("FMPy", "simulates it from the command line")
def test_the_command_line_of_fmpy_runs_the_fmu_alone(fmu: Fmu, tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "fmpy",
        "simulate",
        str(fmu.file),
        "--validate",
        "--output-file",
        "out.csv",
    ]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    with (tmp_path / "out.csv").open() as file:
        rows = list(csv.reader(file))
    assert len(rows) > 100
    assert {variable.name for variable in fmu.variables("output") if variable.type != "String"} <= set(
        rows[0]
    )
    stop = float(fmu.description.defaultExperiment.stopTime)
    assert float(rows[-1][0]) == pytest.approx(stop)


def slow_sines(fmu: Fmu, names: list[str]) -> NDArray[np.void]:
    """Return an input of FMPy with as many samples as a long recording has."""
    signal = np.zeros(SAMPLES, dtype=[(name, np.float64) for name in ["time", *names]])
    signal["time"] = step_size(fmu) * np.arange(SAMPLES)
    for i, name in enumerate(names):
        signal[name] = 1e-4 * np.sin(signal["time"] + i)
    return signal


@pytest.mark.client("FMPy", "simulates it with inputs")
def test_simulate_fmu_takes_a_long_input(fmu: Fmu) -> None:
    inputs = [variable.name for variable in fmu.variables("input", "Real")]
    signal = slow_sines(fmu, inputs)
    outputs = [v.name for v in fmu.variables("output") if v.type != "String"]
    result = fmpy.simulate_fmu(
        str(fmu.file),
        stop_time=float(signal["time"][-1]),
        output_interval=step_size(fmu),
        input=signal,
        output=[*inputs, *outputs],
    )
    assert len(result) == SAMPLES
    for name in outputs:
        assert np.all(np.isfinite(result[name].astype(np.float64))), name
    # a row holds the time after a step and the inputs from before it
    for name in inputs:
        np.testing.assert_allclose(result[name][1:], signal[name][:-1], atol=1e-12)


def test_an_unpacked_folder_with_blanks_and_utf_8_runs(fmu: Fmu) -> None:
    assert " " in str(fmu.folder)
    assert not str(fmu.folder).isascii()
    result = fmpy.simulate_fmu(str(fmu.folder), stop_time=10 * step_size(fmu), output_interval=step_size(fmu))
    assert len(result) == 11


def resource_locations(fmu: Fmu) -> Iterator[bytes | None]:
    """Yield every form in which importing tools write the location of the resources."""
    plain = str(fmu.folder / "resources")
    encoded = quote(plain)
    for text in [f"file://{encoded}", f"file:{encoded}", f"file:///{encoded}", f"file://localhost{encoded}"]:
        yield text.encode()
        yield f"{text}/".encode()
    yield from (b"file:" + plain.encode(), plain.encode(), b"", None, b"file:///no/such/folder")
    yield b"file:///tmp/%7B8c4e810f-3df3-4a00-8276-176fa3c9f000%7D/resources"


def test_every_form_of_the_resources_is_taken(fmu: Fmu) -> None:
    slave = slave_of(fmu)
    guid = fmu.description.guid.encode()
    for location in resource_locations(fmu):
        component = slave.fmi2Instantiate(b"a/b c.fmu", 1, guid, location, byref(defaultCallbacks), 1, 0)
        assert component is not None, location
        slave.component = component
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        slave.doStep(0.0, step_size(fmu))
        slave.fmi2FreeInstance(component)
    slave.freeLibrary()


def compliance_checker(start: float, stop: float, _: float) -> Iterator[tuple[float, float]]:
    """Yield 500 steps whatever the step size; the last is cut to the stop time."""
    step, time = (stop - start) / 500, start
    for _k in range(499):
        yield time, step
        time += step
    yield time, stop - time


def adding(start: float, stop: float, step: float) -> Iterator[tuple[float, float]]:
    """Yield points that are running sums, as Ecos and OMSimulator have them."""
    time = start
    while time < stop - 1e-9:
        yield time, min(step, stop - time)
        time += step


def differences(start: float, stop: float, step: float) -> Iterator[tuple[float, float]]:
    """Yield steps that are differences of rounded points, as FMPy has them."""
    for k in range(round((stop - start) / step)):
        yield start + k * step, (start + (k + 1) * step) - (start + k * step)


@pytest.mark.parametrize("master", [compliance_checker, adding, differences])
@pytest.mark.parametrize("experiment", [(None, None), (1e-4, None), (None, 1.0), (1e-6, 1.0)])
def test_masters_of_every_kind_reach_the_stop_time(
    fmu: Fmu, master: Any, experiment: tuple[float | None, float | None]
) -> None:
    tolerance, stop = experiment
    slave = slave_of(fmu)
    slave.instantiate(loggingOn=False)
    slave.setupExperiment(tolerance=tolerance, startTime=0.0, stopTime=stop)
    slave.enterInitializationMode()
    # libcosim reads everything already here
    assert len(read_all(fmu, slave)) == len(fmu.variables())
    slave.exitInitializationMode()
    for time, step in master(0.0, 1.0, 0.01):
        slave.doStep(currentCommunicationPoint=time, communicationStepSize=step)
    reached = c_double()
    slave.fmi2GetRealStatus(slave.component, fmi2LastSuccessfulTime, byref(reached))
    assert math.isclose(reached.value, 1.0, rel_tol=1e-9)
    assert len(read_all(fmu, slave)) == len(fmu.variables())
    slave.terminate()
    slave.freeInstance()


def read_all(fmu: Fmu, slave: Any) -> list[object]:
    get = {"Real": slave.getReal, "Boolean": slave.getBoolean, "String": slave.getString}
    return [get.get(v.type, slave.getInteger)([v.valueReference])[0] for v in fmu.variables()]


@pytest.mark.client("FMPy", "writes and reads every start value")
def test_every_start_value_can_be_written_and_read_back(fmu: Fmu) -> None:
    slave = slave_of(fmu)
    slave.instantiate()
    slave.setupExperiment()
    for variable in fmu.variables():
        reference = [variable.valueReference]
        if variable.causality not in ("input", "parameter"):
            continue
        match variable.type:
            case "Real":
                slave.setReal(reference, [float(variable.start)])
            case "Boolean":
                slave.setBoolean(reference, [variable.start == "true"])
            case "String":
                slave.setString(reference, [variable.start])
            case _:
                slave.setInteger(reference, [int(variable.start)])
    slave.enterInitializationMode()
    for variable, value in zip(fmu.variables(), read_all(fmu, slave), strict=True):
        if variable.start is None:
            continue
        match variable.type:
            case "Real":
                assert value == float(variable.start), variable.name
            case "Boolean":
                assert bool(value) == (variable.start == "true"), variable.name
            case "String":
                assert isinstance(value, bytes)
                assert value.decode() == variable.start, variable.name
            case _:
                assert value == int(variable.start), variable.name
    slave.exitInitializationMode()
    slave.terminate()
    slave.reset()
    slave.freeInstance()
