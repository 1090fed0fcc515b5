"""A comparison for a terminal."""

from __future__ import annotations

import math

from rich.console import Group, RenderableType
from rich.text import Text

from cosim.compare.comparison import Comparison, Deviation
from cosim.show.display import plain_table
from cosim.show.quantity import number, text

NAMES = {"traces": "column", "results": "metric", "sweeps": "metric"}


def comparison(found: Comparison) -> RenderableType:
    """Quantities that deviate, those beyond their tolerance first; what else differs; the verdict."""
    parts: list[RenderableType] = []
    shown = sorted((d for d in found.deviations if d.deviation), key=lambda d: not d.outside)
    if shown:
        parts += [deviations(found.kind, shown), ""]
    parts += [Text(f"differs: {sentence}", style="red") for sentence in found.differences]
    parts += [Text(f"note: {sentence}") for sentence in found.notes]
    if found.differences or found.notes:
        parts.append("")
    return Group(*parts, verdict(found))


def deviations(kind: str, shown: list[Deviation]) -> RenderableType:
    """Table of the largest deviations."""
    place = {"traces": ["at"], "sweeps": ["run"]}.get(kind, [])
    within = ["outside"] if place else []
    table = plain_table(
        NAMES[kind], "reference", "other", "largest deviation", "tolerance", *place, *within, "within"
    )
    for found in shown:
        where = [] if found.at is None else [f"{found.at:g} s" if kind == "traces" else f"{found.at:.0f}"]
        counts = [f"{found.outside} of {found.compared}"] if place else []
        yes = Text("NO", style="bold red") if found.outside else Text("yes", style="green")
        deviation = text(found.deviation, found.unit) if math.isfinite(found.deviation) else "not a number"
        values = [text(value, found.unit, 6) for value in (found.reference, found.value)]
        table.add_row(
            Text(found.name), *values, deviation, text(found.tolerance, found.unit), *where, *counts, yes
        )
    return table


def verdict(found: Comparison) -> Text:
    """One line: how many quantities are within their tolerance."""
    noun = NAMES[found.kind] + ("" if len(found.deviations) == 1 else "s")
    count, outside = len(found.deviations), len(found.outside)
    equal = sum(not d.deviation for d in found.deviations)
    what = f"`{found.other}` against `{found.reference}`: "
    if outside:
        what += f"{outside} of {number(count)} {noun} beyond tolerance"
    elif equal == count:
        what += f"{count} {noun} equal"
    else:
        what += f"{count} {noun} within tolerance, {equal} of them equal"
    if found.differences:
        what += f", {len(found.differences)} other difference{'s' if len(found.differences) > 1 else ''}"
    return Text(what, style="bold green" if found.within else "bold red")
