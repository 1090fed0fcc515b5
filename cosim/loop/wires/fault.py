"""Mathematics of injections: the effect of a fault on a value, and its start."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cosim.loop.wires.transform import Delay, child, first_step
from cosim.scenario.injection import Injection
from cosim.scenario.model import Loop

NEVER = math.inf
"""First step of an injection that has not started."""


@dataclass
class FaultEffect:
    """Effect of an injection on an arriving value.

    `kind` is a key of `Injection`, or `lose` for `drop` of a Boolean. `number` is its number; for a ramp the
    change per step. `series` is the noise of every step, or 1 in the steps whose sample is lost.
    """

    kind: str
    number: float = 0.0
    series: NDArray[np.float64] | None = None
    delay: Delay = field(default_factory=lambda: Delay(0))
    held: float = 0.0

    def __call__(self, value: float, k: int, since: float) -> float:
        """Return the changed value in step `k`, which is `since` steps after the first.

        Before the first step `since` is negative: the value is only observed, the return value unused.
        """
        match self.kind:
            case "frozen" | "drop":
                # what was there before is held, too
                if not self.loses(k, since):
                    self.held = value
                return self.held
            case "late":
                return self.delay(value, k)
            case "lose":
                return 0.0 if self.loses(k, since) else value
            case "offset":
                return value + self.number
            case "scale":
                return value * self.number
            case "ramp":
                return value + self.number * since
            case "noise":
                return value + self.sample(k)
        return self.number

    def loses(self, k: int, since: float) -> bool:
        """Whether the sample of this step is lost; the first sample is kept."""
        if self.kind == "frozen":
            return since > 0.0
        return since >= 0.0 and self.sample(k) != 0.0

    def sample(self, k: int) -> float:
        """Sample of the series in step `k`."""
        assert self.series is not None
        return self.series.item(k)


def effect(entry: Injection, name: str, seed: int, loop: Loop, truth: bool) -> FaultEffect:
    """Effect of an injection at a Boolean or a number; `name` is its stream of random numbers."""
    kind = entry.kind
    number = float(getattr(entry, kind))
    random = np.random.default_rng(child(seed, name))
    match kind:
        case "noise":
            return FaultEffect(kind, series=random.normal(0.0, number, loop.steps))
        case "drop":
            lost = (random.random(loop.steps) < number).astype(float)
            return FaultEffect("lose" if truth else kind, series=lost)
        case "late":
            return FaultEffect(kind, delay=Delay(int(number)))
        case "ramp":
            return FaultEffect(kind, number * loop.step)
    return FaultEffect(kind, number)


def steps_of(entry: Injection, loop: Loop) -> int:
    """Return the number of steps of an injection; without an end it lasts to the end of the run."""
    if entry.duration is not None:
        return max(1, first_step(entry.duration, loop.step))
    if entry.to_time is None or entry.from_time is None:
        return loop.steps
    return first_step(entry.to_time, loop.step) - first_step(entry.from_time, loop.step)
