"""`docs/communication-step.md`: written from outcomes, and read back."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from .cells import CELLS, DELAYS, NOMINAL, SAMPLES, WORKS, Cell, Outcome
from .loops import LOOPS, Loop

FILE = Path(__file__).resolve().parents[2] / "docs/communication-step.md"

Outcomes = Mapping[tuple[str, Cell], Outcome]

MARK = "<!-- measured: the command above writes the rest of this page -->\n"


def limit(loop: Loop, outcomes: Outcomes) -> float:
    """Longest of the steps, in samples, up to which the loop works."""
    nominal = outcomes[loop.name, NOMINAL]
    longest = 0.0
    for samples in SAMPLES:
        if not all(works(outcomes[loop.name, Cell(samples, delay, True)], nominal) for delay in (0, 1)):
            break
        longest = samples
    return longest


def works(outcome: Outcome, nominal: Outcome) -> bool:
    """Whether the cycle is complete, and nearly as good as in the nominal cell."""
    if outcome.number is None or nominal.number is None:
        return False
    return outcome.number <= WORKS * nominal.number


def shown(outcome: Outcome, nominal: Outcome) -> str:
    """Text of a cell."""
    if outcome.number is None:
        return outcome.problem
    text = f"{outcome.number:.3g}" if outcome.number < 1000 else f"{outcome.number:.0f}"
    return text if works(outcome, nominal) else f"**{text}**"


def write(outcomes: Outcomes) -> None:
    """Rewrite the part after the mark."""
    words = FILE.read_text("utf-8").partition(MARK)[0]
    FILE.write_text(words + MARK + "\n" + "\n".join(lines(outcomes)) + "\n", "utf-8")


def lines(outcomes: Outcomes) -> Iterator[str]:
    """Lines of what was measured, from the outcomes of all cells."""
    yield "| controller | sample period | works up to | number |"
    yield "|---|---|---|---|"
    for loop in LOOPS:
        samples = limit(loop, outcomes)
        what = f"{samples:g} sample period{'s' if samples > 1 else ''}, {samples * loop.period:g} s"
        yield f"| `fmu-{loop.name}` | {loop.period:g} s | {what} | {loop.what}, {loop.unit} |"
    for loop in LOOPS:
        yield from table(loop, outcomes)


def table(loop: Loop, outcomes: Outcomes) -> Iterator[str]:
    """Heading and table of a loop."""
    seeds = f"{loop.seeds} seeds" if loop.seeds > 1 else "one seed"
    yield f"\n## {loop.name}\n"
    what = loop.what[0].upper() + loop.what[1:]
    yield f"{what}, {loop.unit}; scenario `{loop.scenario}`, {seeds}. {loop.remark}".rstrip() + "\n"
    heads = [f"delay {delay}, {setting}" for delay in DELAYS for setting in ("right", "off")]
    yield f"| step, samples | {' | '.join(heads)} | the FMU |"
    yield "|" + "---|" * (len(heads) + 2)
    for samples in SAMPLES:
        row = {cell: outcomes[loop.name, cell] for cell in CELLS if cell.samples == samples}
        texts = [shown(outcome, outcomes[loop.name, NOMINAL]) for outcome in row.values()]
        warned = "warns" if any(outcome.warned for outcome in row.values()) else ""
        yield f"| {samples:g} | {' | '.join(texts)} | {warned} |"


def read() -> Outcomes:
    """Outcomes as the document shows them.

    Raises
    ------
    FileNotFoundError
        There is none.
    """
    outcomes: dict[tuple[str, Cell], Outcome] = {}
    for name, body in re.findall(r"^## (\w+)\n(.*?)(?=^## |\Z)", FILE.read_text("utf-8"), re.M | re.S):
        rows = [line.strip("| ").split(" | ") for line in re.findall(r"^\| [\d.]+ .*", body, re.M)]
        for samples, row in zip(SAMPLES, rows, strict=True):
            cells = [cell for cell in CELLS if cell.samples == samples]
            for cell, text in zip(cells, row[1:], strict=False):
                outcomes[name, cell] = parsed(text, row[-1].endswith("warns"))
    return outcomes


def parsed(text: str, warned: bool) -> Outcome:
    """Outcome of a cell."""
    number = text.strip("*")
    if re.fullmatch(r"[\d.e-]+", number):
        return Outcome(float(number), "", warned)
    return Outcome(None, text, warned)
