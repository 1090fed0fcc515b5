"""Charts of a run that are not time series: paths, spectra, peaks, distributions, maps and others."""

from __future__ import annotations

import base64
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError, ScenarioError, closest
from cosim.loop import own_code
from cosim.loop.result import Result
from cosim.metrics.drawable import numbered
from cosim.metrics.expression import Expression, Items
from cosim.report import curves
from cosim.report.curves import Cells, Evaluate, Line
from cosim.scenario.model import Chart, Scenario
from cosim.show import marks
from cosim.show.marks import Named
from cosim.trace.columns import Array, Columns, InOrder

Limits = Mapping[str, Named]
"""Limits on values, by plotted column."""
KnownItems = Mapping[str, Items | None]
"""Items of enumerations by column; None for other columns."""
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
        """Whether the `x` axis has ticks only at integers: all `x` are, and it is not logarithmic."""
        integers = (bool(np.all(line.x == np.round(line.x))) for line in self.lines)
        return bool(self.lines) and not self.chart.x_log and all(integers)

    def packed(self) -> dict[str, Any]:
        """Return plain data for the script of the page."""
        chart, cells = self.chart, self.cells
        own = ("x_label", "label", "points", "integer", "marks", "levels")
        return {
            **{name: getattr(chart, name) for name in ("title", "log", "x_log", "equal")},
            **{name: getattr(self, name) for name in own},
            "polar": chart.kind == "polar",
            "lines": [
                {"name": name, "x": packed_values(x, chart.x_log), "y": packed_values(y, chart.log)}
                for name, x, y in self.lines
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
    known = np.isfinite(values)
    finite = values[known]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    span = high - low or 1.0
    numbers = np.full(len(values), STEPS + 1, "<u2")
    numbers[known] = np.round((finite - low) / span * STEPS)
    return {"low": low, "span": span, "data": base64.b64encode(numbers.tobytes()).decode()}


def labelled(label: str, unit: str) -> str:
    """Text of an axis."""
    return f"{label} ({unit})" if unit and label else label or unit


def of_run(scenario: Scenario, result: Result) -> tuple[list[ChartData], list[str]]:
    """Make the nonempty charts of a run; return also the reasons for missing charts."""
    items = {name: result.items.get(name) for name in result.columns}
    limits = marks.limits(scenario, result)
    return of_columns(scenario.plot.charts, result.columns, items, scenario.file.parent, limits)


def of_columns(
    charts: Sequence[Chart], columns: Columns, items: KnownItems, folder: Path, limits: Limits
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
    chart: Chart, columns: Columns, items: KnownItems, folder: Path, limits: Limits
) -> list[ChartData]:
    """Make the charts of one entry: two for `bode`, one for each map of a `field`, none without content."""
    if chart.kind == "bode":
        return open_loop(chart, columns)
    value = evaluator(chart, columns, items)
    if chart.kind == "map":
        cells = map_cells(chart, value)
        return [] if cells is None else [ChartData(chart, cells=cells)]
    if chart.kind == "field":
        rows = np.logical_and.reduce(masks(chart, value))
        maps = field_maps(chart, [value(text)[rows] for text in chart.y], folder)
        return [ChartData(replace(chart, title=f"{chart.title}: {name}"), cells=one) for name, one in maps]
    drawn = lines(chart, value)
    return [with_limits(chart, drawn, limits)] if drawn else []


def with_limits(chart: Chart, drawn: Sequence[Line], limits: Limits) -> ChartData:
    """Chart with the limits on its columns, as positions of `x` or as values, unless they flatten it."""
    found = [
        (chart.scale * limit, label)
        for name in chart.y
        for limit, label in limits.get(name, ())
        if chart.kind in LIMITED and not (chart.log and limit <= 0.0)
    ]
    if chart.kind == "share":
        own = [(chart.x_scale / chart.scale * limit, label) for limit, label in found]
        return ChartData(chart, drawn, marks=marks.visible(own, [line.x for line in drawn]))
    return ChartData(chart, drawn, levels=marks.visible(found, [line.y for line in drawn]))


def open_loop(chart: Chart, trace: Columns) -> list[ChartData]:
    """Gain and phase of an open loop, each a chart, with the margins; none without two points."""
    names = zip(*(numbered(name, trace) for name in (chart.x, *chart.y)), strict=False)
    points = [[trace[name][-1] for name in point] for point in names]
    frequency, gain, phase = np.array(points).reshape(-1, 3).T
    found = curves.response(frequency, gain, phase, chart.closed)
    if found is None:
        return []
    x = chart.x_scale * found.frequency
    marked = [
        (chart.x_scale * at, f"{text} at {chart.x_scale * at:.4g} {chart.x_unit}".strip())
        for at, text in found.margins()
    ]
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


def evaluator(chart: Chart, columns: Columns, items: KnownItems) -> Evaluate:
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


def masks(chart: Chart, value: Evaluate) -> list[NDArray[np.bool_]]:
    """Rows of each part; all rows without parts."""
    return [value(part) != 0.0 for part in chart.parts or ("1",)]


def map_cells(chart: Chart, value: Evaluate) -> Cells | None:
    """Sum of the weights in each cell, relative to the largest sum; None if it is not positive."""
    x, y, weight = map(value, (chart.x, chart.y[0], chart.weight))
    rows = np.logical_and.reduce([*map(np.isfinite, (x, y, weight)), *masks(chart, value)])
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


def lines(chart: Chart, value: Evaluate) -> list[Line]:
    """Lines of a chart, without empty and constant ones."""
    rows = masks(chart, value)
    found: list[Line] = []
    if chart.kind == "roc":
        for y, name in zip(chart.y, chart.names or chart.y, strict=True):
            found += curves.roc(name, value(y), *rows)
    else:
        parts = [f", {part}" for part in chart.parts] or [""]
        names = chart.names or [y + part for y in chart.y for part in parts]
        for (y, mask), name in zip(itertools.product(chart.y, rows), names, strict=True):
            found += KINDS[chart.kind](chart, name, value(y), mask, value)
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


def field_maps(chart: Chart, values: Sequence[Array], folder: Path) -> list[tuple[str, Cells]]:
    """Make the maps of a chart by name, relative to the largest value; none if it is not above 0.

    `values` are the arguments of the function, `folder` is that of the scenario. An error if there is no such
    function, it raises, or its result is not a set of maps.
    """
    where = f"`plot.charts` `{chart.title}`: the function `{chart.function}`"
    function = import_function(chart.function, where, folder)
    try:
        made = {
            str(name): [np.asarray(part, dtype=float) for part in one]
            for name, one in function(*values).items()
        }
    except Exception as error:  # the function may raise anything
        problem = f"{where} failed: {type(error).__name__}: {error}"
        raise ScenarioError(problem, "Show the origin with `-v`.") from error
    for name, one in made.items():
        shapes = [part.shape for part in one]
        if [part.ndim for part in one] != [1, 1, 2] or shapes[2] != (len(one[1]) - 1, len(one[0]) - 1):
            problem = f"{where} gives `{name}` of the shapes {shapes}"
            hint = "Return edges along x (n + 1), edges along y (m + 1), and values (m, n)."
            raise ScenarioError(problem, hint)
    known = {name: np.where(np.isfinite(part), part, 0.0) for name, (_, _, part) in made.items()}
    most = max((float(part.max(initial=0.0)) for part in known.values()), default=0.0)
    return [
        (name, Cells(chart.x_scale * x, chart.scale * y, known[name] / most))
        for name, (x, y, _) in made.items()
        if most > 0.0
    ]


def import_function(name: str, where: str, folder: Path) -> Any:
    """Import the function of that name."""
    module_name, _, function = name.partition(":")
    try:
        module = own_code.module(module_name, folder)
    except Exception as error:  # the module may raise anything
        problem = f"{where} cannot be imported: {type(error).__name__}: {error}"
        raise ScenarioError(problem, own_code.where(folder)) from error
    if not callable(getattr(module, function, None)):
        public = [key for key, value in vars(module).items() if callable(value)]
        raise ScenarioError(f"{where} does not exist", closest(function, public))
    return getattr(module, function)
