"""Drawings of a run that are not over the time: paths, spectra, peaks, shares, arrays, maps and the like."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.loop.result import Result
from cosim.metrics.drawable import numbered
from cosim.metrics.expression import Expression, Items
from cosim.report import bode, drawing, fields, series
from cosim.report.drawing import Cells
from cosim.report.series import scaled
from cosim.scenario.model import Chart, Scenario
from cosim.trace.columns import Array, Columns, InOrder

MOST_POINTS = 2 * series.BUCKETS
FEW = 60
"""Points that are marked each."""
CELLS = 60
"""Cells of a map along its longer side."""
ORDERS = 40
"""Waves per turn that a spectrum over an angle shows."""
PER_TURN = 512
"""Samples of a turn from which they are taken."""
STILL = 1e-6
"""Part of its size by which a value moves at most that stands still."""
MOST_LINES = 12
"""Lines of a path that is split; the last takes all values from there on."""


@dataclass(frozen=True)
class Line:
    """One line of a chart: its points, in the units of the axes."""

    name: str
    x: Array
    y: Array


Evaluate = Callable[[str], Array]


def views(scenario: Scenario, result: Result) -> tuple[list[dict[str, Any]], list[str]]:
    """Make the charts of a run that have something to show as plain data; and tell what cannot be drawn."""
    items = {name: result.items.get(name) for name in result.columns}
    return of_columns(scenario.plot.charts, result.columns, items, scenario.file.parent)


def of_columns(
    wanted: Sequence[Chart], columns: Columns, items: Mapping[str, Items | None], folder: Path
) -> tuple[list[dict[str, Any]], list[str]]:
    """Make the charts of a table that have something to show as plain data; and tell what cannot be drawn.

    `folder` is that of the file which wants them.
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
                found.append(view(chart, drawn))
        except CosimError as error:
            undrawn.append(str(error))
    return found, undrawn


def evaluated(text: str, chart: Chart, table: InOrder, items: Mapping[str, Items | None]) -> Array:
    """Value of an expression of a chart in each row, shape (rows,).

    Raises
    ------
    ExpressionError
        It cannot be computed, or gives neither one number nor one of each row.
    """
    expression = Expression(text, items, f"`plot.charts` `{chart.title}`")
    found, rows = np.asarray(expression(table), dtype=float), len(table[0])
    if found.ndim and len(found) != rows:
        raise expression.error(
            f"gives {len(found)} values for {rows} rows", "pick rows with `parts` and not with `[...]`"
        )
    return np.broadcast_to(found, (rows,))


def axes(chart: Chart) -> dict[str, Any]:
    """Tell what a chart and its axes are called, and their kinds."""
    return {
        "title": chart.title,
        "x_label": labelled(chart.x_label, chart.x_unit),
        "label": labelled(chart.label, chart.unit),
        "log": chart.log,
        "x_log": chart.x_log,
        "equal": chart.equal,
        "points": False,
        "marks": [],
        "levels": [],
        "lines": [],
        "cells": None,
    }


def view(
    chart: Chart,
    drawn: list[Line],
    marks: Sequence[tuple[float, str]] = (),
    levels: Sequence[float] = (),
) -> dict[str, Any]:
    """One chart: its lines as numbers and as a drawing, with places of `x` and values that are marked."""
    points = all(len(line.x) <= FEW for line in drawn)
    shown = [(scaled(line.x, chart.x_log), scaled(line.y, chart.log)) for line in drawn]
    return {
        **axes(chart),
        "points": points,
        "marks": list(marks),
        "levels": list(levels),
        "lines": [
            {"name": line.name, "x": series.packed(x), "y": series.packed(y)}
            for line, (x, y) in zip(drawn, shown, strict=True)
        ],
        "svg": drawing.chart(
            shown,
            drawing.Kind(chart.x_log, chart.log, chart.equal, points),
            [(float(scaled(np.array([x]), chart.x_log)[0]), text) for x, text in marks],
            scaled(np.array(levels), chart.log).tolist(),
        ),
    }


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
    marks = [
        (chart.x_scale * margin.frequency, bode.told(margin, chart.x_scale, chart.x_unit, is_phase))
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
            marks,
            [level],
        )
        for name, unit, log, values, level in drawn
    ]


