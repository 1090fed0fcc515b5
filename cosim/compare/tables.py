"""Tables of a comparison for a terminal."""

from __future__ import annotations

import math

from rich.console import Group, RenderableType
from rich.text import Text

from cosim.compare.comparison import Comparison, Deviation
from cosim.formatting.quantity import number, text
from cosim.show.listing import plain_table

NAMES = {"traces": "column", "results": "metric", "sweeps": "metric"}


def comparison(found: Comparison) -> RenderableType:
    """Deviating quantities, those beyond their tolerance first; other differences; the verdict."""
    parts: list[RenderableType] = []
    shown = sorted((d for d in found.deviations if d.deviation), key=lambda d: not d.outside)
    if shown:
        parts += [deviations(found, shown), ""]
    parts += [Text(f"differs: {sentence}", style="red") for sentence in found.differences]
    parts += [Text(f"note: {sentence}") for sentence in found.notes]
    if found.differences or found.notes:
        parts.append("")
    return Group(*parts, verdict(found))


def deviations(found: Comparison, shown: list[Deviation]) -> RenderableType:
    """Table of the largest deviations."""
    places = {"traces": ["at", "outside"], "sweeps": ["run", "outside"]}.get(found.kind, [])
    names = ("reference", "other", "largest deviation", "tolerance")
    table = plain_table(NAMES[found.kind], *names, *places, "within")
    for one in shown:
        curve = found.curves.get(one.name)
        items = {float(number): name for name, number in curve.items.items()} if curve else {}
        values = [items.get(value) or text(value, one.unit, 6) for value in (one.reference, one.value)]
        where = [] if one.at is None else [f"{one.at:g} s" if found.kind == "traces" else f"{one.at:.0f}"]
        counts = [f"{one.outside} of {one.compared}"] if places else []
        yes = Text("NO", style="bold red") if one.outside else Text("yes", style="green")
        cells = [*values, distance(one), text(one.tolerance, one.unit), *where, *counts]
        table.add_row(Text(one.name), *map(Text, cells), yes)
    return table


def distance(found: Deviation) -> str:
    """Deviation as text."""
    if math.isnan(found.reference) or math.isnan(found.value):
        return "not a number" if found.deviation else "0"
    return text(found.deviation, found.unit)


def verdict(found: Comparison) -> Text:
    """One line: number of quantities within their tolerance."""
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
