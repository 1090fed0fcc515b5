"""Tables of a comparison for a terminal; its plot with tubes, compared curves, and rows outside."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.text import Text

from cosim.compare.comparison import Comparison, Deviation
from cosim.errors import CosimError
from cosim.formatting.quantity import number, text
from cosim.show import figure as figures
from cosim.show.listing import plain_table

MAX_PANELS = 6
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
        is_nan = math.isnan(one.reference) or math.isnan(one.value)
        distance = "not a number" if is_nan else text(one.deviation, one.unit)
        yes = Text("NO", style="bold red") if one.outside else Text("yes", style="green")
        cells = [*values, distance, text(one.tolerance, one.unit), *where, *counts]
        table.add_row(Text(one.name), *map(Text, cells), yes)
    return table


def verdict(found: Comparison) -> Text:
    """One line: number of quantities within their tolerance."""
    noun = NAMES[found.kind] + ("" if len(found.deviations) == 1 else "s")
    count, outside = len(found.deviations), len(found.outside)
    equal = sum(not d.deviation for d in found.deviations)
    what = f"`{found.other}` against `{found.reference}`: "
    if outside:
        what += f"{outside} of {number(count)} {noun} beyond tolerance"
    else:
        what += f"{count} {noun} {'' if equal == count else f'within tolerance, {equal} of them '}equal"
    if found.differences:
        what += f", {len(found.differences)} other difference{'s' if len(found.differences) > 1 else ''}"
    return Text(what, style="bold green" if found.within else "bold red")


def check_plot(kind: str, path: Path) -> None:
    """Check before the comparison that the plot can be made."""
    if kind != "trace":
        raise CosimError(f"`--plot` cannot be used with a {kind}", "Use `--plot` with traces only.")
    figures.check(path)


def save_plot(found: Comparison, path: Path) -> None:
    """Plot up to six columns with the largest deviations relative to their tolerance."""
    drawn = sorted(found.deviations, key=lambda d: (-d.ratio, -d.outside))[:MAX_PANELS]
    with figures.styled((9.0, 1.2 + 1.7 * len(drawn))) as figure:
        grid = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)
        for (axes,), deviation in zip(grid, drawn, strict=True):
            plot_column(axes, found, deviation)
        grid[0][0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
        grid[-1][0].set_xlabel("time (s)")
        figure.suptitle(f"{found.other} against {found.reference}", fontsize=10)
        figures.save(figure, path)


def plot_column(axes: Any, found: Comparison, deviation: Deviation) -> None:
    """Plot one column."""
    curve = found.curves[deviation.name]
    low, high = curve.tube.walls
    axes.fill_between(curve.times, low, high, color="tab:green", alpha=0.3, label="tolerance")
    axes.plot(curve.times, 0.5 * (low + high), color="tab:green", linewidth=0.8, label="reference")
    axes.plot(curve.times, curve.values, color="tab:blue", linewidth=0.8, label="other")
    outside = curve.tube.deviation(curve.values) > curve.tube.tolerance(curve.values)
    where = np.where(outside, curve.values, np.nan)
    axes.plot(curve.times, where, ".", color="tab:red", markersize=3.0, label="outside", rasterized=True)
    unit = f" ({deviation.unit})" if deviation.unit not in ("", "1") else ""
    axes.set_title(f"{deviation.name}{unit}", fontsize=9, loc="left")
