"""The reference loop: plain, and the specification of what one step of a closed loop is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from fmpy.fmi1 import FMICallException
from numpy.typing import NDArray

from cosim.errors import CosimError, PlantError
from cosim.fmu.instance import Instance
from cosim.loop.connect import Connector, Fault, Link, Links
from cosim.loop.place import Place, Stage
from cosim.loop.plant import Plant, one_each
from cosim.loop.trace import Recorder
from cosim.metrics.expression import Expression
from cosim.scenario.model import Scenario

Progress = Callable[[int, int], None]
"""Told the steps done and the steps in all, now and then."""
PROGRESS_EVERY = 500


class Recording(NamedTuple):
    """What a run leaves: the table of its trace and the communication steps that were done."""

    table: NDArray[np.float64]
    steps: int


@dataclass(frozen=True)
class Parts:
    """What a run needs: an initialised FMU and a plant that was reset, wired by a scenario.

    The run ends early in the first row that `stop_when` holds for. `interrupt` is called after every step and
    may raise; `place` is told whose code runs.
    """

    scenario: Scenario
    fmu: Instance
    plant: Plant
    seed: int
    stop_when: Expression | None = None
    progress: Progress | None = None
    interrupt: Callable[[], None] = lambda: None
    place: Place = field(default_factory=Place)


def run(parts: Parts) -> Recording:
    """Run FMU and plant in closed loop.

    The row of step `k` holds the time `k * step`, the inputs that the controller got then, the outputs it
    computed from them and the truths of the plant at that time.

    Raises
    ------
    CosimError
        The FMU returned an error, the plant failed, or a value on a wire is not finite; names step and time.
    """
    scenario, fmu, plant = parts.scenario, parts.fmu, parts.plant
    stop_when, progress, loop = parts.stop_when, parts.progress, scenario.loop
    commands = np.zeros(len(plant.commands))
    links = Connector(scenario, fmu, plant, commands, parts.seed).links()
    recorder = Recorder(fmu, plant, loop.steps, loop.record_every)
    page, interrupt = parts.place.page, parts.interrupt

    k = 0
    page.stage = Stage.STEP_PLANT
    try:
        for k in range(loop.steps):
            page.step = k
            # time is never accumulated
            time = k * loop.step
            # sample: ideal readings become what the controller sees
            carry_readings(links, plant, k)
            # compute: the controller moves first
            page.stage = Stage.STEP
            fmu.set()
            fmu.step(time, loop.step)
            fmu.get()
            page.stage = Stage.STEP_PLANT
            # act: the commands of this step, or of `compute_delay` steps ago
            carry_outputs(links, k)
            plant.command(commands)
            row = recorder.record(k, time)
            # move the plant to the next communication point
            plant.advance(loop.substeps)

            interrupt()
            if stop_when is not None and row is not None and stop_when(row):
                break
            if progress is not None and k % PROGRESS_EVERY == 0:
                progress(k, loop.steps)
    except (Exception, SystemExit) as error:
        raise located(error, fmu, scenario, k) from error
    return Recording(recorder.recorded(k + 1), k + 1)


def reset_plant(plant: Plant, scenario: Scenario, seed: np.random.SeedSequence) -> None:
    """Reset the plant for a new run.

    Raises
    ------
    PlantError
        The plant failed.
    """
    try:
        plant.reset(seed, scenario.loop.duration)
    except CosimError:
        raise
    except (Exception, SystemExit) as error:
        raise failed_plant(f"the plant `{scenario.plant.name}` cannot be reset", error) from error


def carry_readings(links: Links, plant: Plant, k: int) -> None:
    """Carry readings through their wires, then signals, then injections, into the inputs of the FMU."""
    links.sensed[:] = one_each(plant.sense(), plant.readings, "sense")
    for link in links.readings:
        carry(link, k)
    for drive in links.drives:
        drive.target.array[drive.target.index] = drive.target.convert(drive.course.item(k))
    inject(links.input_faults, k)


def carry_outputs(links: Links, k: int) -> None:
    """Carry outputs of the FMU through their wires, then injections, into the commands of the plant."""
    for link in links.outputs:
        carry(link, k)
    inject(links.command_faults, k)


def carry(link: Link, k: int) -> None:
    """Carry one value through its wire."""
    value = link.shape(float(link.source.array[link.source.index]), k)
    link.target.array[link.target.index] = link.target.convert(link.delay(value, k))


def inject(faults: list[Fault], k: int) -> None:
    """Replace values that arrive by those of the injections that are active."""
    for fault in faults:
        if fault.begin <= k < fault.end:
            fault.target.array[fault.target.index] = fault.value


def located(error: Exception | SystemExit, fmu: Instance, scenario: Scenario, k: int) -> CosimError:
    """Error of a run with step and time, and with the FMU's own words if it was the FMU."""
    when = f"at t = {k * scenario.loop.step:.9g} s (step {k})"
    if isinstance(error, FMICallException):
        return fmu.failure(f"the FMU failed {when}", error)
    if isinstance(error, CosimError):
        return type(error)(f"{error.message} {when}", error.hint)
    return failed_plant(f"the plant `{scenario.plant.name}` failed {when}", error)


def failed_plant(action: str, error: Exception | SystemExit) -> PlantError:
    """Error of a plant's own code; a hint in its text becomes ours."""
    problem, _, hint = str(error).partition("\nhint: ")
    return PlantError(f"{action}: {type(error).__name__}: {problem}", hint or "`-v` shows where")
