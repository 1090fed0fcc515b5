"""The reference engine: plain code that specifies one step of a closed loop."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import numpy as np
from fmpy.fmi1 import FMICallException
from numpy.typing import NDArray

from cosim.errors import CosimError, PlantError
from cosim.fmu.instance import Instance
from cosim.loop.condition import Program
from cosim.loop.plant import Plant, one_each, problem_and_hint
from cosim.loop.position import Position, Stage
from cosim.loop.recorder import Recorder, Sink
from cosim.loop.wires.connect import Connector
from cosim.loop.wires.connections import Connections, Inputs, Slot
from cosim.loop.wires.fault import NEVER
from cosim.loop.wires.transform import child, first_step
from cosim.metrics.expression import Expression
from cosim.scenario.model import Scenario

Progress = Callable[[int, int], None]
"""Called periodically with the completed and the total number of steps."""
PROGRESS_EVERY = 500


class Recording(NamedTuple):
    """Outcome of a run: the table of its trace, the completed steps, and the first step of each injection."""

    table: NDArray[np.float64]
    steps: int
    begins: NDArray[np.float64]


@dataclass(frozen=True)
class Parts:
    """Inputs of a run: FMUs in the order of the scenario, plant and connections after `initialise`.

    The run ends in the first row for which `stop_when` is true. `when` holds the start conditions of the
    injections, or None. `interrupt` is called after every step and may raise. `position` records whose code
    runs. `sink` receives the rows of the trace; without it they are kept.
    """

    scenario: Scenario
    fmus: Sequence[Instance]
    plant: Plant
    connections: Connections
    stop_when: Expression | None = None
    when: Sequence[Expression | None] = ()
    progress: Progress | None = None
    interrupt: Callable[[], None] = lambda: None
    position: Position = field(default_factory=Position)
    sink: Sink | None = None


@dataclass(frozen=True)
class Trigger:
    """Starts an injection `delay` steps after the first row that meets a condition: writes its `begin`.

    `program` is the condition for native code, if it can evaluate it.
    """

    condition: Expression
    delay: int
    begin: Slot
    program: Program | None = None

    def __call__(self, row: NDArray[np.float64], k: int) -> None:
        """Evaluate the row of step `k`."""
        if self.begin.read() == NEVER and self.condition(row):
            self.begin.write(k + self.delay)


def run(parts: Parts) -> Recording:
    """Run FMUs and plant in closed loop; an error names step and time.

    The row of step `k` holds the time `k * step`, the inputs of the FMUs at that time, the outputs computed
    from them, and the ground truth of the plant at that time.
    """
    recorder = recording(parts)
    k = 0
    for k, _ in steps(parts, recorder):  # noqa: B007
        pass
    return recorded(parts, recorder, k + 1)


def recording(parts: Parts) -> Recorder:
    """Return the recorder of a run."""
    loop = parts.scenario.loop
    recorder = Recorder(parts.fmus, parts.plant, loop.steps, loop.record_every, parts.sink)
    recorder.sensed[:] = parts.connections.sensed
    return recorder


def recorded(parts: Parts, recorder: Recorder, steps: int) -> Recording:
    """End a run without an error; log what its FMUs reported."""
    parts.position.end_steps([choice.label for choice in parts.scenario.fmus])
    for fmu in parts.fmus:
        fmu.report()
    return Recording(recorder.recorded(steps), steps, parts.connections.begins)


def initialise(
    scenario: Scenario, fmus: Sequence[Instance], plant: Plant, seed: int, position: Position
) -> Connections:
    """Reset the plant, and initialize the FMUs in their order with their inputs of t = 0.

    Inputs of an FMU whose source is initialized later keep their start values until the first step. The
    measurements of t = 0 are in `sensed` of the result; the first step does not sample again.
    """
    position.at(Stage.RESET_PLANT)
    reset_plant(plant, scenario, child(seed, "plant"))
    position.at(Stage.NONE)
    connector = Connector(scenario, fmus, plant, seed)
    connections = connector.connections()
    loop = scenario.loop
    position.at(Stage.STEP_PLANT)
    with locating(fmus[0], scenario):
        connections.sensed[:] = one_each(plant.sense(), plant.readings, "sense")
    for choice, fmu, inputs in zip(scenario.fmus, fmus, connections.fmus, strict=True):
        position.at(Stage.INITIALISE, choice.label)
        every = loop.every(choice.step)
        last = (loop.steps - 1) // every * every * loop.step
        # the last step of a slower FMU may end after the run
        stop = max(loop.duration, last + every * loop.step)
        fmu.initialise(choice.parameters, stop, partial(arrive_first, inputs, fmu, scenario))
    position.at(Stage.NONE)
    connector.prime()
    return connections


def arrive_first(inputs: Inputs, fmu: Instance, scenario: Scenario) -> None:
    """Write the inputs of t = 0 of an FMU in its initialization mode."""
    if inputs.held or any(wire.late for wire in inputs.wires):
        fmu.read_inputs()
    for stimulus in inputs.held:
        stimulus.samples.fill(stimulus.target.read())
    with locating(fmu, scenario):
        for wire in inputs.wires:
            if not wire.late:
                # a delay starts with the first value
                wire.target.write(wire.transformed(0))
        arrive(Inputs(stimuli=inputs.stimuli, faults=inputs.faults), 0)


def steps(parts: Parts, recorder: Recorder) -> Generator[tuple[int, NDArray[np.float64] | None]]:
    """Do one step after the other; yield its number and its row, None if it is not recorded."""
    scenario, plant, connections = parts.scenario, parts.plant, parts.connections
    stop_when, progress, loop = parts.stop_when, parts.progress, scenario.loop
    triggers = triggers_of(parts)
    position, page, interrupt = parts.position, parts.position.page, parts.interrupt
    rates = [(choice.label, loop.every(choice.step)) for choice in scenario.fmus]
    fmus = list(zip(rates, parts.fmus, connections.fmus, strict=True))

    k, fmu, ended = 0, parts.fmus[0], False
    page.stage = Stage.STEP_PLANT
    try:
        for k in range(loop.steps):
            page.step = k
            # time is never accumulated
            time = k * loop.step
            # sample: ideal readings, which wires make what the FMUs see
            if k:
                connections.sensed[:] = one_each(plant.sense(), plant.readings, "sense")
                np.minimum(recorder.sensed, connections.sensed, out=recorder.sensed)
            # compute: the FMUs move first, one after the other
            for (name, every), fmu, inputs in fmus:
                arrive(inputs, k)
                if k % every == 0:
                    position.at(Stage.STEP, name)
                    ended |= fmu.compute(time, every * loop.step)
                    page.stage = Stage.STEP_PLANT
            # act: the commands of this step, or of `compute_delay` steps ago
            arrive(connections.plant, k)
            plant.command(connections.commands)
            recorder.room(k)
            row = recorder.record(k, time)
            if row is not None:
                for trigger in triggers:
                    trigger(row, k)
            # move the plant to the next communication point
            plant.advance(loop.substeps)

            interrupt()
            yield k, row
            if ended or (stop_when is not None and row is not None and stop_when(row)):
                break
            if progress is not None and k % PROGRESS_EVERY == 0:
                progress(k, loop.steps)
    except (KeyboardInterrupt, GeneratorExit):
        raise
    except BaseException as error:  # a panic of Rust is no `Exception`
        # on Windows an access violation in the library of an FMU is an OSError
        if page.stage == Stage.STEP and isinstance(error, OSError):
            raise fmu.crashed(f"{fmu.owner.who} failed {moment(scenario, k)}", error) from error
        raise located(error, fmu, scenario, k) from error


@contextlib.contextmanager
def locating(fmu: Instance, scenario: Scenario) -> Iterator[None]:
    """Raise errors of foreign code before the first step as those of step 0."""
    try:
        yield
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a panic of Rust is no `Exception`
        raise located(error, fmu, scenario, 0) from error


def triggers_of(parts: Parts) -> list[Trigger]:
    """Triggers of the injections that start with a condition."""
    begins, step = parts.connections.begins, parts.scenario.loop.step
    # the row of a step is complete only after its injections
    return [
        Trigger(condition, max(1, first_step(entry.after, step)), Slot(begins, index))
        for index, (entry, condition) in enumerate(zip(parts.scenario.inject, parts.when, strict=False))
        if condition is not None
    ]


def reset_plant(plant: Plant, scenario: Scenario, seed: np.random.SeedSequence) -> None:
    """Reset the plant for a new run."""
    try:
        plant.reset(seed, scenario.loop.duration)
    except (CosimError, KeyboardInterrupt):
        raise
    except BaseException as error:  # a panic of Rust is no `Exception`
        raise failed_plant(f"the plant `{scenario.plant.name}` cannot be reset", error) from error


def arrive(inputs: Inputs, k: int) -> None:
    """Apply wires, then signals, then injections to their targets."""
    for wire in inputs.wires:
        wire.target.write(wire.delay(wire.transformed(k), k))
    for stimulus in inputs.stimuli:
        stimulus.target.write(stimulus.samples.item(k))
    for fault in inputs.faults:
        since = k - fault.begin.read()
        value = fault.change(fault.target.read(), k, since)
        # before it starts, an injection only observes what arrives
        if 0.0 <= since < fault.length:
            fault.target.write(value)


def located(error: BaseException, fmu: Instance, scenario: Scenario, k: int) -> CosimError:
    """Error of a run with step and time, and with the message of the FMU if it failed."""
    when = moment(scenario, k)
    if isinstance(error, FMICallException):
        return fmu.failure(f"{fmu.owner.who} failed {when}", error)
    if isinstance(error, CosimError):
        return type(error)(f"{error.message} {when}", error.hint)
    return failed_plant(f"the plant `{scenario.plant.name}` failed {when}", error)


def moment(scenario: Scenario, k: int) -> str:
    """Time and number of a step in messages."""
    return f"at t = {k * scenario.loop.step:.9g} s (step {k})"


def failed_plant(action: str, error: BaseException) -> PlantError:
    """Error of a plant's code; a hint in its text becomes the hint of the error."""
    problem, hint = problem_and_hint(error)
    return PlantError(f"{action}: {type(error).__name__}: {problem}", hint or "Show the origin with `-v`.")
