"""Runs an FMU in a process of its own; saves or restores its state in the middle.

`replay.py run FOLDER STATE` saves the state half way and prints the outputs of the second half;
`replay.py resume FOLDER STATE` restores that state in a fresh instance and prints the same.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

STEPS = 200


def instance(folder: str) -> tuple[Any, Any]:
    """Return the description and an instance before its first step; its log goes nowhere."""
    description = fmpy.read_model_description(folder)
    slave = FMU2Slave(
        instanceName="replay",
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
    )
    silent = fmi2CallbackFunctions(logger=fmi2CallbackLoggerTYPE(lambda *_: None))
    slave.instantiate(callbacks=silent)
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return description, slave


def steps(description: Any, slave: Any, first: int) -> list[str]:
    """Step from a step number on, with moving inputs; return all Reals and Integers, bit for bit."""
    # not a multiple of the sample period: the state is taken between two samples
    step = 0.7317 * float(description.defaultExperiment.stepSize)
    inputs = [v for v in description.modelVariables if v.causality == "input" and v.type == "Real"]
    reals = [v.valueReference for v in description.modelVariables if v.type == "Real"]
    numbers = [v.valueReference for v in description.modelVariables if v.type in ("Integer", "Enumeration")]
    lines = []
    for k in range(first, first + STEPS):
        values = [1e-3 * math.sin(0.1 * k + i) for i in range(len(inputs))]
        slave.setReal([v.valueReference for v in inputs], values)
        slave.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
        seen = [value.hex() for value in slave.getReal(reals)]
        lines.append(" ".join([*seen, *map(str, slave.getInteger(numbers))]))
    return lines


def main(mode: str, folder: str, state_file: str) -> None:
    """Run or resume."""
    description, slave = instance(folder)
    if mode == "run":
        steps(description, slave, 0)
        state = slave.getFMUstate()
        Path(state_file).write_bytes(slave.serializeFMUstate(state))
    else:
        state = slave.deSerializeFMUstate(Path(state_file).read_bytes())
        slave.setFMUstate(state)
    slave.freeFMUstate(state)
    print("\n".join(steps(description, slave, STEPS)))
    slave.terminate()
    slave.freeInstance()


if __name__ == "__main__":
    main(*sys.argv[1:])
