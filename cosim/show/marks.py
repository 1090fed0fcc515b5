"""Marks in the plots of a run: events, and limits of criteria on columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from cosim.fmu.description import DisplayUnit
from cosim.formatting.quantity import text
from cosim.loop.result import Result
from cosim.metrics import criteria
from cosim.scenario.model import Criterion, Panel, Scenario
from cosim.trace.columns import Array
from cosim.units import UNCHANGED, Conversion, conversion

FAR = 2.0
"""Distance of a limit from the lines, in line spans, above which it is not plotted."""
Named = Sequence[tuple[float, str]]
"""Limits or times of events (s) with their texts."""


def events(scenario: Scenario, result: Result) -> Named:
    """Return times and texts of events: injected faults with their targets, and faults reported by an FMU."""
    began = zip(scenario.inject, result.injected, strict=False)
    found = [(t, f"fault injected: {entry.to}") for entry, t in began if t is not None]
    times = result.columns["time"]
    for name, items in result.items.items():
        if name.endswith(".fault") and name in result.columns:
            column = result.columns[name]
            names = {number: item for item, number in items.items()}
            for row in np.flatnonzero(np.diff(column, prepend=np.nan) != 0.0):
                if (item := names.get(int(column[row]), "")) not in ("", "None"):
                    found.append((float(times[row]), item))
    return sorted(found)


def limits(scenario: Scenario, result: Result) -> Mapping[str, Named]:
    """Limits on a column in its own unit with their texts, by the name of the column.

    A criterion limits a column if it names the column, or if its metric is a single value of the column or of
    its absolute value times a number. An absolute value is limited on both sides.
    """
    columns = {name: result.items.get(name) for name in result.columns}
    compiled = criteria.compile_metrics(scenario.metric, columns, result.units)
    roots = {metric.name: made.root for metric, made in zip(scenario.metric, compiled, strict=True)}
    found: dict[str, list[tuple[float, str]]] = {}
    for verdict in result.criteria:
        criterion = verdict.criterion
        measured, root = result.metrics.get(criterion.metric), roots.get(criterion.metric)
        if measured is None or root is None:
            continue
        changes = {
            name: conversion(result.units.get(name, ""), measured.unit) or UNCHANGED
            for name in criterion.columns
        }
        if root.column:
            changes[root.column] = Conversion(root.factor)
        drawn = criteria.drawn(criterion, measured.unit)
        for position, (relation, limit) in zip(drawn, verdict.limits, strict=False):
            words = limit_text(criterion, relation, limit, verdict.unit)
            for name, change in changes.items():
                found.setdefault(name, []).append((change.back(position), words))
                if root.absolute:
                    found[name].append((change.back(-position), ""))
    return found


def limit_text(criterion: Criterion, relation: str, limit: float, unit: str) -> str:
    """Text of a limit."""
    return f"{criterion.id} {relation} {text(limit, unit, 3)}"


def panel_limits(
    panel: Panel, limits: Mapping[str, Named], unit: DisplayUnit, lines: Sequence[Array]
) -> Named:
    """Limits on the columns of a panel in its unit, except those that would make its lines flat."""
    found = [
        (unit.factor * limit + unit.offset, label)
        for name in panel.columns
        for limit, label in limits.get(name, ())
    ]
    return visible(found, lines)


def visible(found: Named, lines: Sequence[Array]) -> Named:
    """Different limits that would not make lines flat."""
    finite = np.concatenate([line[np.isfinite(line)] for line in lines])
    if not finite.size:
        return []
    low, high = float(finite.min()), float(finite.max())
    room = FAR * ((high - low) or abs(high))
    return [each for each in dict.fromkeys(found) if low - room <= each[0] <= high + room]
