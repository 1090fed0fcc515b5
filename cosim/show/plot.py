"""Plot of a run as SVG, PNG or PDF."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cosim.fmu.archive import DisplayUnit
from cosim.formatting.quantity import prefixed
from cosim.loop.result import Result
from cosim.metrics import drawable
from cosim.scenario.model import Panel, Scenario
from cosim.show import figure as figures
from cosim.show import marks
from cosim.show.marks import Marked
from cosim.trace.columns import Array, Columns, InOrder, stepped

MAX_PANELS = 6
MAX_COLUMNS = 8
MAX_EVENTS = 6
LIMIT: Any = {"color": "0.35", "linestyle": "--", "linewidth": 0.8}
EVENT: Any = {"color": "0.35", "linestyle": ":", "linewidth": 0.8}
Named: TypeAlias = Sequence[tuple[float, str]]
"""Limits or times of events with their texts."""
NAME: Any = {"fontsize": 7, "rotation": 90, "verticalalignment": "top"}


class Labels(Protocol):
    """Units of columns, and the items of those that are enumerations."""

    @property
    def units(self) -> dict[str, str]:
        """Unit by column."""

    @property
    def items(self) -> dict[str, dict[str, int]]:
        """Items by column."""


def save(scenario: Scenario, result: Result, path: Path) -> None:
    """Plot the panels of a scenario into a file; by default all changing columns.

    Raises
    ------
    CosimError
        The result holds no trace, a plotted column is missing, or the file cannot be written.
    """
    trace = result.columns
    drawable.check(scenario, {name: result.items.get(name) for name in trace})
    panels = scenario.plot.panels or default_panels(trace, result)
    windows = [np.ones(len(trace["time"]), dtype=bool), *zoomed(scenario, result, trace)]
    marked = marks.marked(scenario, result)
    rows = max(1, len(panels))
    with figures.styled((6.5 * len(windows) + 2.5, 1.2 + 1.7 * rows)) as figure:
        grid = figure.subplots(rows, len(windows), sharex="col", squeeze=False)
        for row, panel in zip(grid, panels, strict=False):
            for axes, window in zip(row, windows, strict=True):
                shown = {name: trace[name][window] for name in ("time", *panel.columns)}
                draw(axes, shown, panel, result, marked)
            row[0].set_title(panel.title, fontsize=9, loc="left")
            # a limit may be far from the lines of one window and near those of another
            named = {
                label: line
                for axes in row
                for line, label in zip(*axes.get_legend_handles_labels(), strict=True)
            }
            row[-1].legend(
                named.values(), named.keys(), loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8
            )
        for axes in grid[-1]:
            axes.set_xlabel("time (s)")
        for axes, window in zip(grid[0], windows, strict=True):
            name_events(axes, inside(trace["time"][window], marked))
        figure.suptitle(heading(result), fontsize=10)
        figures.save(figure, path)


def heading(result: Result) -> str:
    """Title of the figure."""
    verdict = ""
    if result.criteria:
        verdict = ", all criteria passed" if result.passed else ", some criteria failed"
    return f"{result.title}\n{result.scenario}, seed {result.seed}{verdict}"


def draw(axes: Any, trace: Columns, panel: Panel, result: Result, marked: Marked) -> None:
    """Plot one panel; piecewise constant values (modes, flags) as steps, enumerations with names."""
    lines = []
    shown = unit_of(panel, result, largest(trace[column] for column in panel.columns))
    positive = False
    for column in panel.columns:
        values = shown.factor * trace[column] + shown.offset
        positive |= bool(np.any(values > 0.0))
        style = "steps-post" if stepped(trace[column]) else "default"
        lines.append(values)
        axes.plot(trace["time"], values, label=column, linewidth=1.1, drawstyle=style)
    axes.set_ylabel("" if shown.name == "1" else shown.name)
    axes.margins(x=0.0)
    # without a positive value there is nothing to show on a logarithmic axis
    if panel.log and positive:
        axes.set_yscale("log", nonpositive="mask")
    limits, events = marks.near(panel, marked, shown, lines), inside(trace["time"], marked)
    mark(axes, limits, events, panel.log, items_of(panel, result))


def mark(axes: Any, limits: Named, events: Named, log: bool, items: Mapping[str, int] | None = None) -> None:
    """Draw limits, events and the names of present items; a logarithmic axis has only positive limits."""
    present = {float(number) for line in axes.get_lines() for number in np.unique(line.get_ydata())}
    for limit, label in limits:
        if not log or limit > 0.0:
            axes.axhline(limit, label=label or None, **LIMIT)
    for moment, _ in events:
        axes.axvline(moment, **EVENT)
    if items:
        named = {name: number for name, number in items.items() if number in present}
        axes.set_yticks(list(named.values()), list(named))


def name_events(axes: Any, events: Named) -> None:
    """Write the names of events next to them."""
    for moment, label in events:
        axes.text(moment, 1.0, f" {label}", **NAME, transform=axes.get_xaxis_transform())


def inside(times: Array, marked: Marked) -> list[tuple[float, str]]:
    """Events between the first and last time with their texts; the last text counts the omitted ones."""
    found = [event for event in marked.events if times[0] <= event[0] <= times[-1]]
    if (more := len(found) - MAX_EVENTS) > 0:
        t, last = found[MAX_EVENTS - 1]
        found[MAX_EVENTS - 1 :] = [(t, f"{last}, and {more} more")]
    return found


def unit_of(panel: Panel, result: Result, most: float) -> DisplayUnit:
    """Return the unit and scale of a panel.

    Its own unit, otherwise the first display unit of its columns, otherwise a prefix according to `most`, the
    largest absolute value.
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


def zoomed(scenario: Scenario, result: Result, trace: Columns) -> list[NDArray[np.bool_]]:
    """Rows of the zoomed part; None if its condition was never true."""
    condition = drawable.zoom(scenario, {name: result.items.get(name) for name in trace})
    if condition is None:
        return []
    moment = float(condition(InOrder(trace)))
    if not math.isfinite(moment):
        return []
    time = trace["time"]
    return [(time >= moment - scenario.plot.before) & (time <= moment + scenario.plot.after)]
