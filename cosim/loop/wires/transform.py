"""Transform of a value on its wire: scale, offset, noise, quantum, limits and delay."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.loop.plant import Channel
from cosim.scenario.checks import MAX_STEPS
from cosim.scenario.model import Wire


@dataclass(frozen=True)
class Shape:
    """Scale, offset, noise, quantum and limits of one wire: output value from input value.

    Noise, quantum and limits act on the plant's side, in the unit of its channel: before the conversion of a
    measurement (`from_plant`), after that of a command. Between FMUs they act after it. `noise` holds that of
    every step.
    """

    source: str
    from_plant: bool
    scale: float
    offset: float
    noise: NDArray[np.float64] | None
    quantum: float
    minimum: float
    maximum: float

    def __call__(self, value: float, k: int) -> float:
        """Output value of the wire in step `k`."""
        if self.from_plant:
            return self.scale * self.disturb(value, k) + self.offset
        return self.disturb(self.scale * value + self.offset, k)

    def disturb(self, value: float, k: int) -> float:
        """Add noise, quantize and limit."""
        if self.noise is not None:
            value += self.noise.item(k)
        # before the clamp, which would hide a value that is not finite
        if not math.isfinite(value):
            raise self.refusal(value)
        # round half to even
        if self.quantum > 0.0:
            quanta = value / self.quantum
            # otherwise more quanta than numbers: finer than the value itself
            if math.isfinite(quanta):
                value = float(np.rint(quanta)) * self.quantum
        return min(max(value, self.minimum), self.maximum)

    def refusal(self, value: float) -> CosimError:
        """Error of a value that is not finite."""
        return CosimError(f"`{self.source}` is `{value}`, it must be finite")


def child(seed: int, name: str) -> np.random.SeedSequence:
    """Independent seed of one consumer of random numbers.

    It depends only on the seed of the run and the name of the consumer, so a new wire does not change the
    noise of other wires.
    """
    return np.random.SeedSequence(seed, spawn_key=(zlib.crc32(name.encode()),))


def noise(wire: Wire, channel: Channel, seed: int, steps: int) -> NDArray[np.float64] | None:
    """White Gaussian noise of a wire for a whole run, shape (steps,), in the unit of the plant's channel."""
    deviation = channel.noise if wire.noise is None else wire.noise
    if deviation == 0.0:
        return None
    return np.random.default_rng(child(seed, f"wire.{wire.stream or wire.to}")).normal(0.0, deviation, steps)


def shaper(wire: Wire, channel: Channel, from_plant: bool, samples: NDArray[np.float64] | None) -> Shape:
    """Shape of a wire; the defaults are those of the plant's channel at one of its ends, or of `Ideal`."""
    return Shape(
        source=wire.source,
        from_plant=from_plant,
        scale=wire.scale,
        offset=wire.offset,
        noise=samples,
        quantum=channel.quantum if wire.quantum is None else wire.quantum,
        minimum=channel.minimum if wire.minimum is None else wire.minimum,
        maximum=channel.maximum if wire.maximum is None else wire.maximum,
    )


class Ideal:
    """Ideal channel of a wire between FMUs: no noise, quantum or limits."""

    name = unit = description = ""
    noise = quantum = 0.0
    minimum, maximum = -math.inf, math.inf


class Delay:
    """Ring buffer that returns the value of `steps` steps before; at first the initial value."""

    def __init__(self, steps: int) -> None:
        self.steps = steps
        self.ring: list[float] = []

    def prime(self, value: float) -> None:
        """Fill the ring with the value before the first step."""
        self.ring = [value] * self.steps

    def __call__(self, value: float, k: int) -> float:
        """Store the value of step `k` and return the one of step `k - steps`."""
        if not self.steps:
            return value
        if not self.ring:
            self.prime(value)
        slot = k % self.steps
        delayed, self.ring[slot] = self.ring[slot], value
        return delayed


def first_step(time: float, step: float) -> int:
    """First step `k` with `k * step >= time`, within the rounding of `k * step`."""
    return math.ceil(min(max(time / step - 1e-6, 0.0), MAX_STEPS))
