"""Which end of a wire fits which: by their names, and by units that do not contradict each other."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass

from cosim.loop.lint import ratio

ENOUGH = 0.65
"""Likeness of two names from which on they are taken for one thing."""
OTHER_THING = 0.3
"""What is taken off for names that tell the same of different things."""
SAME_UNIT = 0.1
"""What an equal unit adds to the likeness."""


@dataclass(frozen=True)
class End:
    """One end of a wire: an input, output, reading or command; the unit is empty where none is known."""

    name: str
    unit: str = ""


@dataclass(frozen=True)
class Match:
    """Two ends that fit; `scale` converts the unit, `sure` tells whether the names say so."""

    source: End
    target: End
    scale: float = 1.0
    sure: bool = True


def match(sources: Sequence[End], targets: Sequence[End]) -> list[Match]:
    """Pair sources with targets, the most alike first; each is used once.

    Where one source and one target are left whose units do not contradict each other, they are a pair, too.
    """
    found: dict[str, Match] = {}
    used: set[str] = set()
    pairs = [(likeness(source, target), source, target) for source in sources for target in targets]
    for value, source, target in sorted(pairs, key=lambda pair: -pair[0]):
        if value >= ENOUGH and source.name not in used and target.name not in found:
            found[target.name] = Match(source, target, factor(source.unit, target.unit) or 1.0)
            used.add(source.name)
    left = [source for source in sources if source.name not in used]
    open_ = [target for target in targets if target.name not in found]
    if len(left) == len(open_) == 1 and (scale := factor(left[0].unit, open_[0].unit)) is not None:
        found[open_[0].name] = Match(left[0], open_[0], scale, sure=False)
    return [found[target.name] for target in targets if target.name in found]


def likeness(source: End, target: End) -> float:
    """From 0 to a little above 1; 0 for units that contradict each other."""
    if factor(source.unit, target.unit) is None:
        return 0.0
    known = source.unit == target.unit and source.unit not in ("", "1")
    return same_words(source.name, target.name) + (SAME_UNIT if known else 0.0)


def same_words(one: str, other: str) -> float:
    """Likeness of two names, 1 for the same words; a name within the other is nearly the same."""
    mine, others = words(one), words(other)
    if not mine or not others:
        return float(one == other)
    if set(mine) <= set(others) or set(others) <= set(mine):
        return 1.0 - 0.02 * abs(len(mine) - len(others))
    whole = difflib.SequenceMatcher(None, "_".join(mine), "_".join(others)).ratio()
    # `x.position` and `y.position` differ in the word that counts
    return whole - OTHER_THING if mine[-1] == others[-1] and len(mine) == len(others) else whole


def words(name: str) -> list[str]:
    """Words of a name in small letters: `Slide.posX[1]` is slide, pos, x, 1."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name)
    return [part.lower() for part in parts]


def factor(before: str, after: str) -> float | None:
    """Factor from one unit to another; 1 where one is not known, None where they do not fit."""
    if before == after or {before, after} & {"", "1"}:
        return 1.0
    return ratio(before, after)
