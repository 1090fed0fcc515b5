"""Runs an FMU on recorded inputs in a process of its own; saves or restores its state in the middle.

`replay.py run FOLDER RECORDING STATE` saves the state before the row `split` and prints the outputs of all
rows; `replay.py resume FOLDER RECORDING STATE` restores that state in a new instance, which got no
parameters, and prints the outputs from that row on.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from numpy.typing import NDArray

FMI_TYPE = {"Enumeration": "Integer"}


def instance(description: Any, folder: str, parameters: dict[str, Any]) -> Any:
    """Return an instance before its first step; its log goes nowhere."""
    slave = FMU2Slave(
        instanceName="replay",
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
    )
    silent = fmi2CallbackFunctions(logger=fmi2CallbackLoggerTYPE(lambda *_: None))
    slave.instantiate(callbacks=silent)
    slave.setupExperiment()
    for variable in description.modelVariables:
        if variable.name in parameters:
            put(slave, variable, parameters[variable.name])
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave


def put(slave: Any, variable: Any, value: Any) -> None:
    """Set one variable; items of enumerations may be given by name."""
    if variable.type == "String":
        slave.setString([variable.valueReference], [str(value)])
        return
    if isinstance(value, str) and variable.type == "Enumeration":
        value = next(int(item.value) for item in variable.declaredType.items if item.name == value)
    number = float(value) if variable.type == "Real" else int(value)
    kind = FMI_TYPE.get(variable.type, variable.type)
    getattr(slave, f"set{kind}")([variable.valueReference], [number])


def play(description: Any, slave: Any, rows: NDArray[Any], first: int, step: float) -> list[str]:
    """Step through recorded rows; return all numbers of the FMU after each, bit for bit."""
    inputs = [v for v in description.modelVariables if v.name in (rows.dtype.names or ())]
    reals = [v.valueReference for v in description.modelVariables if v.type == "Real"]
    numbers = [v.valueReference for v in description.modelVariables if v.type in ("Integer", "Enumeration")]
    truths = [v.valueReference for v in description.modelVariables if v.type == "Boolean"]
    lines = []
    for k, row in enumerate(rows, start=first):
        for variable in inputs:
            put(slave, variable, row[variable.name])
        slave.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
        seen = [value.hex() for value in slave.getReal(reals)]
        lines.append(" ".join([*seen, *map(str, slave.getInteger(numbers) + slave.getBoolean(truths))]))
    return lines


def main(mode: str, folder: str, recording: str, state_file: str) -> None:
    """Run or resume."""
    with np.load(recording) as archive:
        rows, split, step = archive["rows"], int(archive["split"]), float(archive["step"])
        parameters = json.loads(str(archive["parameters"]))
    description = fmpy.read_model_description(folder)
    slave = instance(description, folder, parameters if mode == "run" else {})
    lines = []
    if mode == "run":
        lines = play(description, slave, rows[:split], 0, step)
        state = slave.getFMUstate()
        Path(state_file).write_bytes(slave.serializeFMUstate(state))
    else:
        state = slave.deSerializeFMUstate(Path(state_file).read_bytes())
        slave.setFMUstate(state)
    slave.freeFMUstate(state)
    print("\n".join([*lines, *play(description, slave, rows[split:], split, step)]))
    slave.terminate()
    slave.freeInstance()


if __name__ == "__main__":
    main(*sys.argv[1:])
