"""Motions too small to be seen, drawn larger than they are."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Mapping, Sequence

import numpy as np

from cosim.errors import CosimError, closest
from cosim.replay.motion import Motion
from cosim.trace.columns import Array
from cosim.words.quantity import number

PREFIX = "plant.qpos."
SMALL = (1e-4, 1e-2)
"""Parts of the machine's size between which a motion is enlarged: below it is none, above it is seen."""
SEEN = 0.05
"""Part of the machine's size, or angle in rad, that an enlarged motion has."""


def given(words: Sequence[str], motion: Motion) -> dict[str, float]:
    """Factors by column from texts such as `ring_*=20`.

    Raises
    ------
    CosimError
        No factor, or no coordinate of that name.
    """
    factors: dict[str, float] = {}
    known = [name.removeprefix(PREFIX) for name in motion.names]
    for word in words:
        pattern, _, text = word.partition("=")
        try:
            factor = float(text)
        except ValueError:
            factor = math.nan
        if not (math.isfinite(factor) and factor > 0.0):
            raise CosimError(f"`--enlarge {word}` gives no factor", "such as `--enlarge 'ring_*=20'`")
        found = fnmatch.filter(known, pattern)
        if not found:
            raise CosimError(
                f"`--enlarge {word}`: no coordinate is named `{pattern}`", closest(pattern, known)
            )
        factors.update(dict.fromkeys((PREFIX + name for name in found), factor))
    return factors


def chosen(motion: Motion) -> dict[str, float]:
    """Factors for what moves, but too little to be seen: one for all lengths and one for all angles."""
    sizes = {"m": float(motion.model.stat.extent), "rad": 1.0}
    factors: dict[str, float] = {}
    for unit, size in sizes.items():
        parts = {
            name: float(np.ptp(motion.qpos[:, i])) / size
            for i, name in enumerate(motion.names)
            if motion.units[i] == unit
        }
        small = {name: part for name, part in parts.items() if SMALL[0] <= part < SMALL[1]}
        if small:
            factors.update(dict.fromkeys(small, round_down(SEEN / max(small.values()))))
    return factors


def round_down(value: float) -> float:
    """Largest of 1, 2, 5, 10, 20, ... that is not above."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-9))


def enlarged(motion: Motion, factors: Mapping[str, float]) -> Array:
    """Coordinates with larger motions, about the place where the model stands or, far from it, their mean."""
    qpos = motion.qpos.copy()
    for i, name in enumerate(motion.names):
        if name in factors:
            course = motion.qpos[:, i]
            span, home = float(np.ptp(course)), float(motion.model.qpos0[i])
            near = course.min() - span <= home <= course.max() + span
            about = home if near else float(course.mean())
            qpos[:, i] = about + factors[name] * (course - about)
    return qpos


def words(factors: Mapping[str, float]) -> list[str]:
    """Say what is drawn how much larger, a line for each factor."""
    by_factor: dict[float, list[str]] = {}
    for name, factor in factors.items():
        by_factor.setdefault(factor, []).append(name.removeprefix(PREFIX))
    return [
        f"drawn {number(factor)} x larger: {', '.join(names)}"
        for factor, names in by_factor.items()
        if factor != 1.0
    ]
