"""Plot of a run as SVG, PNG or PDF."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.fmu.description import DisplayUnit
from cosim.formatting.quantity import prefixed
from cosim.loop.result import Result
from cosim.metrics import drawable
from cosim.scenario.model import Panel, Scenario
from cosim.show import figure as figures
from cosim.show import marks
from cosim.show.marks import Named
from cosim.trace.columns import Array, Columns, InOrder, extremes, stepped
from cosim.trace.stored import StoredTrace

Labels = Result | StoredTrace
"""Sources of units of columns, and of items of those that are enumerations."""
MAX_PANELS = 6
MAX_COLUMNS = 8
MAX_EVENTS = 6
LIMIT: Any = {"color": "0.35", "linestyle": "--", "linewidth": 0.8}
EVENT: Any = {"color": "0.35", "linestyle": ":", "linewidth": 0.8}
BESIDE: Any = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0), "fontsize": 8}
"""Legend to the right of the axes."""
NAME: Any = {"fontsize": 7, "rotation": 90, "verticalalignment": "top"}


@dataclass(frozen=True)
class Curve:
    """A line of a panel in the unit of its axis; piecewise constant if `stepped`."""

    name: str
    times: Array
    values: Array
    stepped: bool


@dataclass(frozen=True)
class PanelData:
    """Content of a panel: curves in one unit, the items of an enumeration and the limits on the columns."""

    title: str
    unit: str
    curves: Sequence[Curve]
    log: bool = False
    items: Mapping[str, int] = field(default_factory=dict)
    limits: Named = ()


@dataclass(frozen=True)
class PlotView:
    """Panels of a run in a part of the time, s, with its events."""

    title: str
    begin: float
    end: float
    events: Named
    panels: Sequence[PanelData]


def views(scenario: Scenario, result: Result) -> list[PlotView]:
    """Make the views of a run: the whole run and, if its condition was met, the zoomed part."""
    trace = result.columns
    panels = scenario.plot.panels or default_panels(trace, result)
    events, limits = marks.events(scenario, result), marks.limits(scenario, result)
    windows = [("the whole run", np.ones(len(trace["time"]), dtype=bool))]
    zoom = zoomed(scenario, result, trace)
    if np.count_nonzero(zoom) > 1:
        windows.append((f"around {scenario.plot.zoom}", zoom))
    found = []
    for title, rows in windows:
        times = trace["time"][rows]
        made = [panel_data(panel, trace, rows, limits, result) for panel in panels]
        found.append(PlotView(title, float(times[0]), float(times[-1]), events_between(times, events), made))
    return found


def panel_data(
    panel: Panel, trace: Columns, rows: NDArray[np.bool_], limits: Mapping[str, Named], result: Result
) -> PanelData:
    """Curves of a panel in some rows, and the limits near them."""
    columns = [trace[name][rows] for name in panel.columns]
    unit = unit_of(panel, result, largest(columns))
    curves = [
        Curve(name, trace["time"][rows], unit.factor * values + unit.offset, stepped(values))
        for name, values in zip(panel.columns, columns, strict=True)
    ]
    # without a positive value there is nothing to show on a logarithmic axis
    log = panel.log and any(bool(np.any(curve.values > 0.0)) for curve in curves)
    limits_near = marks.panel_limits(panel, limits, unit, [curve.values for curve in curves])
    shown = [each for each in limits_near if not log or each[0] > 0.0]
    name = "" if unit.name == "1" else unit.name
    return PanelData(panel.title, name, curves, log, items_of(panel, result), shown)


def save(scenario: Scenario, result: Result, path: Path) -> None:
    """Plot the panels of a scenario into a file; by default all changing columns."""
    drawable.check(scenario, {name: result.items.get(name) for name in result.columns})
    shown = views(scenario, result)
    rows = max(1, len(shown[0].panels))
    with figures.styled((6.5 * len(shown) + 2.5, 1.2 + 1.7 * rows)) as figure:
        grid = figure.subplots(rows, len(shown), sharex="col", squeeze=False)
        for row, panels in zip(grid, zip(*(view.panels for view in shown), strict=True), strict=False):
            for axes, panel, view in zip(row, panels, shown, strict=True):
                draw(axes, panel, view.events)
                axes.set_ylabel(panel.unit)
            row[0].set_title(panels[0].title, fontsize=9, loc="left")
            # a limit may be far from the lines of one window and near those of another
            legends = [axes.get_legend_handles_labels() for axes in row]
            named = {label: line for legend in legends for line, label in zip(*legend, strict=True)}
            row[-1].legend(named.values(), named.keys(), **BESIDE)
        for axes in grid[-1]:
            axes.set_xlabel("time (s)")
        for axes, view in zip(grid[0], shown, strict=True):
            name_events(axes, view.events)
        verdict = {True: ", all criteria passed", False: ", some criteria failed", None: ""}[result.passed]
        figure.suptitle(f"{result.title}\n{result.scenario}, seed {result.seed}{verdict}", fontsize=10)
        figures.save(figure, path)


def draw(
    axes: Any, panel: PanelData, events: Named = (), buckets: int = 0, styles: Sequence[Any] = ("-",)
) -> None:
    """Draw a panel: curves, limits, events and the names of present items.

    `buckets` is the number of time intervals whose minimum and maximum are drawn (0: all rows), `styles` are
    those of the curves in their order.
    """
    for curve, style in zip(panel.curves, itertools.cycle(styles), strict=False):
        rows = extremes(curve.values, buckets) if buckets else slice(None)
        options: Any = {"linestyle": style, "drawstyle": "steps-post" if curve.stepped else "default"}
        axes.plot(curve.times[rows], curve.values[rows], label=curve.name, linewidth=1.1, **options)
    axes.margins(x=0.0)
    if panel.log:
        axes.set_yscale("log", nonpositive="mask")
    for limit, label in panel.limits:
        axes.axhline(limit, label=label or None, **LIMIT)
    for moment, _ in events:
        axes.axvline(moment, **EVENT)
    if panel.items:
        present = {number for curve in panel.curves for number in np.unique(curve.values)}
        named = {name: number for name, number in panel.items.items() if number in present}
        axes.set_yticks(list(named.values()), list(named))


def name_events(axes: Any, events: Named) -> None:
    """Write the names of events next to them."""
    for moment, label in events:
        axes.text(moment, 1.0, f" {label}", **NAME, transform=axes.get_xaxis_transform())


def events_between(times: Array, events: Named) -> Named:
    """Events between the first and last time with their texts; the last text counts the omitted ones."""
    found = [event for event in events if times[0] <= event[0] <= times[-1]]
    if (more := len(found) - MAX_EVENTS) > 0:
        t, last = found[MAX_EVENTS - 1]
        found[MAX_EVENTS - 1 :] = [(t, f"{last}, and {more} more")]
    return found


def unit_of(panel: Panel, result: Result, most: float) -> DisplayUnit:
    """Return the unit and scale of a panel: its own, otherwise the first display unit of its columns.

    Without both it is a prefix according to `most`, the largest absolute value.
    """
    if panel.unit or panel.scale != 1.0:
        return DisplayUnit(panel.unit, panel.scale)
    units = [result.units.get(column, "") for column in panel.columns]
    displays = [result.displays[column] for column in panel.columns if column in result.displays]
    if len(set(units)) != 1:
        return DisplayUnit(units[0])
    return displays[0] if displays else DisplayUnit(*prefixed(units[0], most))


def largest(columns: Iterable[NDArray[np.float64]]) -> float:
    """Largest absolute value of some columns; 0 if none is finite."""
    return max(float(np.max(np.abs(one), where=np.isfinite(one), initial=0.0)) for one in columns)


def items_of(panel: Panel, labels: Labels) -> dict[str, int]:
    """Names of the values of a panel whose columns are one enumeration; none for other panels."""
    first, *others = (labels.items.get(column, {}) for column in panel.columns)
    return first if all(items == first for items in others) else {}


def default_panels(trace: Columns, labels: Labels, every: bool = False) -> tuple[Panel, ...]:
    """Default panels of a trace: changing columns by enumeration or unit, and the number of omitted ones.

    A trace with only the time has none. `every` includes columns that do not change.
    """
    names = list(trace)[1:]
    if not names:
        return ()
    moving = [name for name in names if every or moves(trace[name])] or names[:1]
    groups: dict[tuple[tuple[str, ...], str], list[str]] = {}
    for name in moving:
        group = tuple(labels.items.get(name, ())), labels.units.get(name, "")
        groups.setdefault(group, []).append(name)
    # what the loop is doing comes first
    largest = sorted(groups.items(), key=lambda group: (not group[0][0], -len(group[1])))
    panels = [
        Panel(tuple(columns[:MAX_COLUMNS]), title=and_more("column", len(columns) - MAX_COLUMNS))
        for _, columns in largest[:MAX_PANELS]
    ]
    beyond = and_more("unit", len(largest) - MAX_PANELS)
    return *panels[:-1], replace(panels[-1], title=", ".join(filter(None, (panels[-1].title, beyond))))


def and_more(what: str, count: int) -> str:
    """Text about omitted items; empty if there are none."""
    return f"and {count} more {what}{'s' if count > 1 else ''}" if count > 0 else ""


def moves(column: NDArray[np.float64]) -> bool:
    """Whether a column has more than one value."""
    return bool(np.any(column != column[0]))


def zoomed(scenario: Scenario, result: Result, trace: Columns) -> NDArray[np.bool_]:
    """Rows of the zoomed part; none if there is no condition or it was never true."""
    condition = drawable.zoom(scenario, {name: result.items.get(name) for name in trace})
    moment = math.nan if condition is None else float(condition(InOrder(trace)))
    time = trace["time"]
    return (time >= moment - scenario.plot.before) & (time <= moment + scenario.plot.after)