def mapped(chart: Chart, cells: Cells) -> dict[str, Any]:
    """One map, as numbers and as a drawing."""
    held = {"x": cells.x.tolist(), "y": cells.y.tolist(), **series.packed(cells.parts.ravel())}
    return {**axes(chart), "cells": held, "svg": drawing.cells(cells, chart.equal)}


def picked(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> list[Array]:
    """Values of each `y` in the rows in which all parts hold."""
    table = InOrder(trace)
    parts = [evaluated(text, chart, table, items) != 0.0 for text in chart.parts]
    rows = np.logical_and.reduce([np.ones(len(trace["time"]), dtype=bool), *parts])
    return [evaluated(text, chart, table, items)[rows] for text in chart.y]


def summed(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> Cells | None:
    """Sum up the weight of the rows in each cell, in parts of the largest sum; None where there is none."""
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


def labelled(label: str, unit: str) -> str:
    """Text of an axis."""
    return f"{label} ({unit})" if unit and label else label or unit


def lines(chart: Chart, trace: Columns, items: Mapping[str, Items | None]) -> list[Line]:
    """Lines of a chart; one without a point or that stands still is left out."""
    table = InOrder(trace)
    rows = len(trace["time"])

    def value(text: str) -> Array:
        return evaluated(text, chart, table, items)

    if chart.kind == "array":
        found = [array(name, chart, trace) for name in chart.y]
    elif chart.kind == "roc":
        quiet, sought = (value(part) != 0.0 for part in chart.parts)
        named = zip(chart.y, chart.names or chart.y, strict=True)
        found = [line for y, name in named for line in roc(name, value(y), quiet, sought)]
    else:
        kind = {"path": path, "spectrum": spectrum, "peaks": peaks, "share": share}[chart.kind]
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
            for line in kind(chart, name, value(text), mask, value, trace)
        ]
    return [
        Line(line.name, chart.x_scale * line.x, chart.scale * line.y)
        for line in found
        if not stands(line.x, line.y)
    ]


def stands(x: Array, y: Array) -> bool:
    """Whether points are none, or one but for rounding."""
    known = np.isfinite(x) & np.isfinite(y)
    moved = (
        [np.ptp(each[known]) > STILL * np.abs(each[known]).max() for each in (x, y)] if known.any() else []
    )
    return not any(moved) and np.count_nonzero(known) != 1


def path(chart: Chart, name: str, y: Array, mask: Any, value: Evaluate, trace: Columns) -> list[Line]:
    """One value over another in the order of the rows, a line for each value of the split."""
    x = value(chart.x)
    if not chart.split:
        return [Line(name, *few(x[mask], y[mask]))]
    split = value(chart.split)
    turns = np.unique(split[mask & np.isfinite(split)])
    last = turns[min(len(turns), MOST_LINES) - 1] if len(turns) else np.nan
    several = len(chart.y) > 1 or len(chart.parts) > 1
    found = []
    for turn in turns[:MOST_LINES]:
        rest = turn == last and len(turns) > MOST_LINES
        rows = mask & (split >= turn if rest else split == turn)
        told = f"{chart.split_name} {turn:g}{' and on' if rest else ''}".strip()
        told = f"{name}, {told}" if several else told
        found.append(Line(told, *few(x[rows], y[rows])))
    return found


def few(x: Array, y: Array) -> tuple[Array, Array]:
    """As many points as can be seen: in equal steps the rows with the least and the largest `x` and `y`."""
    if len(y) <= MOST_POINTS:
        return x, y
    rows = np.unique(np.concatenate([series.extremes(each, MOST_POINTS // 4) for each in (x, y)]))
    return x[rows], y[rows]


def spectrum(chart: Chart, name: str, y: Array, mask: Any, value: Evaluate, trace: Columns) -> list[Line]:
    """Amplitudes by frequency in Hz, or by waves per turn over an angle, of whole turns without the mean.

    Both are those of the longest stretch without a gap.
    """
    if not chart.x:
        rows = unbroken(mask & np.isfinite(y))
        times = trace["time"][rows]
        return [by_frequency(name, times, y[rows])] if len(times) > 3 else []
    angle = value(chart.x)
    rows = unbroken(mask)
    rows = rows[np.isfinite(angle[rows]) & np.isfinite(y[rows])]
    angle, y = np.abs(angle[rows] - angle[rows][:1]), y[rows]
    turns = int(angle[-1] / (2.0 * np.pi)) if len(angle) else 0
    if turns < 1 or np.any(np.diff(angle) < 0.0):
        return []
    # the last turns: what came before may not have settled
    places = angle[-1] - 2.0 * np.pi * np.arange(turns * PER_TURN)[::-1] / PER_TURN
    waves = np.abs(np.fft.rfft(np.interp(places, angle, y))) * 2.0 / len(places)
    orders = np.arange(1, ORDERS + 1)
    return [Line(name, orders.astype(float), waves[orders * turns])]


def unbroken(mask: Any) -> NDArray[np.int64]:
    """Rows of the longest stretch without a gap of those that a mask has."""
    rows = np.flatnonzero(mask)
    return max(np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1), key=len)


def by_frequency(name: str, times: Array, y: Array) -> Line:
    """Amplitudes of sines under a Hann window: a sine between two frequencies has up to 15 % less."""
    window = np.hanning(len(y))
    waves = np.abs(np.fft.rfft((y - y.mean()) * window)) * 2.0 / window.sum()
    frequencies = np.fft.rfftfreq(len(y), float(times[1] - times[0])).astype(np.float64)
    return Line(name, *few(frequencies[1:], waves[1:]))


def peaks(chart: Chart, name: str, y: Array, mask: Any, value: Evaluate, trace: Columns) -> list[Line]:
    """Largest absolute value for each value of the split."""
    split = value(chart.split)
    turns = np.unique(split[mask & np.isfinite(split)])
    return [Line(name, turns, np.array([np.max(np.abs(y[mask & (split == turn)])) for turn in turns]))]


def share(chart: Chart, name: str, y: Array, mask: Any, value: Evaluate, trace: Columns) -> list[Line]:
    """Share of the rows in which a value is at most that."""
    found = np.sort(y[mask & np.isfinite(y)])
    if not len(found):
        return []
    at = np.unique(np.linspace(0, len(found) - 1, MOST_POINTS).astype(int))
    return [Line(name, found[at], (at + 1) / len(found))]


def roc(name: str, y: Array, quiet: Any, sought: Any) -> list[Line]:
    """Share of the rows sought above a threshold, over that of the quiet ones, for all thresholds."""
    air, contact = (np.sort(y[rows & np.isfinite(y)]) for rows in (quiet, sought))
    if not len(air) or not len(contact):
        return []
    # from the largest down, and beyond both
    thresholds = np.append(np.unique(np.concatenate([air, contact]))[::-1], -np.inf)
    thresholds = thresholds[np.unique(np.linspace(0, len(thresholds) - 1, MOST_POINTS).astype(int))]
    above = [1.0 - np.searchsorted(each, thresholds, side="right") / len(each) for each in (air, contact)]
    return [Line(name, above[0], above[1])]


def array(name: str, chart: Chart, trace: Columns) -> Line:
    """Last row of an array over that of another; what was never set, 0 on the axis of x, is left out."""
    x, y = (np.array([trace[one][-1] for one in numbered(each, trace)]) for each in (chart.x, name))
    count = min(len(x), len(y))
    set_ = x[:count] != 0.0
    label = dict(zip(chart.y, chart.names, strict=False)).get(name, name)
    return Line(label, x[:count][set_], y[:count][set_])
