"""The surroundings of the FMUs as an FMU of PythonFMU: plant, noise and limits of the wires, signals.

It imports this package, which the Python of the master must have installed.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from pythonfmu import Boolean, DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real

from cosim import paths
from cosim.fmu.values import encode
from cosim.loop import plant, time_series
from cosim.loop.wires.connect import PLANT
from cosim.loop.wires.connections import CONVERT
from cosim.loop.wires.transform import Delay, Shape, child, noise, shaper
from cosim.scenario.load import load
from cosim.scenario.model import Scenario, Signal
from cosim.ssp.ports import Port

SETTINGS = "loop.json"
"""Resource that names the file of the scenario, its overrides, the seed, and the ports of the FMUs."""
KINDS = {"Real": Real, "Integer": Integer, "Enumeration": Integer, "Boolean": Boolean}
STEP_TOLERANCE = 1e-6


class Surroundings(Fmi2Slave):
    """Plant, wires and signals of a scenario.

    Its outputs drive the inputs of the FMUs and have their names. Its inputs are the outputs of the FMUs
    that command the plant. Measurements and ground truth of the plant are outputs as well, `plant.<name>`.
    """

    author = "The Machining FMUs developers"
    description = "Plant, noise and limits of the wires, and signals of a closed loop"

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        settings = json.loads(Path(self.resources, SETTINGS).read_text(encoding="utf-8"))
        # a whole path stays as it is
        self.scenario: Scenario = load(str(paths.OWN_SCENARIOS / settings["loop"]), settings["set"])
        self.seed: int = settings["seed"]
        loop = self.scenario.loop
        self.default_experiment = DefaultExperiment(0.0, loop.duration, loop.step)
        # the FMUs need not be where this one runs
        driven, commanding = (tuple(map(Port.of, settings[end])) for end in ("driven", "commanding"))
        choice = self.scenario.plant
        self.plant = plant.build(choice.name, choice.parameters, self.scenario.folder)
        self.commands = plant.starts(self.plant.commands)
        self.places = {f"{PLANT}.{channel.name}": k for k, channel in enumerate(self.plant.commands)}
        self.channels = {f"{PLANT}.{channel.name}": channel for channel in self.plant.readings}
        self.measured = [f"{PLANT}.{one.name}" for one in (*self.plant.readings, *self.plant.truths)]
        self.k = 0
        self.given = {port.name: start(port) for port in commanding}
        self.driven = {port.name: start(port) for port in driven}
        self.seen = dict.fromkeys(self.measured, 0.0)
        self.kinds = {port.name: port.variable.kind for port in driven}
        # what is left is the start value of an input
        signals = [one for one in self.scenario.signal if one.to in self.places or one.to in self.driven]
        self.signals = {signal.to: self.samples(signal, driven) for signal in signals}
        self.links: list[tuple[str, str, Shape, Delay]] = []
        for port in commanding:
            self.put(port.name, port.variable.kind, self.given, Fmi2Causality.input)
        for port in driven:
            self.put(port.name, port.variable.kind, self.driven, Fmi2Causality.output)
        for name in self.seen:
            self.put(name, "Real", self.seen, Fmi2Causality.output)
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.register_variable(Integer("seed", **fixed, description="Seed of all noise"))

    def put(self, name: str, kind: str, values: dict[str, float], causality: Any) -> None:
        """Register a variable whose value is kept in a table."""
        continuous = Fmi2Variability.continuous if kind == "Real" else Fmi2Variability.discrete
        made = KINDS[kind](name, causality=causality, variability=continuous)
        made.getter = lambda: values[name]
        made.setter = lambda value: values.__setitem__(name, float(value))
        self.register_variable(made, nested=False)

    def samples(self, signal: Signal, driven: tuple[Port, ...]) -> Any:
        """Values of a signal, one for each step and one for the end."""
        loop = self.scenario.loop
        times: Any = signal.times
        values: Any
        if signal.file:
            found = time_series.read(time_series.find(signal.file, self.scenario.folder), signal.column)
            times, values = found.times, found.values
        else:
            variable = next((port.variable for port in driven if port.name == signal.to), None)
            values = [float(encode(variable, value) if variable else value) for value in signal.values]
        return time_series.sample(times, values, loop.step, loop.steps + 1, signal.interpolation)

    def exit_initialization_mode(self) -> None:
        """Initialize the plant and take the first measurements."""
        loop = self.scenario.loop
        commands = {to: self.plant.commands[place] for to, place in self.places.items()}
        self.links.clear()
        for wire in self.scenario.wire:
            from_plant = wire.source in self.channels
            if channel := self.channels.get(wire.source) or commands.get(wire.to):
                samples = noise(wire, channel, self.seed, loop.steps + 1)
                shape = shaper(wire, channel, from_plant, samples)
                self.links.append((wire.source, wire.to, shape, Delay(wire.delay)))
        self.k = 0
        self.plant.reset(child(self.seed, PLANT), loop.duration)
        self.look()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Command the plant, advance it, and read its new state."""
        loop = self.scenario.loop
        if abs(step_size - loop.step) > STEP_TOLERANCE * loop.step:
            raise ValueError(f"the communication step is {step_size} s, but the scenario has {loop.step} s")
        # what is given was put out in the step before
        sample = min(max(self.k - 1, 0), loop.steps)
        for source, to, shape, delay in self.links:
            if to in self.places:
                self.commands[self.places[to]] = delay(shape(self.given[source], sample), self.k)
        for to, values in self.signals.items():
            if to in self.places:
                self.commands[self.places[to]] = values.item(self.at(values))
        self.plant.command(self.commands)
        self.plant.advance(loop.substeps)
        self.k += 1
        self.look()
        return True

    def look(self) -> None:
        """Read measurements and ground truth of the plant, and the inputs of the FMUs."""
        loop = self.scenario.loop
        values = np.concatenate([self.plant.sense(), self.plant.truth()])
        self.seen.update(zip(self.measured, map(float, values), strict=True))
        for source, to, shape, delay in self.links:
            if source in self.seen:
                self.drive(to, delay(shape(self.seen[source], min(self.k, loop.steps)), self.k))
        for to, samples in self.signals.items():
            if to not in self.places:
                self.drive(to, samples.item(self.at(samples)))

    def at(self, values: Any) -> int:
        """Index of the present step in a signal, which holds its last value."""
        return min(self.k, len(values) - 1)

    def drive(self, to: str, value: float) -> None:
        """Write an output as the type that its input has."""
        kind = self.kinds[to]
        self.driven[to] = CONVERT["Integer" if kind == "Enumeration" else kind](value)


def start(port: Port) -> float:
    """Start value of a variable as a number."""
    text = port.variable.start
    return float({"true": "1", "false": "0", "": "0"}.get(text, text))
