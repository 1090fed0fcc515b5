"""All connections of a run, between arrays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.fmu.values import fits, integer_text
from cosim.loop.wires.fault import FaultEffect
from cosim.loop.wires.wiring import Delay, Shape

INT32 = np.dtype(np.int32)


def truth(value: float) -> int:
    """Boolean of a number: true unless 0."""
    return int(value != 0.0)


def whole(value: float, dtype: np.dtype[Any] = INT32) -> int:
    """Integer of a number, rounded half to even."""
    if not math.isfinite(value) or not fits(number := round(value), dtype):
        text = integer_text(dtype).removeprefix("an integer of ")
        raise CosimError(f"an integer input got `{value}`, it has {text}")
    return number


CONVERT: dict[str, Callable[[float], Any]] = {"Real": float, "Integer": whole, "Boolean": truth}
"""Conversion of a number on writing."""


@dataclass(frozen=True)
class Slot:
    """Location of a value: `array[index]`, a `Real`, `Integer` or `Boolean`."""

    array: NDArray[Any]
    index: int
    kind: str = "Real"
    convert: Callable[[float], Any] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        convert = CONVERT[self.kind]
        if self.kind == "Integer":
            convert = partial(whole, dtype=self.array.dtype)
        object.__setattr__(self, "convert", convert)


@dataclass(frozen=True)
class Link:
    """One connected wire; `late` states that its source is initialized after its target."""

    source: Slot
    target: Slot
    shape: Shape
    delay: Delay
    late: bool = False


@dataclass(frozen=True)
class Drive:
    """One signal: `course[k]` is written in step `k`."""

    course: NDArray[np.float64]
    target: Slot


@dataclass(frozen=True)
class Fault:
    """One injection: `change` is applied in `length` steps, starting with the step stored in `begin`."""

    begin: Slot
    length: int
    change: FaultEffect
    target: Slot


@dataclass(frozen=True)
class Connection:
    """Connections to the inputs of an FMU, or to the commands of the plant, before its step.

    `held` are the drives, among all drives, that hold the start values of targets that only injections write.
    """

    wires: list[Link] = field(default_factory=list)
    drives: list[Drive] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    held: list[Drive] = field(default_factory=list)


@dataclass(frozen=True)
class Links:
    """All connections of a run.

    Parameters
    ----------
    sensed, commands
        Ideal measurements and commands of a step.
    fmus
        Connections to each FMU, in the order of their steps.
    plant
        Connections to the plant.
    begins
        First step of every injection; infinite while unknown.
    """

    sensed: NDArray[np.float64]
    commands: NDArray[np.float64]
    fmus: list[Connection]
    plant: Connection
    begins: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))

    @property
    def drives(self) -> list[Drive]:
        """All signals, for native code."""
        return [drive for connection in (*self.fmus, self.plant) for drive in connection.drives]

    @property
    def readings(self) -> list[Link]:
        """Wires to the only FMU."""
        return self.fmus[0].wires

    @property
    def input_faults(self) -> list[Fault]:
        """Injections at the only FMU."""
        return self.fmus[0].faults

    @property
    def outputs(self) -> list[Link]:
        """Wires to the plant."""
        return self.plant.wires

    @property
    def command_faults(self) -> list[Fault]:
        """Injections at the plant."""
        return self.plant.faults
