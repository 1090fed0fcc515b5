"""Matching of ports by names and by compatible units."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass

from cosim.units import UNCHANGED, Conversion, conversion

ENOUGH = 0.65
"""Similarity of two names above which they match."""
OTHER_THING = 0.3
"""Penalty for names with the same words about different parts."""
SAME_UNIT = 0.1
"""Bonus for equal units."""


@dataclass(frozen=True)
class End:
    """One end of a wire: an input, output, measurement or command.

    The unit is empty if unknown. `note` has type, unit, range and description for a comment. `start` is the
    start value as TOML.
    """

    name: str
    unit: str = ""
    note: str = ""
    start: str = "0.0"


@dataclass(frozen=True)
class Match:
    """Two matching ports; `conversion` is that of the unit, `sure` is true if the names match."""

    source: End
    target: End
    conversion: Conversion = UNCHANGED
    sure: bool = True


def match(sources: Sequence[End], targets: Sequence[End]) -> list[Match]:
    """Pair sources with targets, the most similar first; each is used once.

    One remaining source and one remaining target with compatible units also are a pair.
    """
    found: dict[str, Match] = {}
    used: set[str] = set()
    pairs = [(likeness(source, target), source, target) for source in sources for target in targets]
    for value, source, target in sorted(pairs, key=lambda pair: -pair[0]):
        if value >= ENOUGH and source.name not in used and target.name not in found:
            found[target.name] = Match(source, target, converted(source.unit, target.unit) or UNCHANGED)
            used.add(source.name)
    left = [source for source in sources if source.name not in used]
    open_ = [target for target in targets if target.name not in found]
    if len(left) == len(open_) == 1 and (change := converted(left[0].unit, open_[0].unit)) is not None:
        found[open_[0].name] = Match(left[0], open_[0], change, sure=False)
    return [found[target.name] for target in targets if target.name in found]


def likeness(source: End, target: End) -> float:
    """From 0 to a little above 1; 0 for units that contradict each other."""
    if converted(source.unit, target.unit) is None:
        return 0.0
    known = source.unit == target.unit and source.unit not in ("", "1")
    return same_words(source.name, target.name) + (SAME_UNIT if known else 0.0)


def same_words(one: str, other: str) -> float:
    """Similarity of two names, 1 for the same words; slightly less if one contains the other."""
    mine, others = words(one), words(other)
    if not mine or not others:
        return float(one == other)
    fewer, more = sorted((set(mine), set(others)), key=len)
    # a letter or an index alone names a component: the output `y` is not `force.y`
    named = any(len(word) > 1 and not word.isdigit() for word in fewer)
    if fewer <= more and (named or fewer == more):
        return 1.0 - 0.02 * abs(len(mine) - len(others))
    whole = difflib.SequenceMatcher(None, "_".join(mine), "_".join(others)).ratio()
    # `x.position` and `y.position` differ in the significant word
    return whole - OTHER_THING if mine[-1] == others[-1] and len(mine) == len(others) else whole


def words(name: str) -> list[str]:
    """Words of a name in small letters: `Slide.posX[1]` is slide, pos, x, 1."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name)
    return [part.lower() for part in parts]


def converted(before: str, after: str) -> Conversion | None:
    """Conversion from one unit to another; no change if one is unknown, None if they are incompatible."""
    return UNCHANGED if {before, after} & {"", "1"} else conversion(before, after)
