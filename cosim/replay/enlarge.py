"""Enlargement of motions that are too small to be seen."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from cosim.errors import CosimError, closest
from cosim.formatting.quantity import number, round_down
from cosim.replay.motion import COORDINATE, Enlarged, Motion
from cosim.trace.columns import Array

ENLARGE = "enlarge"
"""Name of the MJCF text that lists them."""
SMALL = (1e-4, 1e-2)
"""Range of enlarged motions, relative to the machine size: smaller ones are noise, larger ones visible."""
SEEN = 0.05
"""Amplitude of an enlarged motion, relative to the machine size, or in rad."""


def given(words: Sequence[str], motion: Motion) -> dict[str, float]:
    """Factors by column from texts such as `ring_*=20`.

    Raises
    ------
    CosimError
        A missing factor, or no coordinate of that name.
    """
    factors: dict[str, float] = {}
    known = [name.removeprefix(COORDINATE) for name in motion.names]
    for word in words:
        pattern, _, text = word.partition("=")
        try:
            factor = float(text)
        except ValueError:
            factor = math.nan
        if not (math.isfinite(factor) and factor > 0.0):
            raise CosimError(
                f"`--enlarge {word}` has no factor", "Give, for example, `--enlarge 'ring_*=20'`."
            )
        found = fnmatch.filter(known, pattern)
        if not found:
            raise CosimError(
                f"`--enlarge {word}`: no coordinate is named `{pattern}`", closest(pattern, known)
            )
        factors.update(dict.fromkeys((COORDINATE + name for name in found), factor))
    return factors


def chosen(motion: Motion) -> dict[str, float]:
    """Factors for motions too small to be seen: one for all lengths and one for all angles.

    A text `enlarge` in the MJCF can name the coordinates, with patterns, `-` for none.
    """
    allowed = patterns(motion)
    sizes = {"m": float(motion.model.stat.extent), "rad": 1.0}
    factors: dict[str, float] = {}
    for unit, size in sizes.items():
        parts = {
            name: float(np.ptp(motion.qpos[:, i])) / size
            for i, name in enumerate(motion.names)
            if motion.units[i] == unit
            and any(fnmatch.fnmatch(name.removeprefix(COORDINATE), one) for one in allowed)
        }
        small = {name: part for name, part in parts.items() if SMALL[0] <= part < SMALL[1]}
        if small:
            factors.update(dict.fromkeys(small, round_down(SEEN / max(small.values()))))
    return factors


def patterns(motion: Motion) -> list[str]:
    """Patterns of the coordinates to enlarge from the MJCF; default: all."""
    model = motion.model
    place = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TEXT.value, ENLARGE)
    if place < 0:
        return ["*"]
    begin, size = int(model.text_adr[place]), int(model.text_size[place])
    return bytes(model.text_data[begin : begin + size]).decode().rstrip("\0").split()


def enlarged(motion: Motion, factors: Mapping[str, float]) -> Array:
    """Coordinates with larger motions."""
    about = centres(motion, factors)
    qpos = motion.qpos.copy()
    for i, name in enumerate(motion.names):
        if name in factors:
            qpos[:, i] = about[name] + factors[name] * (motion.qpos[:, i] - about[name])
    return qpos


def one(motion: Motion, factors: Mapping[str, float]) -> Enlarged:
    """Value of a coordinate after `enlarged`."""
    about = centres(motion, factors)

    def drawn(name: str, value: float) -> float:
        column = COORDINATE + name
        return about[column] + factors[column] * (value - about[column]) if column in factors else value

    return drawn


def centres(motion: Motion, factors: Mapping[str, float]) -> dict[str, float]:
    """Center of an enlarged motion: the model pose or, far from it, the mean."""
    found = {}
    for i, name in enumerate(motion.names):
        if name in factors:
            curve = motion.qpos[:, i]
            span, home = float(np.ptp(curve)), float(motion.model.qpos0[i])
            near = curve.min() - span <= home <= curve.max() + span
            found[name] = home if near else float(curve.mean())
    return found


def words(factors: Mapping[str, float]) -> list[str]:
    """Texts about enlarged coordinates, one for each factor."""
    by_factor: dict[float, list[str]] = {}
    for name, factor in factors.items():
        by_factor.setdefault(factor, []).append(name.removeprefix(COORDINATE))
    return [
        f"drawn {number(factor)} x larger: {', '.join(names)}"
        for factor, names in by_factor.items()
        if factor != 1.0
    ]
