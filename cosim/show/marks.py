"""Marks in the plots of a run: events, and limits of criteria on columns."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cosim.errors import ExpressionError
from cosim.fmu.archive import DisplayUnit
from cosim.formatting.quantity import text
from cosim.loop.result import Result
from cosim.metrics import criteria
from cosim.metrics.expression import Expression
from cosim.metrics.units import conversion
from cosim.scenario.model import Criterion, Panel, Scenario
from cosim.trace.columns import Array

SHOWN_AS_THEY_ARE = ("max", "min", "first", "last", "at")
"""Functions whose value is a value of the column."""
FAR = 2.0
"""Distance of a limit from the lines, in line spans, above which it is not plotted."""


@dataclass(frozen=True)
class Marked:
    """Events with their times (s), and limits on columns by their names."""

    events: list[tuple[float, str]]
    limits: dict[str, list[tuple[float, str]]]


def marked(scenario: Scenario, result: Result) -> Marked:
    """Collect the marks in the plots of a run."""
    return Marked(events(scenario, result), limits(scenario, result))


def events(scenario: Scenario, result: Result) -> list[tuple[float, str]]:
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


def limits(scenario: Scenario, result: Result) -> dict[str, list[tuple[float, str]]]:
    """Limits on a column in its own unit with their texts, by the name of the column.

    A criterion limits a column if it names the column, or if its metric is a single value of the column or of
    its absolute value times a number. An absolute value is limited on both sides.
    """
    values = {metric.name: metric.value for metric in scenario.metric}
    found: dict[str, list[tuple[float, str]]] = {}
    for verdict in result.criteria:
        criterion = verdict.criterion
        measured = result.metrics.get(criterion.metric)
        if measured is None:
            continue
        factors = {
            name: conversion(result.units.get(name, ""), measured.unit) or 1.0 for name in criterion.columns
        }
        column, factor, both = limited(values.get(criterion.metric, ""), result.units)
        if column:
            factors[column] = factor
        drawn = criteria.drawn(criterion, measured.unit)
        for place, (relation, limit) in zip(drawn, verdict.limits, strict=False):
            words = limit_text(criterion, relation, limit, verdict.unit)
            for name, factor in factors.items():
                found.setdefault(name, []).append((place / factor, words))
                if both:
                    found[name].append((-place / factor, ""))
    return found


def limit_text(criterion: Criterion, relation: str, limit: float, unit: str) -> str:
    """Text of a limit."""
    return f"{criterion.id} {relation} {text(limit, unit, 3)}"


def limited(value: str, columns: Mapping[str, str]) -> tuple[str, float, bool]:
    """Column, factor, and absolute-value flag of a metric that is a single value of a column.

    None for any other metric.
    """
    try:
        tree, factor = without_factor(ast.parse(value.strip(), mode="eval").body)
    except SyntaxError:
        return "", 1.0, False
    if not isinstance(tree, ast.Call) or getattr(tree.func, "id", "") not in SHOWN_AS_THEY_ARE:
        return "", factor, False
    both = False
    inner = tree.args[0] if tree.args else tree
    while ast.unparse(inner) not in columns:
        if isinstance(inner, ast.Subscript):
            inner = inner.value
        elif isinstance(inner, ast.Call) and getattr(inner.func, "id", "") == "abs" and inner.args:
            inner, both = inner.args[0], True
        else:
            return "", factor, both
    return ast.unparse(inner), factor, both


def without_factor(tree: ast.expr) -> tuple[ast.expr, float]:
    """Split an expression into its varying part and its constant factor."""
    factor = 1.0
    while isinstance(tree, ast.BinOp) and isinstance(tree.op, ast.Mult | ast.Div):
        left, right = number(tree.left), number(tree.right)
        if right:
            factor = factor * right if isinstance(tree.op, ast.Mult) else factor / right
            tree = tree.left
        elif left and isinstance(tree.op, ast.Mult):
            factor *= left
            tree = tree.right
        else:
            break
    return tree, factor


def number(tree: ast.expr) -> float:
    """Value of an expression without columns, such as `180 / pi`; 0 for others."""
    try:
        return float(Expression(ast.unparse(tree), {}, "")(()))
    except ExpressionError:
        return 0.0


def near(panel: Panel, marked: Marked, shown: DisplayUnit, lines: Sequence[Array]) -> list[tuple[float, str]]:
    """Limits on the columns of a panel in its unit, except those that would make its lines flat."""
    found = {
        (shown.factor * limit + shown.offset, label): None
        for name in panel.columns
        for limit, label in marked.limits.get(name, ())
    }
    return seen([*found], lines)


def seen(found: Sequence[tuple[float, str]], lines: Sequence[Array]) -> list[tuple[float, str]]:
    """Limits that would not make lines flat."""
    finite = np.concatenate([line[np.isfinite(line)] for line in lines])
    if not finite.size:
        return []
    low, high = float(finite.min()), float(finite.max())
    room = FAR * ((high - low) or abs(high))
    return [(limit, label) for limit, label in found if low - room <= limit <= high + room]
