"""The page of a fault matrix in the documentation, and whether it tells what the runs give."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

from cosim.formatting.quantity import text

from .matrix import Matrix, Row
from .outcome import Outcome

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "faults"
LASTS = ("loop.duration=", "loop.stop_when=")
"""Changes that only say how long a run is looked at."""
DIGITS = 3
"""Digits of the numbers on a page."""
TOLERANCE = 0.02
"""Share by which a number of a run may differ from the page: another processor rounds otherwise."""
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def file(name: str) -> Path:
    """Page of a controller."""
    return FOLDER / f"{name}.md"


def page(name: str, matrix: Matrix, outcomes: Sequence[Outcome]) -> str:
    """Page of a controller."""
    common = [
        change for change in changes(matrix.rows[0]) if all(change in changes(row) for row in matrix.rows)
    ]
    everywhere = f", all with {', '.join(common)}" if common else ""
    untold = sum(not one.found for one in outcomes if one.row.untold)
    silent = sum(any(told.startswith("silent") for told in one.problems) for one in outcomes)
    quiet = f"Silent are {silent}"
    if untold:
        quiet += f", but for {untold} that no reading tells, with the reason"
    runs = f"run of the loop `{matrix.scenario}` (seed {matrix.seed}){everywhere}"
    lines = [
        f"# Faults of fmu-{name}",
        "",
        f"{len(outcomes)} faults, one in each {runs}.",
        "In brackets is what a row changes beside it. Each fault of the controller is told at least once.",
        f"{quiet}: neither a right fault is told nor is the job done and good. The excursion is",
        "what the machine truly does until its safe end, the limit what it must not exceed.",
        f"`python -m tests.faults {name}` writes this page; a test compares it with the runs.",
        "",
        "| injected | found as | after | excursion | limit | why that limit |",
        "|---|---|---|---|---|---|",
        *(line(one, common) for one in outcomes),
    ]
    return "\n".join(lines) + "\n"


def changes(row: Row) -> list[str]:
    """List what a row changes, but for how long it lasts."""
    return [f"`{change}`" for change in row.changes if not change.startswith(LASTS)]


def line(one: Outcome, common: Sequence[str]) -> str:
    """Line of one row in the table; what all rows change is not told again."""
    elsewhere = [f"in `{one.row.scenario}`"] if one.row.scenario else []
    changed = [*elsewhere, *(change for change in changes(one.row) if change not in common)]
    name = f"{one.row.name} ({', '.join(changed)})" if changed else one.row.name
    quiet = f"not told: {one.row.untold}" if one.row.untold else "the job is done and good"
    found = " then ".join(f"`{name}`" for name in one.found) or quiet
    if one.problems:
        found = f"**{'; '.join(one.problems)}**"
    after = "" if math.isnan(one.after) else text(one.after, "s", DIGITS)
    numbers = (text(value, one.unit, DIGITS) for value in (one.excursion, one.row.limit))
    return f"| {' | '.join([name, found, after, *numbers, one.row.why])} |"


def differences(kept: str, now: str) -> list[str]:
    """Lines of a page that differ from those of the runs in words, or in a number beyond the tolerance."""
    before, after = kept.splitlines(), now.splitlines()
    if len(before) != len(after):
        return [f"the page has {len(before)} lines, the runs give {len(after)}"]
    pairs = zip(before, after, strict=True)
    return [f"page: {old}\nruns: {new}" for old, new in pairs if not alike(old, new)]


def alike(old: str, new: str) -> bool:
    """Whether two lines have the same words and nearly the same numbers."""
    if NUMBER.sub("", old) != NUMBER.sub("", new):
        return False
    numbers = zip(map(float, NUMBER.findall(old)), map(float, NUMBER.findall(new)), strict=True)
    return all(math.isclose(a, b, rel_tol=TOLERANCE) for a, b in numbers)
