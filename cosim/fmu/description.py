"""Model description of an FMU: its variables, units and experiment."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cosim import units
from cosim.errors import FmuError
from cosim.fmu import members

INTEGERS = ("Integer", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
BASE = {
    **dict.fromkeys(("Real", "Float32", "Float64"), "Real"),
    **dict.fromkeys((*INTEGERS, "Enumeration"), "Integer"),
    "Boolean": "Boolean",
    **dict.fromkeys(("String", "Binary", "Clock"), ""),
}
"""Kind of number of each type of FMI 2.0 and 3.0; empty for those that are no numbers."""
NUMBERS: dict[str, Callable[[str], object]] = {"Real": float, "Integer": int}
"""Types of start values and limits."""


@dataclass(frozen=True)
class DisplayUnit:
    """Display unit: `factor` times the value in the unit of the variable, plus `offset`.

    A variable that is a difference (`relativeQuantity` of its declared type) has no offset.
    """

    name: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Variable:
    """One scalar variable of an FMU, or one element of an array of FMI 3.0.

    `kind` is the FMI type, such as Real, Float64 or Enumeration; `items` are the names and numbers of an
    enumeration. Texts are those of the model description, empty if not given. `settable` states whether it
    accepts a start value. `element` is its index in `array` in row-major order.
    """

    name: str
    reference: int
    kind: str
    causality: str
    variability: str
    description: str
    start: str
    unit: str
    minimum: str
    maximum: str
    items: tuple[tuple[str, int], ...] = ()
    display: DisplayUnit | None = None
    settable: bool = True
    array: str = ""
    element: int = 0

    @property
    def base(self) -> str:
        """Kind of number: Real, Integer or Boolean; empty if it is none."""
        return BASE[self.kind]


@dataclass(frozen=True)
class FmuFile:
    """A checked co-simulation FMU for this platform; `version` is the major version of FMI.

    `once` states that a process can instantiate it only once. `start_time` (s), `step_size` (s) and
    `tolerance` are those of its default experiment. `warning` names flaws of the model description.
    """

    path: Path
    folder: Path
    guid: str
    identifier: str
    name: str
    description: str
    variables: dict[str, Variable]
    version: int = 2
    once: bool = False
    start_time: float = 0.0
    step_size: float = 0.0
    tolerance: float | None = None
    warning: str = ""

    def named(self, causality: str) -> list[Variable]:
        """Return the variables of one causality in the order of the model description."""
        return [variable for variable in self.variables.values() if variable.causality == causality]

    def whole(self, variables: list[Variable]) -> list[Variable]:
        """Return variables with the other elements of their arrays, which FMI 3.0 transfers as a whole."""
        arrays = {variable.array for variable in variables} - {""}
        if not arrays:
            return variables
        names = {variable.name for variable in variables}
        return [one for one in self.variables.values() if one.name in names or one.array in arrays]


def describe(path: Path, folder: Path, description: Any) -> FmuFile:
    """Extract the required data of FMPy's model description."""
    displays = {
        (unit.name, display.name): DisplayUnit(display.name, float(display.factor), float(display.offset))
        for unit in description.unitDefinitions
        for display in unit.displayUnits
    }

    def experiment(name: str) -> float | None:
        text = getattr(description.defaultExperiment, name, None)
        return None if text is None else float(text)

    known = units.of_fmu(description.unitDefinitions)
    variables = [one for found in description.modelVariables for one in scalars(found, displays, known)]
    return FmuFile(
        path=path,
        folder=folder,
        guid=description.guid,
        identifier=description.coSimulation.modelIdentifier,
        name=description.modelName,
        description=description.description or "",
        variables={variable.name: variable for variable in variables},
        once=bool(description.coSimulation.canBeInstantiatedOnlyOncePerProcess),
        start_time=experiment("startTime") or 0.0,
        step_size=experiment("stepSize") or 0.0,
        tolerance=experiment("tolerance"),
    )


def scalars(
    variable: Any, displays: dict[tuple[str, str], DisplayUnit], known: dict[str, units.Definition]
) -> Iterator[Variable]:
    """Variable from that of FMPy, or the elements of an array; its type can be a declared type."""
    declared = variable.declaredType

    def attribute(name: str) -> str:
        own = getattr(variable, name)
        return str(own or (getattr(declared, name, None) if declared else None) or "")

    display = displays.get((attribute("unit"), attribute("displayUnit")))
    if attribute("relativeQuantity"):
        display = display and replace(display, offset=0.0)
        known = units.relative(known)
    exact = variable.variability != "constant" and variable.initial in ("exact", "approx")
    # a size is set in Configuration Mode, which is not used; FMPy reads only the first text of an array
    texts = variable.type == "String" and variable.shape
    unsupported = texts or variable.causality == "structuralParameter" or variable.type in ("Binary", "Clock")
    whole = Variable(
        name=variable.name,
        reference=variable.valueReference,
        kind=variable.type,
        # an alias of an input is no other input to drive
        causality="local" if variable.alias and variable.causality == "input" else variable.causality,
        variability=variable.variability or "continuous",
        description=variable.description or "",
        start=variable.start or "",
        unit=units.Unit(attribute("unit"), known),
        minimum=attribute("min"),
        maximum=attribute("max"),
        items=items_of(variable.name, declared),
        display=display,
        settable=exact and not unsupported,
    )
    if not variable.shape:
        yield whole
        return
    indices = list(itertools.product(*(range(1, size + 1) for size in variable.shape)))
    starts = whole.start.split() if whole.base else [whole.start]
    if len(starts) <= 1:
        # one value is that of all elements
        starts = (starts or [""]) * len(indices)
    if len(starts) != len(indices):
        problem = f"`{variable.name}` has {len(starts)} start values for {len(indices)} elements"
        raise FmuError(f"the model description is not valid: {problem}", members.AGAIN)
    for element, (index, start) in enumerate(zip(indices, starts, strict=True)):
        name = f"{variable.name}[{','.join(map(str, index))}]"
        yield replace(whole, name=name, start=start, array=variable.name, element=element)


def items_of(name: str, declared: Any) -> tuple[tuple[str, int], ...]:
    """Names and numbers of an enumeration, without duplicates."""
    items = tuple((item.name, int(item.value)) for item in (declared.items if declared else ()))
    for column in zip(*items, strict=True):
        twice = [entry for entry in column if column.count(entry) > 1]
        if twice:
            problem = f"the enumeration of `{name}` has the item `{twice[0]}` twice"
            raise FmuError(f"the model description is not valid: {problem}", members.AGAIN)
    return items
