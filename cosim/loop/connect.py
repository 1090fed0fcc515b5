"""Names become places: wires, signals and injections are tied to the arrays of FMU and plant."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError, ScenarioError, closest, concerning
from cosim.fmu.archive import FmuFile, Variable
from cosim.fmu.instance import BASE, Instance
from cosim.fmu.values import encode, lookup
from cosim.loop.course import find, read, sample
from cosim.loop.plant import Channel, Plant
from cosim.loop.wiring import Delay, Shape, first_step, noise, shaper
from cosim.scenario.model import Injection, Scenario, Signal, Wire
from cosim.scenario.tables import show


def truth(value: float) -> int:
    """Boolean of a number: everything but 0 is true."""
    return int(value != 0.0)


def whole(value: float) -> int:
    """Integer of a number, rounded half to even."""
    number = round(value) if math.isfinite(value) else 2**31
    if not abs(number) < 2**31:
        raise CosimError(f"an integer input got `{value}`, it takes 32 bits")
    return number


CONVERT: dict[str, Callable[[float], Any]] = {"Real": float, "Integer": whole, "Boolean": truth}
"""What a number becomes on writing."""
KINDS = {"Integer": "an integer or an enumeration", "Boolean": "a Boolean"}


@dataclass(frozen=True)
class Slot:
    """Where a value is read or written: `array[index]`, a `Real`, `Integer` or `Boolean`."""

    array: NDArray[Any]
    index: int
    kind: str = "Real"
    convert: Callable[[float], Any] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "convert", CONVERT[self.kind])


@dataclass(frozen=True)
class Link:
    """One wire, ready to carry values."""

    source: Slot
    target: Slot
    shape: Shape
    delay: Delay


@dataclass(frozen=True)
class Drive:
    """One signal: `course[k]` is written in step `k`."""

    course: NDArray[np.float64]
    target: Slot


@dataclass(frozen=True)
class Fault:
    """One injection: `value` is written in the steps `begin <= k < end`."""

    begin: int
    end: int
    value: Any
    target: Slot


@dataclass(frozen=True)
class Links:
    """All connections of a run; `sensed` takes the ideal readings of a step, `commands` the commands."""

    sensed: NDArray[np.float64]
    commands: NDArray[np.float64]
    readings: list[Link]
    drives: list[Drive]
    input_faults: list[Fault]
    outputs: list[Link]
    command_faults: list[Fault]


def driven(scenario: Scenario, file: FmuFile) -> list[Variable]:
    """List the inputs and tunable parameters of the FMU that something drives, in its order.

    Raises
    ------
    CosimError
        A target that does not exist or takes no values during a run.
    """
    names = set()
    for section, item in targets(scenario):
        side, _, name = item.partition(".")
        if side != "controller":
            continue
        with concerning(f"{section}.{item}.to"):
            variable = lookup(file.variables, name)
            tunable = variable.causality == "parameter" and variable.variability == "tunable"
            if (variable.causality != "input" and not tunable) or variable.kind == "String":
                raise ScenarioError(
                    f"`{item}` is no input and no tunable parameter of the FMU",
                    closest(name, [v.name for v in file.named("input")]),
                )
            names.add(name)
    return [variable for name, variable in file.variables.items() if name in names]


def targets(scenario: Scenario) -> list[tuple[str, str]]:
    """Section and target of everything that writes a value."""
    return [
        *(("wire", wire.to) for wire in scenario.wire),
        *(("signal", signal.to) for signal in scenario.signal),
        *(("inject", injection.to) for injection in scenario.inject),
    ]


class Connector:
    """Ties the names of a scenario to an FMU instance, a plant and its array of commands."""

    def __init__(
        self, scenario: Scenario, fmu: Instance, plant: Plant, commands: NDArray[np.float64], seed: int
    ) -> None:
        self.scenario, self.fmu, self.seed, self.commands = scenario, fmu, seed, commands
        self.sensed = np.zeros(len(plant.readings))
        self.readings = {channel.name: (i, channel) for i, channel in enumerate(plant.readings)}
        self.channels = {channel.name: (i, channel) for i, channel in enumerate(plant.commands)}

    def links(self) -> Links:
        """Build all connections; the FMU must have been initialised, its outputs prime the delays."""
        readings, outputs = [], []
        for wire in self.scenario.wire:
            with concerning(f"wire.{wire.to}"):
                if wire.to.startswith("controller."):
                    readings.append(self.reading(wire))
                else:
                    outputs.append(self.output(wire))
        drives = [*(self.drive(signal) for signal in self.scenario.signal), *self.holds()]
        faults: dict[bool, list[Fault]] = {True: [], False: []}
        for injection in self.scenario.inject:
            faults[injection.to.startswith("controller.")].append(self.fault(injection))
        return Links(self.sensed, self.commands, readings, drives, faults[True], outputs, faults[False])

    def reading(self, wire: Wire) -> Link:
        """Wire from a reading of the plant to an input of the FMU."""
        side, _, name = wire.source.partition(".")
        if side != "plant":
            raise ScenarioError(
                f"`from` = `{wire.source}`: an input of the controller takes a `plant.` reading"
            )
        index, channel = self.channel(self.readings, name, "reading")
        shape = shaper(wire, channel, True, noise(wire, channel, self.seed, self.scenario.loop.steps))
        return Link(Slot(self.sensed, index), self.target(wire.to), shape, Delay(wire.delay))

    def output(self, wire: Wire) -> Link:
        """Wire from an output of the FMU to a command of the plant."""
        target = self.target(wire.to)
        side, _, name = wire.source.partition(".")
        if side != "controller":
            raise ScenarioError(
                f"`from` = `{wire.source}`: a command of the plant takes a `controller.` output"
            )
        variable = lookup(self.fmu.file.variables, name)
        source = self.find(self.fmu.outputs, variable)
        if source is None:
            raise ScenarioError(
                f"`from` = `{wire.source}` is no numeric output of the FMU",
                closest(name, [v.name for v in self.fmu.file.named("output")]),
            )
        loop = self.scenario.loop
        _, channel = self.channels[wire.to.partition(".")[2]]
        shape = shaper(wire, channel, False, noise(wire, channel, self.seed, loop.steps))
        delay = Delay(wire.delay + loop.compute_delay)
        # before its first result arrives the plant gets what the initialised FMU puts out
        delay.prime(shape(float(source.array[source.index]), 0))
        return Link(source, target, shape, delay)

    def drive(self, signal: Signal) -> Drive:
        """Signal to an input of the FMU or a command of the plant."""
        with concerning(f"signal.{signal.to}"):
            loop, target = self.scenario.loop, self.target(signal.to)
            if signal.interpolation == "linear" and target.kind != "Real":
                problem = f"`{signal.to}` takes no values in between, it is {KINDS[target.kind]}"
                raise ScenarioError(problem, 'set `interpolation = "hold"`')
            times, values = self.course(signal)
            return Drive(sample(times, values, loop.step, loop.steps, signal.interpolation), target)

    def course(self, signal: Signal) -> tuple[Any, Any]:
        """Tell times and values of a signal, each value checked against what its target takes."""
        if not signal.file:
            return signal.times, [self.number(signal.to, value) for value in signal.values]
        found = read(find(signal.file, self.scenario.folder), signal.column)
        if self.target(signal.to).kind != "Real":
            for value, index in zip(*np.unique(found.values, return_index=True), strict=True):
                try:
                    self.number(signal.to, value.item())
                except CosimError as error:
                    raise ScenarioError(f"{found.place(index)}: {error.message}", error.hint) from None
        return found.times, found.values

    def holds(self) -> list[Drive]:
        """Hold the start values of inputs that only injections write, so that they come back afterwards."""
        written = {to for section, to in targets(self.scenario) if section != "inject"}
        only = dict.fromkeys(entry.to for entry in self.scenario.inject if entry.to not in written)
        holds = []
        for to in only:
            place = self.target(to)
            holds.append(Drive(np.full(self.scenario.loop.steps, float(place.array[place.index])), place))
        return holds

    def fault(self, injection: Injection) -> Fault:
        """Injection at an input of the FMU or a command of the plant."""
        with concerning(f"inject.{injection.to}"):
            step = self.scenario.loop.step
            target = self.target(injection.to)
            value = target.convert(self.number(injection.to, injection.value))
            return Fault(
                first_step(injection.from_time, step), first_step(injection.to_time, step), value, target
            )

    def number(self, to: str, value: Any) -> float:
        """Value of a stimulus as a number; enumeration items may be given by name."""
        side, _, name = to.partition(".")
        if side == "controller":
            return float(encode(self.fmu.file.variables[name], value))
        if not isinstance(value, int | float):
            raise ScenarioError(f"`{to}` is {show(value)}, it must be a number")
        return float(value)

    def target(self, to: str) -> Slot:
        """Slot of `controller.<input>` or `plant.<command>`."""
        side, _, name = to.partition(".")
        if side == "plant":
            index, _ = self.channel(self.channels, name, "command")
            return Slot(self.commands, index)
        place = None
        if side == "controller":
            place = self.find(self.fmu.inputs, lookup(self.fmu.file.variables, name))
        if place is None:
            raise ScenarioError(f"`to` = `{to}`, it must be `controller.<input>` or `plant.<command>`")
        return place

    def find(self, banks: list[Any], variable: Variable) -> Slot | None:
        """Slot of a variable in the banks of the FMU."""
        for bank in banks:
            if variable in bank.variables:
                return Slot(bank.values, bank.variables.index(variable), BASE[variable.kind])
        return None

    def channel(self, channels: dict[str, tuple[int, Channel]], name: str, kind: str) -> tuple[int, Channel]:
        """Index and channel by name."""
        if not self.scenario.plant.name:
            raise ScenarioError(
                f"`plant.{name}`: the scenario has no plant", "name one: `[plant]` with `name = ...`"
            )
        if name not in channels:
            hint = closest(name, channels) or f"it has no {kind}s at all; of an MJCF they are what has a name"
            raise ScenarioError(f"the plant `{self.scenario.plant.name}` has no {kind} `{name}`", hint)
        return channels[name]
