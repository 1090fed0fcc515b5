"""The plot of a run in the report: the whole run, and the zoomed part."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosim.loop.result import Result
from cosim.report import series
from cosim.report.series import scaled
from cosim.scenario.model import Panel, Scenario
from cosim.show import marks, plot
from cosim.show.marks import Marked
from cosim.trace.columns import Array, Columns, stepped
from cosim.trace.thinned import thinned


def views(scenario: Scenario, result: Result) -> list[dict[str, Any]]:
    """Make the views of a run, each with its panels, as plain data."""
    trace = result.columns
    panels = scenario.plot.panels or plot.default_panels(trace, result)
    if not panels:
        return []
    marked = marks.marked(scenario, result)
    rows = np.ones(len(trace["time"]), dtype=bool)
    found = [view("the whole run", panels, trace, rows, result, marked)]
    for window in plot.zoomed(scenario, result, trace):
        if np.count_nonzero(window) > 1:
            found.append(view(f"around {scenario.plot.zoom}", panels, trace, window, result, marked))
    return found


def view(
    title: str,
    panels: tuple[Panel, ...],
    trace: Columns,
    window: Any,
    result: Result,
    marked: Marked,
) -> dict[str, Any]:
    """One view: the panels in a part of the time."""
    times = trace["time"][window]
    span = float(times[0]), float(times[-1])
    inside = plot.inside(times, marked)
    drawn = [one(panel, trace, window, marked, result) for panel in panels]
    return {"title": title, "from": span[0], "to": span[1], "events": inside, "panels": drawn}


def one(panel: Panel, trace: Columns, window: Any, marked: Marked, result: Result) -> dict[str, Any]:
    """One panel: its lines as numbers."""
    shown = plot.unit_of(panel, result, plot.largest(trace[name][window] for name in panel.columns))
    items = plot.items_of(panel, result)
    lines: list[Array] = [shown.factor * trace[name][window] + shown.offset for name in panel.columns]
    # without a positive value there is nothing to show on a logarithmic axis
    log = panel.log and any(bool(np.any(line > 0.0)) for line in lines)
    limits = [each for each in marks.near(panel, marked, shown, lines) if not log or each[0] > 0.0]
    return {
        "title": panel.title,
        "unit": "" if shown.name == "1" else shown.name,
        "log": log,
        "items": items,
        "limits": limits,
        "lines": [
            {
                "name": name,
                "stepped": stepped(trace[name][window]),
                **series.packed(scaled(thinned(line), log)),
            }
            for name, line in zip(panel.columns, lines, strict=True)
        ],
    }
