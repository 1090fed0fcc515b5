"""Plants for the tests of the harness, written as a user would: no base class, no import of the project."""

import dataclasses
import math
import os
import pathlib
import time
from typing import Any, ClassVar

import numpy as np


@dataclasses.dataclass(frozen=True)
class Channel:
    name: str
    unit: str = "1"
    description: str = ""
    noise: float = 0.0
    quantum: float = 0.0
    minimum: float = -math.inf
    maximum: float = math.inf


@dataclasses.dataclass(frozen=True)
class LagParameters:
    pole: float = dataclasses.field(
        default=0.5,
        metadata={"unit": "1", "description": "Pole", "minimum": 0.0, "maximum": 1.0, "source": "test"},
    )
    label: str = dataclasses.field(
        default="a", metadata={"unit": "", "description": "Any text", "source": "test"}
    )
    fail_at: int = dataclasses.field(default=-1, metadata={"unit": "1", "description": "Step that fails"})
    stall_at: int = dataclasses.field(
        default=-1, metadata={"unit": "1", "description": "Step that never ends, the first time"}
    )
    nan_at: int = dataclasses.field(default=-1, metadata={"unit": "1", "description": "Step that reads NaN"})


class Lag:
    """x[n+1] = pole x[n] + (1 - pole) u, one plant step each; `ramp` is the time."""

    Parameters: ClassVar[type] = LagParameters
    readings = (Channel("x", "m"), Channel("ramp", "s"), Channel("flag"), Channel("count"))
    commands = (Channel("u", "m"), Channel("extra"))
    truths = (Channel("x", "m"), Channel("u", "m"), Channel("extra"), Channel("random"))
    timestep = 0.001

    def __init__(self, parameters: LagParameters) -> None:
        self.parameters = parameters

    def reset(self, seed: np.random.SeedSequence, duration: float) -> None:
        self.random = np.random.default_rng(seed).normal()
        self.x, self.n = 1.0, 0
        self.u = np.zeros(2)

    def sense(self) -> Any:
        if self.n == self.parameters.fail_at:
            raise RuntimeError("failed on request")
        stalled = pathlib.Path(__file__).with_name("stalled")
        if self.n == self.parameters.stall_at and not stalled.exists():
            stalled.write_text(f"{os.getpid()} {os.getppid()}\n")
            time.sleep(1000.0)
        x = math.nan if self.n == self.parameters.nan_at else self.x
        return np.array([x, self.n * self.timestep, self.n % 2, self.n])

    def command(self, values: Any) -> None:
        self.u = values.copy()

    def advance(self, substeps: int) -> None:
        for _ in range(substeps):
            self.x = self.parameters.pole * self.x + (1.0 - self.parameters.pole) * self.u[0]
            self.n += 1

    def truth(self) -> Any:
        return np.array([self.x, *self.u, self.random])


@dataclasses.dataclass(frozen=True)
class Started(Channel):
    start: float = 0.0


class Switched(Lag):
    """A plant whose second command is on unless something switches it off."""

    commands = (Channel("u", "m"), Started("extra", start=1.0))


class Refusing(Lag):
    def __init__(self, parameters: LagParameters) -> None:
        raise ValueError("pole and label do not go together")
