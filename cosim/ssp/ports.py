"""Ports of an SSP system: driven inputs, and outputs that drive the plant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

from cosim.errors import ScenarioError, concerning
from cosim.fmu.description import FmuFile, Variable
from cosim.fmu.values import lookup
from cosim.loop.wires.connect import PLANT, side_of
from cosim.scenario.model import Scenario, Wire

KINDS = {"Enumeration": "Integer"}
"""Types that are converted in a connection."""
SHAPED = "an SSP cannot contain noise, quantum and limits of a wire between FMUs"


@dataclass(frozen=True)
class Port:
    """A variable of an FMU, `owner.variable.name` as in scenarios."""

    owner: str
    variable: Variable

    @property
    def name(self) -> str:
        """Name as in scenarios."""
        return f"{self.owner}.{self.variable.name}"

    def to_json(self) -> dict[str, Any]:
        """Return the port as a JSON object."""
        return {"owner": self.owner, "variable": asdict(replace(self.variable, display=None))}

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> Port:
        """Return the port of a JSON object."""
        variable = table["variable"]
        items = tuple((name, number) for name, number in variable["items"])
        return cls(table["owner"], Variable(**{**variable, "items": items}))


@dataclass(frozen=True)
class Ports:
    """Ends of the connections of a system.

    The surroundings drive the inputs `driven` of the FMUs, with measurements and signals, and get the outputs
    `commanding`. The wires `direct` are between FMUs. `held` are enumerations with a constant signal, by
    `owner.variable`. They become start values, because few masters connect enumerations.
    """

    driven: tuple[Port, ...]
    commanding: tuple[Port, ...]
    direct: tuple[Wire, ...]
    held: Mapping[str, Any]

    def starts(self, owner: str) -> dict[str, Any]:
        """Start values of the constant inputs of an FMU, by their names."""
        prefix = f"{owner}."
        return {to.removeprefix(prefix): value for to, value in self.held.items() if to.startswith(prefix)}


def ports_of(scenario: Scenario, files: Mapping[str, FmuFile]) -> Ports:
    """Return the ports of a valid scenario; an error names what an SSP system cannot contain."""
    check(scenario)

    def port(key: str, end: str) -> Port:
        owner, _, name = end.partition(".")
        with concerning(key):
            variable = lookup(files[owner].variables, name)
        if (causality := variable.causality) not in ("input", "output"):
            problem = f"`{end}` has causality `{causality}`: masters of SSP connect inputs and outputs"
            hint = "Build an FMU of `cargo fmu` with `--outputs all`." if causality == "local" else ""
            raise rejected(key, problem, hint)
        return Port(owner, variable)

    targets = [("wire", wire.to) for wire in scenario.wire if side_of(wire.source) == PLANT]
    targets += [("signal", signal.to) for signal in scenario.signal if side_of(signal.to) != PLANT]
    driven = {to: port(f"{section}.{to}.to", to) for section, to in targets}
    items = {to for to, port in driven.items() if port.variable.kind == "Enumeration"}
    constant = [signal for signal in scenario.signal if len(signal.values) == 1]
    held = {signal.to: signal.values[0] for signal in constant if signal.to in items}
    commands = [wire for wire in scenario.wire if side_of(wire.to) == PLANT]
    commanding = {wire.source: port(f"wire.{wire.to}.from", wire.source) for wire in commands}
    direct = tuple(wire for wire in scenario.wire if is_direct(wire))
    for wire in direct:
        check_types(wire, port(f"wire.{wire.to}.from", wire.source), port(f"wire.{wire.to}.to", wire.to))
    connected = tuple(port for to, port in driven.items() if to not in held)
    return Ports(connected, tuple(commanding.values()), direct, held)


def is_direct(wire: Wire) -> bool:
    """Whether a wire is between FMUs."""
    return PLANT not in (side_of(wire.source), side_of(wire.to))


def rejected(key: str, problem: str, hint: str = "") -> ScenarioError:
    """Error that concerns a key of the scenario."""
    error = ScenarioError(problem, hint)
    error.key = key
    return error


def check_types(wire: Wire, *ends: Port) -> None:
    """Check that masters can connect two variables, and change the value as the wire does."""
    start, end = (KINDS.get(end.variable.kind, end.variable.kind) for end in ends)
    if start != end:
        problem = f"`{wire.source}` is a {start} and `{wire.to}` a {end}"
        raise rejected(f"wire.{wire.to}", f"{problem}: masters of SSP connect variables of one type")
    other = next((end for end in ends if end.variable.kind != "Real"), None)
    if other and (wire.scale, wire.offset) != (1.0, 0.0):
        problem = f"`scale` and `offset` cannot change `{other.name}`, a {other.variable.kind}"
        raise rejected(f"wire.{wire.to}", f"{problem}: masters of SSP transform Reals")


def check(scenario: Scenario) -> None:
    """Check that a scenario can be an SSP system, before its FMUs are open."""
    for injection in scenario.inject:
        problem = f"an SSP cannot contain the injection at `{injection.to}`"
        raise rejected(f"inject.{injection.to}", problem, 'Set `drop = ["inject"]`.')
    if scenario.loop.compute_delay != 1:
        problem = "`loop.compute_delay` = 0: masters of SSP propagate outputs at the end of a step"
        hint = "Set `loop.compute_delay = 1`, and `io_delay = 1` in the controller."
        raise rejected("loop.compute_delay", problem, hint)
    for choice in scenario.fmus:
        if choice.step not in (None, scenario.loop.step):
            problem = f"the step {choice.step:g} s of `{choice.name}` differs from `loop.step`"
            raise rejected(f"{choice.name}.step", problem, "Use one communication step in an SSP system.")
    for wire in filter(is_direct, scenario.wire):
        problem = f"the wire to `{wire.to}`"
        if wire.noise or wire.quantum or wire.minimum is not None or wire.maximum is not None:
            raise rejected(f"wire.{wire.to}", f"{problem} cannot be a connection: {SHAPED}")
        if wire.delay != 1:
            hint = "Set `delay = 1`: masters propagate outputs at the end of a step."
            problem += f" with `delay` = {wire.delay} cannot be a connection"
            raise rejected(f"wire.{wire.to}.delay", problem, hint)
