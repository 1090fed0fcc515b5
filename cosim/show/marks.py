"""What is marked in the plots of a run: events, and the limits that its criteria set on columns."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cosim.fmu.archive import DisplayUnit
from cosim.loop.result import Result
from cosim.scenario.model import Panel, Scenario
from cosim.trace.columns import Array
from cosim.words.quantity import text

SHOWN_AS_THEY_ARE = ("max", "min", "first", "last", "at")
"""Functions whose value is one of the column."""
MOST_EVENTS = 6
FAR = 2.0
"""Spans of the lines of a panel beyond which a limit is not drawn."""


@dataclass(frozen=True)
class Marked:
    """Events with their times (s), and limits on columns by their names."""

    events: list[tuple[float, str]]
    limits: dict[str, list[tuple[float, str]]]


def marked(scenario: Scenario, result: Result) -> Marked:
    """Collect what is marked in the plots of a run."""
    return Marked(events(result), limits(scenario, result))


def events(result: Result) -> list[tuple[float, str]]:
    """Tell what happened when: injected faults, and what an FMU told; the last one tells how many follow."""
    found = [(t, "fault injected") for t in result.injected if t is not None]
    times = result.columns["time"]
    for name, items in result.items.items():
        if name.endswith(".fault") and name in result.columns:
            told = result.columns[name]
            names = {number: item for item, number in items.items()}
            for row in np.flatnonzero(np.diff(told) != 0.0) + 1:
                if (item := names.get(int(told[row]), "")) not in ("", "None"):
                    found.append((float(times[row]), item))
    found.sort()
    if (more := len(found) - MOST_EVENTS) > 0:
        t, last = found[MOST_EVENTS - 1]
        found[MOST_EVENTS - 1 :] = [(t, f"{last}, and {more} more")]
    return found


def limits(scenario: Scenario, result: Result) -> dict[str, list[tuple[float, str]]]:
    """Limits on a column in its own unit, each with what it says, by the name of the column.

    A criterion limits a column if its metric is a single value of it, such as its largest in some rows, or of
    its absolute value; then it is a limit on both sides.
    """
    values = {metric.name: metric.value for metric in scenario.metric}
    found: dict[str, list[tuple[float, str]]] = {}
    for verdict in result.criteria:
        criterion = verdict.criterion
        column, both = limited(values.get(criterion.metric, ""), result.units)
        measured = result.metrics.get(criterion.metric)
        if not column or measured is None or not (measured.value and verdict.value):
            continue
        # the criterion may be in another unit
        scale = measured.value / verdict.value
        for relation, limit in verdict.limits:
            if isinstance(criterion.equals, bool):
                continue
            told = f"{criterion.id} {relation} {text(limit, verdict.unit, 3)}"
            found.setdefault(column, []).append((scale * limit, told))
            if both:
                found[column].append((-scale * limit, ""))
    return found


def limited(value: str, columns: Mapping[str, str]) -> tuple[str, bool]:
    """Column of which a metric is a single value, and whether of its absolute value; no column for others."""
    try:
        tree = ast.parse(value.strip(), mode="eval").body
    except SyntaxError:
        return "", False
    if not isinstance(tree, ast.Call) or getattr(tree.func, "id", "") not in SHOWN_AS_THEY_ARE:
        return "", False
    both = False
    inner = tree.args[0] if tree.args else tree
    while ast.unparse(inner) not in columns:
        if isinstance(inner, ast.Subscript):
            inner = inner.value
        elif isinstance(inner, ast.Call) and getattr(inner.func, "id", "") == "abs" and inner.args:
            inner, both = inner.args[0], True
        else:
            return "", False
    return ast.unparse(inner), both


def near(panel: Panel, marked: Marked, shown: DisplayUnit, lines: Sequence[Array]) -> list[tuple[float, str]]:
    """Limits on the columns of a panel, as it shows them; one that would make its lines flat is left out."""
    found = [
        (shown.factor * limit + shown.offset, told)
        for name in panel.columns
        for limit, told in marked.limits.get(name, ())
    ]
    finite = np.concatenate([line[np.isfinite(line)] for line in lines])
    if not finite.size:
        return []
    low, high = float(finite.min()), float(finite.max())
    room = FAR * ((high - low) or abs(high))
    return [(limit, told) for limit, told in found if low - room <= limit <= high + room]
