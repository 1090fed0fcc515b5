"""The page of a fault matrix in the documentation, and its comparison with the runs."""

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
"""Changes that only set the duration of a run."""
DIGITS = 3
"""Digits of the numbers on a page."""
TOLERANCE = 0.02
"""Relative tolerance between a number of a run and the page: another processor rounds differently."""
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def file(name: str) -> Path:
    """Page of a controller."""
    return FOLDER / f"{name}.md"


def page(name: str, matrix: Matrix, outcomes: Sequence[Outcome]) -> str:
    """Page of a controller."""
    common = [
        change for change in changes(matrix.rows[0]) if all(change in changes(row) for row in matrix.rows)
    ]
    everywhere = f", all runs with {', '.join(common)}" if common else ""
    undetectable = sum(not one.found for one in outcomes if one.row.undetectable)
    undetected = sum(any(each.startswith("undetected") for each in one.problems) for one in outcomes)
    quiet = f"Undetected: {undetected} (neither a correct fault nor a good result)"
    if undetectable:
        quiet += f"; undetectable: {undetectable}, with the reason"
    runs = f"run of the scenario `{matrix.scenario}` (seed {matrix.seed}){everywhere}"
    lines = [
        f"# Faults of fmu-{name}",
        "",
        f"{len(outcomes)} simulated faults, one in each {runs}.",
        "Brackets show further changes of a row. Each fault of the controller is raised at least once.",
        f"{quiet}. The excursion is",
        "the actual motion or force until the end of the reaction.",
        f"`python -m tests.faults {name}` writes this page; a test compares it with the runs.",
        "",
        "| simulated fault | response | after | excursion | limit | reason for the limit |",
        "|---|---|---|---|---|---|",
        *(line(one, common) for one in outcomes),
    ]
    return "\n".join(lines) + "\n"


def changes(row: Row) -> list[str]:
    """List the changes of a row, except the duration."""
    return [f"`{change}`" for change in row.changes if not change.startswith(LASTS)]


def line(one: Outcome, common: Sequence[str]) -> str:
    """Line of one row in the table, without the changes of all rows."""
    elsewhere = [f"in `{one.row.scenario}`"] if one.row.scenario else []
    changed = [*elsewhere, *(change for change in changes(one.row) if change not in common)]
    name = f"{one.row.name} ({', '.join(changed)})" if changed else one.row.name
    quiet = f"undetectable: {one.row.undetectable}" if one.row.undetectable else "completes, good result"
    found = " then ".join(f"`{name}`" for name in one.found) or quiet
    if one.problems:
        found = f"**{'; '.join(one.problems)}**"
    after = "" if math.isnan(one.after) else text(one.after, "s", DIGITS)
    numbers = (text(value, one.unit, DIGITS) for value in (one.excursion, one.row.limit))
    return f"| {' | '.join([name, found, after, *numbers, one.row.why])} |"


def differences(kept: str, now: str) -> list[str]:
    """Lines of a page whose words, or numbers by more than the tolerance, differ from those of the runs."""
    before, after = kept.splitlines(), now.splitlines()
    if len(before) != len(after):
        return [f"the page has {len(before)} lines, the runs give {len(after)}"]
    pairs = zip(before, after, strict=True)
    return [f"page: {old}\nruns: {new}" for old, new in pairs if not alike(old, new)]


def alike(old: str, new: str) -> bool:
    """Whether two lines have the same words and, within the tolerance, the same numbers."""
    if NUMBER.sub("", old) != NUMBER.sub("", new):
        return False
    numbers = zip(map(float, NUMBER.findall(old)), map(float, NUMBER.findall(new)), strict=True)
    return all(math.isclose(a, b, rel_tol=TOLERANCE) for a, b in numbers)
