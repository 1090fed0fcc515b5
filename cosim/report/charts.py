"""Charts of a run that are not time series: paths, spectra, peaks, distributions, arrays, maps and others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import CosimError
from cosim.loop.result import Result
from cosim.metrics.drawable import numbered
from cosim.metrics.expression import Expression, Items
from cosim.report import bode, curves, fields, series
from cosim.report.curves import Cells, Line
from cosim.report.series import scaled
from cosim.scenario.model import Chart, Scenario
from cosim.show import marks
from cosim.trace.columns import Array, Columns, InOrder

Limits = Mapping[str, Sequence[tuple[float, str]]]
"""Limits on values with their texts, by plotted column."""
FEW = 60
"""Maximum number of points with markers."""
CELLS = 60
"""Number of cells along the longer side of a map."""
STILL = 1e-6
"""Relative change below which a value is constant."""
KINDS = {
    "path": curves.path,
    "polar": curves.path,
    "spectrum": curves.spectrum,
    "peaks": curves.peaks,
    "share": curves.share,
}
"""Functions that make the lines of a kind of chart."""
LIMITED = ("path", "polar", "peaks", "share")
"""Kinds that show values of `y` unchanged, and so their limits."""


def views(scenario: Scenario, result: Result) -> tuple[list[dict[str, Any]], list[str]]:
    """Make the nonempty charts of a run as plain data; return also the reasons for missing charts."""
    items = {name: result.items.get(name) for name in result.columns}
    limits = marks.limits(scenario, result)
    return of_columns(scenario.plot.charts, result.columns, items, scenario.file.parent, limits)


def of_columns(
    wanted: Sequence[Chart],
    columns: Columns,
    items: Mapping[str, Items | None],
    folder: Path,
    limits: Limits,
) -> tuple[list[dict[str, Any]], list[str]]:
    """Make the nonempty charts of a table as plain data; return also the reasons for missing charts.

    `folder` is that of the file with the charts, `limits` are the limits on columns.
    """
    found, undrawn = [], []
    for chart in wanted:
        try:
            if chart.kind == "map":
                cells = summed(chart, columns, items)
                found += [mapped(chart, cells)] if cells is not None else []
            elif chart.kind == "field":
                made = fields.maps(chart, picked(chart, columns, items), folder)
                found += [
                    mapped(replace(chart, title=f"{chart.title}: {name}"), cells) for name, cells in made
                ]
            elif chart.kind == "bode":
                found += loop_of(chart, columns)
            elif drawn := lines(chart, columns, items):
                found.append(view(chart, drawn, *limited(chart, drawn, limits)))
        except CosimError as error:
            undrawn.append(str(error))
    return found, undrawn


def evaluated(text: str, chart: Chart, table: InOrder, items: Mapping[str, Items | None]) -> Array:
    """Value of an expression of a chart in each row, shape (rows,).

    Raises
    ------
    ExpressionError
        It cannot be computed, or gives neither one number nor one for each row.
    """
    expression = Expression(text, items, f"`plot.charts` `{chart.title}`")
    found, rows = np.asarray(expression(table), dtype=float), len(table[0])
    if found.ndim and len(found) != rows:
        raise expression.error(
            f"gives {len(found)} values for {rows} rows", "Select rows with `parts`, not with `[...]`."
        )
    return np.broadcast_to(found, (rows,))


def axes(chart: Chart) -> dict[str, Any]:
    """Titles of a chart and its axes, and their kinds."""
    return {
        "title": chart.title,
        "polar": chart.kind == "polar",
        "x_label": labelled(*across(chart)),
        "label": labelled(chart.label, chart.unit),
        "log": chart.log,
        "x_log": chart.x_log,
        "equal": chart.equal,
        "points": False,
        "whole": False,
        "marks": [],
        "levels": [],
        "lines": [],
        "cells": None,
    }


def view(
    chart: Chart,
    drawn: list[Line],
    places: Sequence[tuple[float, str]] = (),
    levels: Sequence[tuple[float, str]] = (),
) -> dict[str, Any]:
    """One chart: its lines as numbers, with marked positions of `x` and marked values."""
    points = all(len(line.x) <= FEW for line in drawn)
    whole = all(np.all(line.x == np.round(line.x)) for line in drawn)
    return {
        **axes(chart),
        "points": points,
        "whole": whole,
        "marks": list(places),
        "levels": list(levels),
        "lines": [
            {
                "name": line.name,
                "x": series.packed(scaled(line.x, chart.x_log)),
                "y": series.packed(scaled(line.y, chart.log)),
            }
            for line in drawn
        ],
    }


def limited(
    chart: Chart, drawn: Sequence[Line], limits: Limits
) -> tuple[list[tuple[float, str]], list[tuple[float, str]]]:
    """Limits on the plotted columns, as positions of `x` and as values, unless they flatten the chart."""
    found = dict.fromkeys(
        (chart.scale * limit, label)
        for name in chart.y
        for limit, label in limits.get(name, ())
        if chart.kind in LIMITED and not (chart.log and limit <= 0.0)
    )
    if chart.kind == "share":
        own = {(chart.x_scale / chart.scale * limit, label): None for limit, label in found}
        return marks.seen([*own], [line.x for line in drawn]), []
    return [], marks.seen([*found], [line.y for line in drawn])


def loop_of(chart: Chart, trace: Columns) -> list[dict[str, Any]]:
    """Gain and phase of an open loop, each a chart, with the margins; none without two points."""
    frequency, gain, phase = (
        np.array([trace[one][-1] for one in numbered(name, trace)]) for name in (chart.x, *chart.y)
    )
    count = min(map(len, (frequency, gain, phase)))
    found = bode.response(frequency[:count], gain[:count], phase[:count], chart.closed)
    if found is None:
        return []
    margins = (found.phase_margin(), True), (found.gain_margin(), False)
    marked = [
        (chart.x_scale * margin.frequency, bode.margin_text(margin, chart.x_scale, chart.x_unit, is_phase))
        for margin, is_phase in margins
        if margin is not None
    ]
    places = chart.x_scale * found.frequency
    drawn = (
        ("gain", "", True, found.gain, 1.0),
        ("phase", "deg", False, np.degrees(found.phase), -180.0),
    )
    return [
        view(
            replace(chart, title=f"{chart.title}: {name}", label=name, unit=unit, x_log=True, log=log),
            [Line(name, places, values)],
            marked,
            [(level, "")],
        )
        for name, unit, log, values, level in drawn
    ]


def mapped(chart: Chart, cells: Cells) -> dict[str, Any]:
    """One map, as numbers."""
    held = {"x": cells.x.tolist(), "y": cells.y.tolist(), **series.packed(cells.parts.ravel())}
    return {**axes(chart), "cells": held}


def picked(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> list[Array]:
    """Values of each `y` in the rows that meet all parts."""
    table = InOrder(trace)
    parts = [evaluated(text, chart, table, items) != 0.0 for text in chart.parts]
    rows = np.logical_and.reduce([np.ones(len(trace["time"]), dtype=bool), *parts])
    return [evaluated(text, chart, table, items)[rows] for text in chart.y]


def summed(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> Cells | None:
    """Sum of the weights in each cell, relative to the largest sum; None if it is not positive."""
    table = InOrder(trace)
    x, y, weight, *parts = (
        evaluated(text, chart, table, items) for text in (chart.x, chart.y[0], chart.weight, *chart.parts)
    )
    rows = np.logical_and.reduce(
        [np.isfinite(x), np.isfinite(y), np.isfinite(weight), *(part != 0.0 for part in parts)]
    )
    if not rows.any() or not np.ptp(x[rows]) or not np.ptp(y[rows]):
        return None
    ends = [(float(each[rows].min()), float(each[rows].max())) for each in (x, y)]
    # square cells where both axes have the same scale
    size = max(high - low for low, high in ends) / CELLS
    counts = [max(1, round((high - low) / size)) if chart.equal else CELLS for low, high in ends]
    found, across, up = np.histogram2d(x[rows], y[rows], bins=counts, range=ends, weights=weight[rows])
    if not found.max() > 0.0:
        return None
    return Cells(chart.x_scale * across, chart.scale * up, found.T / found.max())


def across(chart: Chart) -> tuple[str, str]:
    """Label and unit of the `x` axis; fixed for a spectrum."""
    if chart.x_label or chart.kind != "spectrum":
        return chart.x_label, chart.x_unit
    return ("waves per revolution", "") if chart.x else ("frequency", chart.x_unit or "Hz")


def labelled(label: str, unit: str) -> str:
    """Text of an axis."""
    return f"{label} ({unit})" if unit and label else label or unit


def lines(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> list[Line]:
    """Lines of a chart, without empty and constant ones."""
    table = InOrder(trace)
    rows = len(trace["time"])

    def value(text: str) -> Array:
        return evaluated(text, chart, table, items)

    if chart.kind == "array":
        found = [curves.array(name, chart, trace) for name in chart.y]
    elif chart.kind == "roc":
        quiet, sought = (value(part) != 0.0 for part in chart.parts)
        named = zip(chart.y, chart.names or chart.y, strict=True)
        found = [line for y, name in named for line in curves.roc(name, value(y), quiet, sought)]
    else:
        masks = [value(part) != 0.0 for part in chart.parts] or [np.ones(rows, dtype=bool)]
        pairs = [(name, mask) for name in chart.y for mask in masks]
        names = chart.names or [
            name if not chart.parts else f"{name}, {part}"
            for name in chart.y
            for part in chart.parts or ("",)
        ]
        found = [
            line
            for (text, mask), name in zip(pairs, names, strict=True)
            for line in KINDS[chart.kind](chart, name, value(text), mask, value, trace)
        ]
    return [
        Line(line.name, chart.x_scale * line.x, chart.scale * line.y)
        for line in found
        if not stands(line.x, line.y)
    ]


def stands(x: Array, y: Array) -> bool:
    """Whether there is no point, or only one within rounding."""
    known = np.isfinite(x) & np.isfinite(y)
    moved = (
        [np.ptp(each[known]) > STILL * np.abs(each[known]).max() for each in (x, y)] if known.any() else []
    )
    return not any(moved) and np.count_nonzero(known) != 1
