"""Charts of a run that are not time series: paths, spectra, peaks, distributions, maps and others."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.loop.result import Result
from cosim.metrics.drawable import numbered
from cosim.metrics.expression import Expression, Items
from cosim.report import bode, curves, fields
from cosim.report.curves import Cells, Evaluate, Line
from cosim.scenario.model import Chart, Scenario
from cosim.show import marks
from cosim.show.marks import Named
from cosim.trace.columns import Array, Columns, InOrder

Limits = Mapping[str, Named]
"""Limits on values, by plotted column."""
FEW = 60
"""Maximum number of points with markers."""
CELLS = 60
"""Number of cells along the longer side of a map."""
STEPS = 65534
"""Number of steps from the minimum to the maximum of packed values; the next number is NaN."""
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


@dataclass(frozen=True)
class ChartData:
    """A chart with its lines or cells, marked positions of `x` and marked values."""

    chart: Chart
    lines: Sequence[Line] = ()
    cells: Cells | None = None
    marks: Named = ()
    levels: Named = ()

    @property
    def x_label(self) -> str:
        """Text of the `x` axis; fixed for a spectrum."""
        chart = self.chart
        if chart.x_label or chart.kind != "spectrum":
            return labelled(chart.x_label, chart.x_unit)
        return "waves per revolution" if chart.x else labelled("frequency", chart.x_unit or "Hz")

    @property
    def label(self) -> str:
        """Text of the other axis."""
        return labelled(self.chart.label, self.chart.unit)

    @property
    def points(self) -> bool:
        """Whether the lines have so few points that each has a marker."""
        return bool(self.lines) and all(len(line.x) <= FEW for line in self.lines)

    @property
    def integer(self) -> bool:
        """Whether all `x` are integers."""
        return bool(self.lines) and all(np.all(line.x == np.round(line.x)) for line in self.lines)

    def packed(self) -> dict[str, Any]:
        """Return plain data for the script of the page."""
        chart, cells = self.chart, self.cells
        return {
            "title": chart.title,
            "polar": chart.kind == "polar",
            "x_label": self.x_label,
            "label": self.label,
            "log": chart.log,
            "x_log": chart.x_log,
            "equal": chart.equal,
            "points": self.points,
            "integer": self.integer,
            "marks": self.marks,
            "levels": self.levels,
            "lines": [
                {
                    "name": line.name,
                    "x": packed_values(line.x, chart.x_log),
                    "y": packed_values(line.y, chart.log),
                }
                for line in self.lines
            ],
            "cells": None
            if cells is None
            else {"x": cells.x.tolist(), "y": cells.y.tolist(), **packed_values(cells.parts.ravel())},
        }


def packed_values(values: Array, log: bool = False) -> dict[str, Any]:
    """Values as text: 16 bits each between the minimum and the maximum; logarithms on a logarithmic axis.

    The error is at most 1 / 131068 of their span, which is less than a pixel of any screen.
    """
    if log:
        values = np.log10(np.where(values > 0.0, values, np.nan))
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    span = high - low or 1.0
    numbers: NDArray[np.uint16] = np.full(len(values), STEPS + 1, np.uint16)
    known = np.isfinite(values)
    numbers[known] = np.round((values[known] - low) / span * STEPS)
    text = base64.b64encode(numbers.astype("<u2").tobytes()).decode()
    return {"low": low, "span": span, "data": text}


def labelled(label: str, unit: str) -> str:
    """Text of an axis."""
    return f"{label} ({unit})" if unit and label else label or unit


def of_run(scenario: Scenario, result: Result) -> tuple[list[ChartData], list[str]]:
    """Make the nonempty charts of a run; return also the reasons for missing charts."""
    items = {name: result.items.get(name) for name in result.columns}
    limits = marks.limits(scenario, result)
    return of_columns(scenario.plot.charts, result.columns, items, scenario.file.parent, limits)


def of_columns(
    charts: Sequence[Chart],
    columns: Columns,
    items: Mapping[str, Items | None],
    folder: Path,
    limits: Limits,
) -> tuple[list[ChartData], list[str]]:
    """Make the nonempty charts of a table; return also the reasons for missing charts.

    `folder` is that of the file with the charts, `limits` are the limits on columns.
    """
    found: list[ChartData] = []
    undrawn = []
    for chart in charts:
        try:
            found += of_chart(chart, columns, items, folder, limits)
        except CosimError as error:
            undrawn.append(str(error))
    return found, undrawn


def of_chart(
    chart: Chart, columns: Columns, items: Mapping[str, Items | None], folder: Path, limits: Limits
) -> list[ChartData]:
    """Make the charts of one entry: two for `bode`, one for each map of a `field`, none without content."""
    if chart.kind == "bode":
        return open_loop(chart, columns)
    if chart.kind == "map":
        cells = map_cells(chart, columns, items)
        return [] if cells is None else [ChartData(chart, cells=cells)]
    if chart.kind == "field":
        maps = fields.maps(chart, selected(chart, columns, items), folder)
        return [ChartData(replace(chart, title=f"{chart.title}: {name}"), cells=one) for name, one in maps]
    drawn = lines(chart, columns, items)
    return [with_limits(chart, drawn, limits)] if drawn else []


def with_limits(chart: Chart, drawn: Sequence[Line], limits: Limits) -> ChartData:
    """Chart with the limits on its columns, as positions of `x` or as values, unless they flatten it."""
    found = dict.fromkeys(
        (chart.scale * limit, label)
        for name in chart.y
        for limit, label in limits.get(name, ())
        if chart.kind in LIMITED and not (chart.log and limit <= 0.0)
    )
    if chart.kind == "share":
        own = {(chart.x_scale / chart.scale * limit, label): None for limit, label in found}
        return ChartData(chart, drawn, marks=marks.visible([*own], [line.x for line in drawn]))
    return ChartData(chart, drawn, levels=marks.visible([*found], [line.y for line in drawn]))


def open_loop(chart: Chart, trace: Columns) -> list[ChartData]:
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
    x = chart.x_scale * found.frequency
    drawn = (
        ("gain", "", True, found.gain, 1.0),
        ("phase", "deg", False, np.degrees(found.phase), -180.0),
    )
    return [
        ChartData(
            replace(chart, title=f"{chart.title}: {name}", label=name, unit=unit, x_log=True, log=log),
            [Line(name, x, values)],
            marks=marked,
            levels=[(level, "")],
        )
        for name, unit, log, values, level in drawn
    ]


def evaluator(chart: Chart, columns: Columns, items: Mapping[str, Items | None]) -> Evaluate:
    """Return a function for the value of an expression of a chart in each row, shape (rows,).

    It raises an `ExpressionError` for neither one number nor one for each row.
    """
    table = InOrder(columns)

    def value(text: str) -> Array:
        expression = Expression(text, items, f"`plot.charts` `{chart.title}`")
        found, rows = np.asarray(expression(table), dtype=float), len(table[0])
        if found.ndim and len(found) != rows:
            raise expression.error(
                f"gives {len(found)} values for {rows} rows", "Select rows with `parts`, not with `[...]`."
            )
        return np.broadcast_to(found, (rows,))

    return value


def selected(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> list[Array]:
    """Values of each `y` in the rows that meet all parts."""
    value = evaluator(chart, trace, items)
    parts = [value(text) != 0.0 for text in chart.parts]
    rows = np.logical_and.reduce([np.ones(len(trace["time"]), dtype=bool), *parts])
    return [value(text)[rows] for text in chart.y]


def map_cells(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> Cells | None:
    """Sum of the weights in each cell, relative to the largest sum; None if it is not positive."""
    texts = (chart.x, chart.y[0], chart.weight, *chart.parts)
    x, y, weight, *parts = map(evaluator(chart, trace, items), texts)
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


def lines(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> list[Line]:
    """Lines of a chart, without empty and constant ones."""
    value = evaluator(chart, trace, items)
    masks = [value(part) != 0.0 for part in chart.parts] or [np.ones(len(trace["time"]), dtype=bool)]
    if chart.kind == "roc":
        named = zip(chart.y, chart.names or chart.y, strict=True)
        found = [line for y, name in named for line in curves.roc(name, value(y), *masks)]
    else:
        pairs = [(name, mask) for name in chart.y for mask in masks]
        names = chart.names or [
            f"{name}, {part}" if part else name for name in chart.y for part in chart.parts or ("",)
        ]
        found = [
            line
            for (text, mask), name in zip(pairs, names, strict=True)
            for line in KINDS[chart.kind](chart, name, value(text), mask, value)
        ]
    return [
        Line(line.name, chart.x_scale * line.x, chart.scale * line.y)
        for line in found
        if not constant(line.x, line.y)
    ]


def constant(x: Array, y: Array) -> bool:
    """Whether there is no point, or several ones that are the same within rounding."""
    known = np.isfinite(x) & np.isfinite(y)
    if np.count_nonzero(known) < 2:
        return not known.any()
    return all(np.ptp(each[known]) <= STILL * np.abs(each[known]).max() for each in (x, y))
