"""Ports of an SSP system: driven inputs, and outputs that drive the plant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

from cosim.errors import ScenarioError, concerning
from cosim.fmu.archive import FmuFile, Variable
from cosim.fmu.values import lookup
from cosim.loop.wires.connect import PLANT, side_of
from cosim.scenario.model import Scenario, Signal, Wire

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

    Parameters
    ----------
    driven
        Inputs of the FMUs that the surroundings drive, with measurements and signals.
    commanding
        Outputs of the FMUs to the surroundings.
    direct
        Wires between FMUs.
    held
        Enumerations with a constant signal, by `owner.variable`. They become start values, because few
        masters connect enumerations.
    """

    driven: tuple[Port, ...]
    commanding: tuple[Port, ...]
    direct: tuple[Wire, ...]
    held: Mapping[str, Any]

    def starts(self, owner: str) -> dict[str, Any]:
        """Start values of the constant inputs of an FMU, by their names."""
        return {
            name: value
            for end, value in self.held.items()
            for to, _, name in [end.partition(".")]
            if to == owner
        }


def ports_of(scenario: Scenario, files: Mapping[str, FmuFile]) -> Ports:
    """Return the ports of a valid scenario.

    Raises
    ------
    ScenarioError
        The scenario cannot be represented as an SSP system.
    """
    check(scenario)

    def port(section: str, key: str, end: str) -> Port:
        owner, _, name = end.partition(".")
        with concerning(f"{section}.{key}"):
            variable = lookup(files[owner].variables, name)
            if variable.causality not in ("input", "output"):
                problem = f"`{end}` has causality `{variable.causality}`"
                hint = (
                    "Build an FMU of `cargo fmu` with `--outputs all`."
                    if variable.causality == "local"
                    else ""
                )
                raise ScenarioError(f"{problem}: masters of SSP connect inputs and outputs", hint)
        return Port(owner, variable)

    targets = [("wire", wire.to) for wire in scenario.wire if side_of(wire.source) == PLANT]
    targets += [("signal", signal.to) for signal in scenario.signal if side_of(signal.to) != PLANT]
    driven = {to: port(section, f"{to}.to", to) for section, to in targets}
    constant = {signal.to: signal.values[0] for signal in scenario.signal if is_constant(signal)}
    held = {
        to: value
        for to, value in constant.items()
        if to in driven and driven[to].variable.kind == "Enumeration"
    }
    commands = [wire for wire in scenario.wire if side_of(wire.to) == PLANT]
    commanding = {wire.source: port("wire", f"{wire.to}.from", wire.source) for wire in commands}
    direct = [wire for wire in scenario.wire if PLANT not in (side_of(wire.source), side_of(wire.to))]
    for wire in direct:
        ends = [
            port("wire", f"{wire.to}.{key}", end) for key, end in (("from", wire.source), ("to", wire.to))
        ]
        start, end = (KINDS.get(end.variable.kind, end.variable.kind) for end in ends)
        if start != end:
            with concerning(f"wire.{wire.to}"):
                problem = f"`{wire.source}` is a {start} and `{wire.to}` a {end}"
                raise ScenarioError(f"{problem}: masters of SSP connect variables of one type")
        strange = [end for end in ends if end.variable.kind != "Real"]
        if strange and (wire.scale, wire.offset) != (1.0, 0.0):
            with concerning(f"wire.{wire.to}"):
                problem = (
                    f"`scale` and `offset` cannot change `{strange[0].name}`, a {strange[0].variable.kind}"
                )
                raise ScenarioError(f"{problem}: masters of SSP transform Reals")
    connected = tuple(port for to, port in driven.items() if to not in held)
    return Ports(connected, tuple(commanding.values()), tuple(direct), held)


def is_constant(signal: Signal) -> bool:
    """Whether a signal is constant."""
    return len(signal.values) == 1


def check(scenario: Scenario) -> None:
    """Check that a scenario can be an SSP system.

    Raises
    ------
    ScenarioError
        It cannot; names the reason.
    """
    if scenario.inject:
        entry = scenario.inject[0].to
        with concerning(f"inject.{entry}"):
            raise ScenarioError(
                f"an SSP cannot contain the injection at `{entry}`", 'Set `drop = ["inject"]`.'
            )
    if scenario.loop.compute_delay != 1:
        with concerning("loop.compute_delay"):
            problem = "`loop.compute_delay` = 0: masters of SSP propagate outputs at the end of a step"
            raise ScenarioError(
                problem, "Set `loop.compute_delay = 1`, and `io_delay = 1` in the controller."
            )
    for choice in scenario.fmus:
        if choice.step not in (None, scenario.loop.step):
            with concerning(f"{choice.name}.step"):
                problem = f"the step {choice.step:g} s of `{choice.name}` differs from `loop.step`"
                raise ScenarioError(problem, "Use one communication step in an SSP system.")
    for wire in scenario.wire:
        between = PLANT not in (side_of(wire.source), side_of(wire.to))
        plain = (wire.noise or 0.0) == (wire.quantum or 0.0) == 0.0 and wire.minimum is wire.maximum is None
        if between and not plain:
            with concerning(f"wire.{wire.to}"):
                raise ScenarioError(f"the wire to `{wire.to}` cannot be a connection: {SHAPED}")
        if between and wire.delay != 1:
            with concerning(f"wire.{wire.to}.delay"):
                problem = f"the wire to `{wire.to}` with `delay` = {wire.delay} cannot be a connection"
                raise ScenarioError(
                    problem, "Set `delay = 1`: masters propagate outputs at the end of a step."
                )
