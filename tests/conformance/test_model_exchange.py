"""Model exchange by time events gives the samples of co-simulation, bit for bit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.model_description import ModelDescription
from numpy.typing import NDArray

import cosim

from .conftest import ROOT, Fmu
from .replay import put

SAMPLES = 300
LOOPS = ["centering", "deburr", "dob", "fts", "polish"]


def test_the_description_offers_events_and_no_states(fmu: Fmu) -> None:
    offer = fmu.description.modelExchange
    assert offer.modelIdentifier == fmu.description.coSimulation.modelIdentifier
    assert (offer.needsCompletedIntegratorStep, offer.needsExecutionTool) == (False, False)
    assert (offer.canGetAndSetFMUstate, offer.canSerializeFMUstate) == (True, True)
    counts = (fmu.description.numberOfContinuousStates, fmu.description.numberOfEventIndicators)
    assert counts == (0, 0)


@pytest.mark.client("FMPy", "simulates it by events")
@pytest.mark.parametrize("solver", ["CVode", "Euler"])
def test_fmpy_simulates_it_as_it_steps_it(fmu: Fmu, solver: str) -> None:
    step = float(fmu.description.defaultExperiment.stepSize)
    inputs = [variable.name for variable in fmu.variables("input", "Real")]
    signal = np.zeros(SAMPLES, dtype=[(name, np.float64) for name in ["time", *inputs]])
    signal["time"] = step * np.arange(SAMPLES)
    for i, name in enumerate(inputs):
        signal[name] = 1e-4 * np.sin(20.0 * np.arange(SAMPLES) / SAMPLES + i)
    outputs = [v.name for v in fmu.variables() if v.causality in ("output", "local") and v.type != "String"]

    def simulate(kind: str, **more: Any) -> NDArray[Any]:
        result: NDArray[Any] = fmpy.simulate_fmu(
            str(fmu.folder),
            fmi_type=kind,
            stop_time=step * (SAMPLES - 1),
            output_interval=step,
            input=signal,
            output=outputs,
            record_events=False,
            **more,
        )
        return result

    steps, events = simulate("CoSimulation"), simulate("ModelExchange", solver=solver, step_size=step)
    assert len(steps) == len(events) == SAMPLES
    # a row of steps is what the sample at its beginning has left, one of events that of now
    for name in outputs:
        assert steps[name][1:].tolist() == events[name][:-1].tolist(), name


def events_of(description: ModelDescription, folder: Path, parameters: dict[str, Any]) -> Any:
    """Return an instance for model exchange at its first event."""
    model = FMU2Model(
        instanceName="events",
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.modelExchange.modelIdentifier,
    )
    model.instantiate(callbacks=fmi2CallbackFunctions(logger=fmi2CallbackLoggerTYPE(lambda *_: None)))
    model.setupExperiment()
    for variable in description.modelVariables:
        if variable.name in parameters:
            put(model, variable, parameters[variable.name])
    model.enterInitializationMode()
    model.exitInitializationMode()
    return model


def replay(model: Any, inputs: dict[Any, NDArray[Any]], step: float, rows: int) -> Iterator[None]:
    """Apply recorded inputs in an event loop; one yield after the last sample of each row.

    A row is an input event, and each sample in it a time event.
    """
    for k in range(rows):
        if k > 0:
            model.setTime(k * step)
            model.enterEventMode()
        for variable, values in inputs.items():
            put(model, variable, values[k])
        (_, _, _, _, _, due) = model.newDiscreteStates()
        model.enterContinuousTimeMode()
        # within a millionth of a sample of the next row it is a sample of that
        while due < (k + 1) * step * (1.0 - 1e-9) - 1e-6 * step:
            model.setTime(due)
            model.enterEventMode()
            (_, _, _, _, _, due) = model.newDiscreteStates()
            model.enterContinuousTimeMode()
        yield


@pytest.mark.client("FMPy", "replays a closed loop by events")
@pytest.mark.parametrize("loop", LOOPS)
def test_the_inputs_of_a_closed_loop_give_its_samples(loop: str, tmp_path: Path) -> None:
    scenario = cosim.load(loop)
    result = cosim.run(scenario, 61_007, engine="native")
    trace = result.trace
    assert trace is not None
    file = ROOT / f"target/fmu/{scenario.controller.fmu}.fmu"
    folder = Path(fmpy.extract(str(file), str(tmp_path / "unpacked")))
    description = fmpy.read_model_description(str(file))
    variables = {f"controller.{v.name}": v for v in description.modelVariables}
    recorded = [(name, v) for name, v in variables.items() if name in (trace.dtype.names or ())]
    inputs = {v: trace[name] for name, v in recorded if v.causality == "input"}
    outputs = [(name, v) for name, v in recorded if v.causality in ("output", "local") and v.type != "String"]
    assert len(inputs) == sum(v.causality == "input" for v in description.modelVariables)
    assert outputs

    model = events_of(description, folder, scenario.controller.parameters)
    seen = np.empty((len(trace), len(outputs)))
    groups = [
        (get, [i for i, (_, v) in enumerate(outputs) if v.type in types])
        for get, types in [
            (model.getReal, ("Real",)),
            (model.getInteger, ("Integer", "Enumeration")),
            (model.getBoolean, ("Boolean",)),
        ]
    ]
    reads = [(get, at, [outputs[i][1].valueReference for i in at]) for get, at in groups if at]
    for k, _ in enumerate(replay(model, inputs, scenario.loop.step, len(trace))):
        for get, at, references in reads:
            seen[k, at] = get(references)
    model.terminate()
    model.freeInstance()
    for i, (name, _) in enumerate(outputs):
        assert np.array_equal(seen[:, i], trace[name].astype(np.float64)), name
