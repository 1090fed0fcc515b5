"""The native engine: the steps of the reference engine in compiled code, with identical bits and errors."""

from __future__ import annotations

import ctypes
import logging
from collections.abc import Iterable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException

from cosim.fmu.binding import Bank
from cosim.fmu.description import FmuFile
from cosim.fmu.instance import Instance
from cosim.loop import condition, reference
from cosim.loop.engines import Engine
from cosim.loop.plant import Plant
from cosim.loop.position import Stage
from cosim.loop.reference import PROGRESS_EVERY, Parts, Recording
from cosim.loop.wires.connections import Connections, whole
from cosim.scenario.model import Scenario

log = logging.getLogger("cosim")
DO_STEP = "fmi2DoStep"


def choose(engine: Engine, scenario: Scenario, plant: Plant, files: Iterable[FmuFile]) -> Engine:
    """Engine for a scenario, its plant and FMUs: the requested one, or the reference engine."""
    subject, reason = f"`{scenario.name}`", ""
    if engine == "reference":
        return engine
    if scenario.fmu:
        reason = "the native engine requires a `[controller]`"
    elif any(file.version != 2 for file in files):
        reason = "the native engine requires FMI 2.0"
    elif reason := obstacle(plant):
        subject = f"the plant `{scenario.plant.name}`"
    if not reason:
        return engine
    log.info("%s runs in the reference engine: %s", subject, reason)
    return "reference"


def obstacle(plant: Any) -> str:
    """Reason why native code cannot step a plant; empty if it can."""
    if not hasattr(plant, "machine"):
        return "it is written in Python"
    from plants.base.machine import NotNativeError

    try:
        plant.check_native()
    except NotNativeError as error:
        return str(error)
    return ""


def controller(fmu: Instance) -> SimpleNamespace:
    """Return the function addresses of an initialized FMU, from FMPy's handle of its library.

    `names` are the names of its calls in the order of a step.
    """

    def function(name: str) -> int:
        return ctypes.cast(getattr(fmu.fmi.slave.dll, name), ctypes.c_void_p).value or 0

    def call(name: str, bank: Bank) -> SimpleNamespace:
        references = np.array(bank.references[:], np.uint32)
        return SimpleNamespace(function=function(name), references=references, values=bank.values)

    setters = [(f"fmi2Set{bank.base}", bank) for bank in fmu.inputs]
    getters = [(f"fmi2Get{bank.base}", bank) for bank in fmu.outputs]
    return SimpleNamespace(
        component=fmu.fmi.slave.component,
        set=[call(*one) for one in setters],
        step=function(DO_STEP),
        status=function("fmi2GetBooleanStatus"),
        get=[call(*one) for one in getters],
        names=[*(name for name, _ in setters), DO_STEP, *(name for name, _ in getters)],
        # keeps the addresses valid
        fmu=fmu,
    )


def links(connections: Connections) -> SimpleNamespace:
    """Return the connections of the only FMU and the plant as the stepper reads them."""
    (fmu,), plant = connections.fmus, connections.plant
    return SimpleNamespace(
        sensed=connections.sensed,
        commands=connections.commands,
        readings=fmu.wires,
        stimuli=[*fmu.stimuli, *plant.stimuli],
        input_faults=fmu.faults,
        outputs=plant.wires,
        command_faults=plant.faults,
    )


def run(parts: Parts, chunk: int = PROGRESS_EVERY) -> Recording:
    """Run as `cosim.loop.reference.run`, in native code from chunk to chunk; errors have the same text.

    `chunk` are the steps between two checks of `progress` and Ctrl-C; it does not affect results.
    """
    from machining_native import Stepper

    scenario, (fmu,) = parts.scenario, parts.fmus
    plant: Any = parts.plant
    stop_when, progress = parts.stop_when, parts.progress
    steps, step = scenario.loop.steps, scenario.loop.step
    machine = plant.machine()
    connections, recorder = parts.connections, reference.recording(parts)
    columns = recorder.table.shape[1]
    recorder.stop = condition.program(stop_when, columns) if stop_when else None
    triggers = [
        replace(trigger, program=condition.program(trigger.condition, columns))
        for trigger in reference.triggers_of(parts)
    ]
    recorder.triggers = [trigger for trigger in triggers if trigger.program is not None]
    calls = controller(fmu)
    stepper = Stepper(machine, calls, links(connections), recorder, step, scenario.loop.substeps)
    # what native code cannot evaluate is looked at after every step
    look = stop_when if recorder.stop is None else None
    slow = [trigger for trigger in triggers if trigger.program is None]
    done, ended, stop = 0, False, None
    parts.position.at(Stage.STEP_BOTH)
    try:
        while done < steps and not ended:
            parts.position.page.step = done
            room = recorder.room(done)
            until = done + 1 if look or slow else min(done + chunk, steps, room)
            stop = plant.run(stepper, until)
            ended = explain(stop, connections, calls, plant)
            if (look or slow) and (row := recorder.row(done)) is not None:
                for trigger in slow:
                    trigger(row, done)
                ended = ended or (look is not None and bool(look(row)))
            if progress is not None:
                for reported in range(-(-done // PROGRESS_EVERY) * PROGRESS_EVERY, stepper.k, PROGRESS_EVERY):
                    progress(reported, steps)
            done = stepper.k
            parts.interrupt()
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a panic of Rust is no `Exception`
        raise reference.located(error, fmu, scenario, stepper.k) from error
    if stepper.warned is not None:
        number, time = stepper.warned
        fmu.warned = fmu.warned or (calls.names[number], time)
    if stop is not None and stop[0] == "terminated":
        fmu.ended = (done - 1) * step
    return reference.recorded(parts, recorder, done)


def explain(stop: tuple[str, int, float] | None, connections: Connections, calls: Any, plant: Plant) -> bool:
    """Whether the condition or the FMU ended the run; otherwise raise the error of the reference engine."""
    match stop:
        case None:
            return False
        case ("stop" | "terminated", _, _):
            return True
        case ("reading", wire, value):
            raise connections.fmus[0].wires[wire].shape.refusal(value)
        case ("output", wire, value):
            raise connections.plant.wires[wire].shape.refusal(value)
        case ("integer", _, value):
            whole(value)
        case ("command", _, _):
            plant.command(connections.commands)
        case ("call", number, status):
            raise FMICallException(calls.names[number], int(status))
    raise RuntimeError(f"the native engine stopped for an unknown reason: {stop}")
