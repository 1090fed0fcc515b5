"""Connection of wires, signals and injections to the arrays of FMUs and plant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cosim.errors import CosimError, ScenarioError, closest, concerning, show, similar
from cosim.fmu.binding import Bank
from cosim.fmu.description import FmuFile, Variable
from cosim.fmu.instance import Instance
from cosim.fmu.values import encode, lookup
from cosim.loop.plant import Channel, Plant, starts
from cosim.loop.time_series import find, read, sample
from cosim.loop.wires.connections import Connection, Connections, Fault, Inputs, Slot, Stimulus
from cosim.loop.wires.fault import NEVER, effect, steps_of
from cosim.loop.wires.transform import Delay, Ideal, first_step, noise, shaper
from cosim.scenario.injection import INJECTED, Injection
from cosim.scenario.model import FmuChoice, Scenario, Signal, Wire

PLANT = "plant"
ARITHMETIC = ("offset", "scale", "ramp", "noise")
"""Kinds of injections that compute with a value."""
KINDS = {"Integer": "an integer or an enumeration", "Boolean": "a Boolean"}


def targets(scenario: Scenario) -> list[tuple[str, str]]:
    """Section and target of every wire, signal and injection."""
    sections = ("wire", scenario.wire), ("signal", scenario.signal), ("inject", scenario.inject)
    return [(section, entry.to) for section, entries in sections for entry in entries]


def side_of(end: str) -> str:
    """Name of the FMU or plant at an end of a wire, signal or injection."""
    return end.partition(".")[0]


def driven(scenario: Scenario, choice: FmuChoice, file: FmuFile) -> list[Variable]:
    """List the driven inputs and tunable parameters of an FMU, in its order; reject other targets."""
    names = set()
    for section, item in targets(scenario):
        side, _, name = item.partition(".")
        if side != choice.name:
            continue
        with concerning(f"{section}.{item}.to"):
            variable = lookup(file.variables, name, choice)
            tunable = variable.causality == "parameter" and variable.variability == "tunable"
            if (variable.causality != "input" and not tunable) or not variable.base:
                problem = f"`{item}` is not an input or tunable parameter of the FMU"
                raise ScenarioError(problem, closest(name, [v.name for v in file.named("input")]))
            names.add(name)
    return [variable for name, variable in file.variables.items() if name in names]


def is_late(wire: Wire, scenario: Scenario) -> bool:
    """Whether a wire ends at its source or at an FMU that steps before it.

    The value of the step is not yet known there, so a wire without a delay is rejected.
    """
    names = [choice.name for choice in scenario.fmus]
    source, target = side_of(wire.source), side_of(wire.to)
    if names.index(source) < names.index(target):
        return False
    if wire.delay:
        return True
    hint = "Set `delay = 1` to use the value of the previous step"
    if scenario.fmus[0].alone:
        problem = f"`from` = `{wire.source}`: an input of the controller needs a `plant.` measurement"
        raise ScenarioError(problem, f"Or use its own output with a delay. {hint}.")
    if source in reached(target, scenario):
        problem = (
            "closes an algebraic loop: all wires from its target back to its source act in the same step"
        )
    else:
        problem = f"is against the order of the steps {', '.join(f'`{name}`' for name in names)}"
        hint += f", or list `{source}` before `{target}`"
    raise ScenarioError(f"the wire from `{wire.source}` to `{wire.to}` without `delay` {problem}", hint)


def reached(start: str, scenario: Scenario) -> set[str]:
    """FMUs that depend on a given one in the same step, including itself."""
    names = {choice.name for choice in scenario.fmus}
    wires = [(side_of(wire.source), side_of(wire.to)) for wire in scenario.wire if not wire.delay]
    found, waiting = set[str](), [start]
    while waiting:
        name = waiting.pop()
        if name in names and name not in found:
            found.add(name)
            waiting += [target for source, target in wires if source == name]
    return found


class Connector:
    """Connects the names of a scenario to FMU instances and a plant."""

    def __init__(self, scenario: Scenario, fmus: Sequence[Instance], plant: Plant, seed: int) -> None:
        self.scenario, self.seed = scenario, seed
        self.fmus = {fmu.name: fmu for fmu in fmus}
        self.sensed, self.commands = np.zeros(len(plant.readings)), starts(plant.commands)
        self.readings = {channel.name: (i, channel) for i, channel in enumerate(plant.readings)}
        self.commanded = {channel.name: (i, channel) for i, channel in enumerate(plant.commands)}
        self.outputs: dict[str, Connection] = {}

    def connections(self) -> Connections:
        """Build all connections, before the FMUs are initialized; `prime` completes them afterwards."""
        sides = {name: Inputs() for name in (*self.fmus, PLANT)}
        for wire in self.scenario.wire:
            with concerning(f"wire.{wire.to}"):
                connection = self.connection(wire)
            sides[side_of(wire.to)].wires.append(connection)
            if side_of(wire.source) != PLANT:
                self.outputs[wire.to] = connection
        for signal in self.scenario.signal:
            with concerning(f"signal.{signal.to}"):
                stimulus = self.stimulus(signal)
            sides[side_of(signal.to)].stimuli.append(stimulus)
        # hold the start values of targets that only injections write, to restore them afterwards
        written = {to for section, to in targets(self.scenario) if section != "inject"}
        for to in dict.fromkeys(entry.to for entry in self.scenario.inject if entry.to not in written):
            target = self.target(to)
            hold = Stimulus(np.full(self.scenario.loop.steps, target.read()), target)
            sides[side_of(to)].stimuli.append(hold)
            sides[side_of(to)].held.append(hold)
        begins = np.full(len(self.scenario.inject), NEVER)
        for index, injection in enumerate(self.scenario.inject):
            with concerning(f"inject.{injection.to}"):
                fault = self.fault(injection, Slot(begins, index))
            sides[side_of(injection.to)].faults.append(fault)
        inputs = [sides[name] for name in self.fmus]
        return Connections(self.sensed, self.commands, inputs, sides[PLANT], begins)

    def prime(self) -> None:
        """Fill the delays of the outputs of initialized FMUs.

        Before its first result arrives, the other end gets what the initialized FMU puts out.
        """
        for to, connection in self.outputs.items():
            with concerning(f"wire.{to}"):
                connection.delay.prime(connection.transformed(0))

    def connection(self, wire: Wire) -> Connection:
        """Connect a wire according to its ends."""
        target, loop = self.target(wire.to), self.scenario.loop
        (side, _, name), (end, _, command) = wire.source.partition("."), wire.to.partition(".")
        channel: Channel = Ideal()
        delay, late = wire.delay, False
        if fmu := self.fmus.get(side):
            found = slot(fmu.outputs, lookup(fmu.file.variables, name, fmu.owner))
            if found is None:
                problem = f"`from` = `{wire.source}` is not a numeric output of {fmu.owner.who}"
                raise ScenarioError(problem, closest(name, [v.name for v in fmu.file.named("output")]))
            source = found
            if end == PLANT:
                _, channel = self.commanded[command]
                delay += loop.compute_delay
            else:
                # a late wire is read before its source steps, so it has one step of delay already
                late = is_late(wire, self.scenario)
                delay -= late
        elif end == PLANT:
            outputs = " or ".join(f"`{name}.`" for name in self.fmus)
            raise ScenarioError(f"`from` = `{wire.source}`: a command of the plant needs a {outputs} output")
        elif side != PLANT:
            outputs = "".join(f" or a `{name}.` output" for name in self.fmus if len(self.fmus) > 1)
            taken = f"an input of the {end} needs a `plant.` measurement{outputs}"
            raise ScenarioError(f"`from` = `{wire.source}`: {taken}")
        else:
            index, channel = self.channel(self.readings, name, "measurement")
            source = Slot(self.sensed, index)
        shape = shaper(wire, channel, side == PLANT, noise(wire, channel, self.seed, loop.steps))
        return Connection(source, target, shape, Delay(delay), late)

    def stimulus(self, signal: Signal) -> Stimulus:
        """Signal to an input of the FMU or a command of the plant; checks each value against its type."""
        loop, target, to = self.scenario.loop, self.target(signal.to), signal.to
        if signal.interpolation == "linear" and target.kind != "Real":
            problem = f"`{to}` cannot be interpolated, it is {KINDS[target.kind]}"
            raise ScenarioError(problem, 'Set `interpolation = "hold"`.')
        times: ArrayLike = signal.times
        values: ArrayLike = [self.number(to, value) for value in signal.values]
        if signal.file:
            found = read(find(signal.file, self.scenario.folder), signal.column)
            times, values = found.times, found.values
            distinct = np.unique(found.values, return_index=True) if target.kind != "Real" else ()
            for value, index in zip(*distinct, strict=True):
                try:
                    self.number(to, value.item())
                except CosimError as error:
                    raise ScenarioError(f"{found.location(index)}: {error.message}", error.hint) from None
        return Stimulus(sample(times, values, loop.step, loop.steps, signal.interpolation), target)

    def fault(self, injection: Injection, begin: Slot) -> Fault:
        """Injection at an input of the FMU or a command of the plant; its first step is stored in `begin`."""
        to, loop, target = injection.to, self.scenario.loop, self.target(injection.to)
        truth = target.kind == "Boolean"
        if injection.kind == "value":
            target.convert(self.number(to, injection.value))
        elif injection.kind in ARITHMETIC:
            side, _, name = to.partition(".")
            if truth or (side in self.fmus and self.fmus[side].file.variables[name].items):
                what = "a Boolean" if truth else "an enumeration"
                taken = ", ".join(f"`{one}`" for one in INJECTED if one not in ARITHMETIC)
                raise ScenarioError(f"`inject.{to}.{injection.kind}`: `{to}` is {what}", f"Use {taken}.")
        if injection.from_time is not None:
            begin.write(first_step(injection.from_time, loop.step))
        earlier = [other for other in self.scenario.inject[: begin.index] if other.to == to]
        name = f"inject.{to}" + (f".{len(earlier)}" if earlier else "")
        made = effect(injection, name, self.seed, loop, truth)
        return Fault(begin, steps_of(injection, loop), made, target)

    def number(self, to: str, value: Any) -> float:
        """Value of a stimulus as a number; enumeration items may be given by name."""
        side, _, name = to.partition(".")
        if fmu := self.fmus.get(side):
            return float(encode(fmu.file.variables[name], value, fmu.owner))
        if not isinstance(value, int | float):
            raise ScenarioError(f"`{to}` is {show(value)}, it must be a number")
        return float(value)

    def target(self, to: str) -> Slot:
        """Slot of `<fmu>.<input>` or `plant.<command>`."""
        side, _, name = to.partition(".")
        if side == PLANT:
            index, _ = self.channel(self.commanded, name, "command")
            return Slot(self.commands, index)
        found = None
        if fmu := self.fmus.get(side):
            found = slot(fmu.inputs, lookup(fmu.file.variables, name, fmu.owner))
        if found is None:
            inputs = ", ".join(f"`{known}.<input>`" for known in self.fmus)
            problem = f"`to` = `{to}`, it must be {inputs} or `plant.<command>`"
            raise ScenarioError(problem, similar(side, self.fmus))
        return found

    def channel(self, channels: dict[str, tuple[int, Channel]], name: str, kind: str) -> tuple[int, Channel]:
        """Index and channel by name."""
        if not self.scenario.plant.name:
            hint = "Add `[plant]` with `name = ...`."
            raise ScenarioError(f"`plant.{name}`: the scenario has no plant", hint)
        if name not in channels:
            hint = f"It has no {kind}s. In an MJCF file only named elements have channels."
            problem = f"the plant `{self.scenario.plant.name}` has no {kind} `{name}`"
            raise ScenarioError(problem, closest(name, channels) or hint)
        return channels[name]


def slot(banks: Sequence[Bank], variable: Variable) -> Slot | None:
    """Slot of a variable in the banks of its FMU."""
    for bank in banks:
        if variable in bank.variables:
            return Slot(bank.values, bank.variables.index(variable), variable.base)
    return None
