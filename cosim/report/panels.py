"""The plot of a run as a page shows it: whole, and around the moment that the scenario zooms on."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosim.loop.result import Result
from cosim.report import drawing, series
from cosim.scenario.model import Panel, Scenario
from cosim.show import plot
from cosim.trace.columns import Array, Columns


def views(scenario: Scenario, result: Result) -> list[dict[str, Any]]:
    """Make the views of a run, each with its panels, as plain data."""
    trace = result.columns
    panels = scenario.plot.panels or plot.default_panels(trace, result)
    marks = [(t, "fault injected") for t in result.injected if t is not None]
    rows = np.ones(len(trace["time"]), dtype=bool)
    found = [view("the whole run", panels, trace, rows, result, marks)]
    for window in plot.zoomed(scenario, result, trace):
        if np.count_nonzero(window) > 1:
            found.append(view(f"around {scenario.plot.zoom}", panels, trace, window, result, marks))
    return found


def view(
    title: str,
    panels: tuple[Panel, ...],
    trace: Columns,
    window: Any,
    result: Result,
    marks: list[tuple[float, str]],
) -> dict[str, Any]:
    """One view: the panels in a part of the time."""
    times = trace["time"][window]
    span = float(times[0]), float(times[-1])
    inside = [(t, name) for t, name in marks if span[0] <= t <= span[1]]
    drawn = [one(panel, trace, window, span, inside, result) for panel in panels]
    return {"title": title, "from": span[0], "to": span[1], "events": inside, "panels": drawn}


def one(
    panel: Panel,
    trace: Columns,
    window: Any,
    span: tuple[float, float],
    marks: list[tuple[float, str]],
    result: Result,
) -> dict[str, Any]:
    """One panel: its lines as numbers and as a drawing."""
    shown = plot.unit_of(panel, result)
    items = plot.items_of(panel, result)
    lines: list[Array] = [shown.factor * trace[name][window] + shown.offset for name in panel.columns]
    # without a positive value there is nothing to show on a logarithmic axis
    log = panel.log and any(bool(np.any(line > 0.0)) for line in lines)
    return {
        "title": panel.title,
        "unit": "" if shown.name == "1" else shown.name,
        "log": log,
        "items": items,
        "lines": [
            {
                "name": name,
                "stepped": bool(np.all(line == np.round(line))),
                **series.packed(scaled(series.thinned(line), log)),
            }
            for name, line in zip(panel.columns, lines, strict=True)
        ],
        "svg": drawing.panel([scaled(line, log) for line in lines], span, log, items, [t for t, _ in marks]),
    }


def scaled(values: Array, log: bool) -> Array:
    """Values as the axis takes them: the logarithm of what is above 0 on a logarithmic one."""
    return np.log10(np.where(values > 0.0, values, np.nan)) if log else values
