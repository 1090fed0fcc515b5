"""Enlargement of motions that are too small to be seen."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from cosim.errors import CosimError, closest
from cosim.formatting.quantity import number, round_down
from cosim.replay.motion import COORDINATE, Motion

ENLARGE = "enlarge"
"""Name of the MJCF text that lists them."""
SMALL = (1e-4, 1e-2)
"""Range of enlarged motions, relative to the machine size: smaller ones are noise, larger ones visible."""
SEEN = 0.05
"""Amplitude of an enlarged motion, relative to the machine size, or in rad."""


class Enlargement:
    """Motions drawn larger by factors, by column, around a center.

    The center is the model pose or, if the motion is far from it, the mean. `qpos` are the drawn coordinates.
    """

    def __init__(self, motion: Motion, factors: Mapping[str, float]) -> None:
        self.factors = factors
        self.centers: dict[str, float] = {}
        self.qpos = motion.qpos.copy()
        for name, factor in factors.items():
            i = motion.names.index(name)
            curve = motion.qpos[:, i]
            span, home = float(np.ptp(curve)), float(motion.model.qpos0[i])
            near = curve.min() - span <= home <= curve.max() + span
            center = self.centers[name] = home if near else float(curve.mean())
            self.qpos[:, i] = center + factor * (curve - center)

    def value(self, joint: str, value: float) -> float:
        """Drawn value of a coordinate."""
        column = COORDINATE + joint
        if column not in self.factors:
            return value
        return self.centers[column] + self.factors[column] * (value - self.centers[column])

    @property
    def texts(self) -> list[str]:
        """Texts about enlarged coordinates, one for each factor."""
        names: dict[float, list[str]] = {}
        for name, factor in self.factors.items():
            names.setdefault(factor, []).append(name.removeprefix(COORDINATE))
        return [f"drawn {number(f)} x larger: {', '.join(of)}" for f, of in names.items() if f != 1.0]


def enlargement(motion: Motion, options: Sequence[str]) -> Enlargement:
    """Enlargement by texts such as `ring_*=20`; without them of motions too small to be seen."""
    return Enlargement(motion, parse_factors(options, motion) if options else automatic_factors(motion))


def parse_factors(options: Sequence[str], motion: Motion) -> dict[str, float]:
    """Factors by column from texts; an error for a missing factor or an unknown coordinate."""
    factors: dict[str, float] = {}
    known = [name.removeprefix(COORDINATE) for name in motion.names]
    for option in options:
        pattern, _, text = option.partition("=")
        try:
            factor = float(text)
        except ValueError:
            factor = math.nan
        if not (math.isfinite(factor) and factor > 0.0):
            hint = "Give, for example, `--enlarge 'ring_*=20'`."
            raise CosimError(f"`--enlarge {option}` has no factor", hint)
        matching = fnmatch.filter(known, pattern)
        if not matching:
            problem = f"`--enlarge {option}`: no coordinate is named `{pattern}`"
            raise CosimError(problem, closest(pattern, known))
        factors |= {COORDINATE + name: factor for name in matching}
    return factors


def automatic_factors(motion: Motion) -> dict[str, float]:
    """Factors for motions too small to be seen: one for all lengths and one for all angles.

    A text `enlarge` in the MJCF can name the coordinates, with patterns, `-` for none.
    """
    allowed = patterns(motion)
    factors: dict[str, float] = {}
    for unit, size in (("m", float(motion.model.stat.extent)), ("rad", 1.0)):
        parts = {
            name: float(np.ptp(motion.qpos[:, i])) / size
            for i, name in enumerate(motion.names)
            if motion.units[i] == unit
            and any(fnmatch.fnmatch(name.removeprefix(COORDINATE), one) for one in allowed)
        }
        small = {name: part for name, part in parts.items() if SMALL[0] <= part < SMALL[1]}
        factors |= {name: round_down(SEEN / max(small.values())) for name in small}
    return factors


def patterns(motion: Motion) -> list[str]:
    """Patterns of the coordinates to enlarge from the MJCF; default: all."""
    model = motion.model
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TEXT.value, ENLARGE)
    if index < 0:
        return ["*"]
    begin, size = int(model.text_adr[index]), int(model.text_size[index])
    return bytes(model.text_data[begin : begin + size]).decode().rstrip("\0").split()
