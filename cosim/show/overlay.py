"""Plot of stored traces, which may be overlaid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.errors import CosimError, closest
from cosim.formatting.quantity import prefixed
from cosim.scenario.model import Panel
from cosim.show import figure as figures
from cosim.show import plot
from cosim.show.plot import Curve, PanelData
from cosim.trace.columns import Array, stepped
from cosim.trace.stored import StoredTrace
from cosim.units import UNCHANGED, conversion

MAX_PANELS = 24
BUCKETS = 2000
"""Number of time intervals; the minimum and maximum of each is drawn."""


def save(traces: Sequence[StoredTrace], patterns: Sequence[str], file: Path) -> None:
    """Plot columns of traces that match patterns into a file; by default all changing columns.

    One trace has a panel for each unit, several traces have one for each column.
    """
    panels = selected_panels(traces, patterns)
    with figures.styled((9.0, 1.2 + 1.7 * len(panels))) as figure:
        grid = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, panel in zip(grid, panels, strict=True):
            draw(axes, traces, panel)
        grid[-1].set_xlabel("time (s)")
        figure.suptitle(", ".join(paths.shown(trace.file) for trace in traces), fontsize=10)
        figures.save(figure, file)


def selected_panels(traces: Sequence[StoredTrace], patterns: Sequence[str]) -> Sequence[Panel]:
    """Panels of the columns that match a pattern."""
    known = list(dict.fromkeys(name for trace in traces for name in trace.columns))
    # brackets are part of names
    matches = {p: [name for name in known if fnmatchcase(name, p.replace("[", "[[]"))] for p in patterns}
    for pattern, found in matches.items():
        if not found:
            problem = f"`--column {pattern}` matches no column of the traces"
            raise CosimError(problem, closest(pattern, known))
    wanted = list(dict.fromkeys(name for found in matches.values() for name in found))
    if len(traces) == 1:
        (trace,) = traces
        data = {name: trace.data[name] for name in ("time", *(wanted or known))}
        panels = plot.default_panels(data, trace, every=bool(wanted))
    else:
        moving = [n for n in known if any(n in one.data and plot.moves(one.data[n]) for one in traces)]
        names = wanted or moving[: plot.MAX_PANELS] or known[:1]
        panels = tuple(Panel((name,), title=name) for name in names)
        if more := plot.and_more("column", 0 if wanted else len(moving) - len(names)):
            panels = *panels[:-1], replace(panels[-1], title=f"{names[-1]}, {more}")
    if not panels:
        raise CosimError(f"`{paths.shown(traces[0].file)}` has no column in addition to the time")
    if len(panels) > MAX_PANELS:
        problem = f"the patterns match {len(panels)} columns, more than {MAX_PANELS} panels"
        raise CosimError(problem, "Choose fewer columns with `--column`.")
    return panels


def draw(axes: Any, traces: Sequence[StoredTrace], panel: Panel) -> None:
    """Draw the columns of a panel, in one unit for all traces."""
    unit = next((one.units[n] for one in traces for n in panel.columns if one.units.get(n)), "")
    columns = [(trace, name) for trace in traces for name in panel.columns if name in trace.data]
    values = [converted(trace, name, unit) for trace, name in columns]
    shown, scale = prefixed(unit, plot.largest(values))
    curves = [
        Curve(name if len(traces) == 1 else paths.shown(trace.file), trace.times, scale * one, stepped(one))
        for (trace, name), one in zip(columns, values, strict=True)
    ]
    items = next((found for one in traces if (found := plot.items_of(panel, one))), {})
    plot.draw(axes, PanelData("", "", curves, items=items), buckets=BUCKETS)
    axes.set_title(panel.title, fontsize=9, loc="left")
    axes.set_ylabel("" if shown == "1" else shown)
    axes.legend(**plot.BESIDE)


def converted(trace: StoredTrace, name: str, unit: str) -> Array:
    """Values of a column in a unit; those without a unit are in it."""
    own = trace.units.get(name, "")
    change: Any = conversion(own, unit) if own and own != unit else UNCHANGED
    if change is None:
        problem = f"`{name}` is in `{own}` in `{paths.shown(trace.file)}` and in `{unit}` in another trace"
        raise CosimError(problem, "Plot the traces separately.")
    values: Array = change(trace.data[name])
    return values
