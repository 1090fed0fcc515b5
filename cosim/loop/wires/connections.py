"""All connections of a run, between arrays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.fmu.values import fits, integer_text
from cosim.loop.wires.fault import FaultEffect
from cosim.loop.wires.transform import Delay, Shape

INT32 = np.dtype(np.int32)


def whole(value: float, dtype: np.dtype[Any] = INT32) -> int:
    """Integer of a number, rounded half to even."""
    if not math.isfinite(value) or not fits(number := round(value), dtype):
        text = integer_text(dtype).removeprefix("an integer of ")
        raise CosimError(f"an integer input got `{value}`, it has {text}")
    return number


CONVERT: dict[str, Callable[[float], Any]] = {"Real": float, "Integer": whole, "Boolean": bool}
"""Conversion of a number on writing."""


@dataclass(frozen=True)
class Slot:
    """Location of a value: `array[index]`, a `Real`, `Integer` or `Boolean`."""

    array: NDArray[Any]
    index: int
    kind: str = "Real"

    @cached_property
    def convert(self) -> Callable[[float], Any]:
        """Conversion of a number on writing."""
        return partial(whole, dtype=self.array.dtype) if self.kind == "Integer" else CONVERT[self.kind]

    def read(self) -> float:
        """Value as a number."""
        return float(self.array[self.index])

    def write(self, value: float) -> None:
        """Write a number to a value of any type."""
        self.array[self.index] = self.convert(value)


@dataclass(frozen=True)
class Connection:
    """One connected wire; `late` states that its source is initialized after its target."""

    source: Slot
    target: Slot
    shape: Shape
    delay: Delay
    late: bool = False

    def transformed(self, k: int) -> float:
        """Value of the source in step `k` after the transform, without the delay."""
        return self.shape(self.source.read(), k)


@dataclass(frozen=True)
class Stimulus:
    """One signal: `samples[k]` is written in step `k`."""

    samples: NDArray[np.float64]
    target: Slot


@dataclass(frozen=True)
class Fault:
    """One injection: `change` is applied in `length` steps, starting with the step stored in `begin`."""

    begin: Slot
    length: int
    change: FaultEffect
    target: Slot


@dataclass(frozen=True)
class Inputs:
    """What arrives at the inputs of an FMU, or at the commands of the plant, before its step.

    `held` are the stimuli, among all, that hold the start values of targets that only injections write.
    """

    wires: list[Connection] = field(default_factory=list)
    stimuli: list[Stimulus] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    held: list[Stimulus] = field(default_factory=list)


@dataclass(frozen=True)
class Connections:
    """All connections of a run.

    `sensed` and `commands` are the ideal measurements and the commands of a step, `fmus` the inputs of each
    FMU in the order of their steps, `begins` the first step of every injection (infinite while unknown).
    """

    sensed: NDArray[np.float64]
    commands: NDArray[np.float64]
    fmus: list[Inputs]
    plant: Inputs
    begins: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
