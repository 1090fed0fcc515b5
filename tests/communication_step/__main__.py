"""Measure what step and delay do to the closed loops; compare with the document, or write it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Collection
from concurrent.futures import ProcessPoolExecutor

from . import document
from .cells import CELLS, Cell, Outcome, measure
from .loops import LOOPS

NEAR = 0.1
"""Relative difference of two numbers that are the same: other processors round otherwise."""


def main() -> int:
    """Run the command; 0 if the document says what is measured, else 1."""
    parser = argparse.ArgumentParser(prog="python -m tests.communication_step", description=__doc__)
    names = [loop.name for loop in LOOPS]
    parser.add_argument("names", metavar="NAME", nargs="*", help="loops, all by default")
    parser.add_argument("--write", action="store_true", help="write the document instead of comparing")
    parser.add_argument("-j", "--jobs", type=int, help="processes, as many as cores by default")
    given = parser.parse_args()
    if not set(given.names) <= set(names):
        parser.error(f"the loops are {', '.join(names)}")
    outcomes, before = measured(given.names or names, given.jobs), document.read()
    if given.write:
        document.write({**before, **outcomes})
        return 0
    other = [
        f"{name} {cell}: {before[name, cell]} is now {outcome}"
        for (name, cell), outcome in outcomes.items()
        if not alike(before[name, cell], outcome)
    ]
    print("\n".join(other) or "the document says what is measured")
    return 1 if other else 0


def measured(names: Collection[str], jobs: int | None) -> dict[tuple[str, Cell], Outcome]:
    """Outcomes of all cells of some loops, from parallel processes."""
    tasks = [(loop, cell) for loop in LOOPS if loop.name in names for cell in CELLS]
    with ProcessPoolExecutor(jobs) as pool:
        outcomes = pool.map(measure, *zip(*tasks, strict=True))
        return {(loop.name, cell): outcome for (loop, cell), outcome in zip(tasks, outcomes, strict=True)}


def alike(a: Outcome, b: Outcome) -> bool:
    """Whether two outcomes are the same."""
    if a.number is None or b.number is None:
        return (a.number, a.problem) == (b.number, b.problem)
    return abs(a.number - b.number) <= NEAR * max(a.number, b.number)


if __name__ == "__main__":
    sys.exit(main())
