"""Metrics and criteria: quantities computed from a trace, and their limits."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter
from typing import Any, Protocol

import numpy as np

from cosim.errors import ExpressionError, concerning
from cosim.metrics.expression import Columns, Expression, Items, Node, normal
from cosim.scenario.model import Criterion, Metric
from cosim.units import ONE, PLAIN, UNCHANGED, Conversion, Unit, conversion, definitions_of


class Trace(Columns, Protocol):
    """Columns of a trace with a cache of computed metrics."""

    def kept(self, name: str, expression: Expression) -> Any:
        """Value of a metric by its full name, which is computed once."""


RELATIONS = {">=": operator.ge, "<=": operator.le, "=": operator.eq}


@dataclass(frozen=True)
class Measured:
    """Value of a metric with its unit."""

    name: str
    value: float
    unit: str
    description: str = ""


@dataclass(frozen=True)
class Verdict:
    """A criterion with the value and the outcome."""

    criterion: Criterion
    value: float
    unit: str

    @property
    def passed(self) -> bool:
        """Whether the value meets every limit; NaN and inf, such as the time of no event, do not."""
        held = all(RELATIONS[relation](self.value, limit) for relation, limit in self.limits)
        return math.isfinite(self.value) and held

    @property
    def logical(self) -> bool:
        """Whether the criterion is a claim that is true or false."""
        return isinstance(self.criterion.equals, bool) and self.value in (0.0, 1.0)

    @property
    def limits(self) -> list[tuple[str, float]]:
        """Relations and limits, for example `[("<=", 4.5e-07)]`."""
        return relations(self.criterion)


def relations(criterion: Criterion) -> list[tuple[str, float]]:
    """Relations and limits of a criterion, in its unit."""
    limits = zip(RELATIONS, (criterion.minimum, criterion.maximum, criterion.equals), strict=True)
    return [(relation, float(limit)) for relation, limit in limits if limit is not None]


def drawn(criterion: Criterion, unit: str) -> list[float]:
    """Limits of a criterion in the unit of its metric, in the order of `relations`; none for a Boolean."""
    if isinstance(criterion.equals, bool):
        return []
    return [converted(criterion, unit).back(limit) for _, limit in relations(criterion)]


def compile_metrics(
    metrics: tuple[Metric, ...], columns: Mapping[str, Items | None], units: Mapping[str, str] | None = None
) -> list[Expression]:
    """Compile the expressions of metrics, so that errors are found before the run."""
    named = {f"metric.{metric.name}": metric for metric in metrics}
    made_of = {
        name: [other for other in named if other != name and mentions(metric.value, other)]
        for name, metric in named.items()
    }
    compiled: dict[str, Expression] = {}
    nodes: dict[str, Node] = {}
    try:
        order = list(TopologicalSorter(made_of).static_order())
    except CycleError as error:
        circle = " <- ".join(f"`{name}`" for name in error.args[1])
        raise ExpressionError(f"metrics depend on each other in a circle: {circle}") from None
    for name in order:
        metric = named[name]
        with concerning(f"{name}.value"):
            made = Expression(metric.value, columns, f"`{name}.value`", units=units, known=nodes)
        check_unit(metric, made)
        kept = operator.methodcaller("kept", name, made)
        if normal(name) in nodes:
            problem = "differ only in characters that Python does not distinguish"
            raise ExpressionError(f"two metrics `{normal(name)}` {problem}", "Rename one of them.")
        compiled[name] = made
        nodes[normal(name)] = replace(made.root, evaluate=kept, unit=unit_of(metric, made) or made.unit)
    return [compiled[name] for name in named]


def check_unit(metric: Metric, made: Expression) -> None:
    """Check that the unit of a metric does not contradict the unit of its expression.

    After a multiplication or division by a number the unit is unknown, because it may be a conversion.
    """
    found = conversion(made.unit or ONE, metric.unit)
    if not made.unit or made.converts or found is None or not found.changes:
        return
    key = f"metric.{metric.name}"
    with concerning(f"{key}.unit"):
        problem = f"`{key}.unit` is `{metric.unit}`, `{key}.value` = `{metric.value}` is in `{made.unit}`"
        hint = f'Set `unit = "{metric.unit}"` in the criterion, which is converted; omit it in the metric.'
        raise ExpressionError(problem, hint)


def mentions(text: str, name: str) -> bool:
    """Whether an expression contains a whole dotted name."""
    return re.search(rf"(?<![\w.]){re.escape(normal(name))}(?!\w)", normal(text)) is not None


def measure(metric: Metric, expression: Expression, columns: Trace) -> Measured:
    """Value of one metric; an error if its expression gives a column."""
    value = np.asarray(columns.kept(f"metric.{metric.name}", expression), dtype=np.float64)
    if value.ndim:
        problem = f"`metric.{metric.name}.value` = `{metric.value}` gives {value.size} values, not one"
        raise ExpressionError(problem, "Reduce them, for example with `max(...)`, `last(...)` or `rms(...)`.")
    return Measured(metric.name, float(value), unit_of(metric, expression), metric.description)


def check_units(
    criteria: tuple[Criterion, ...], metrics: tuple[Metric, ...], expressions: list[Expression]
) -> None:
    """Check before the run that every metric converts to the unit of its criteria."""
    pairs = zip(metrics, expressions, strict=True)
    units = {metric.name: unit_of(metric, expression) for metric, expression in pairs}
    for criterion in criteria:
        with concerning(f"criterion.{criterion.id}.unit"):
            converted(criterion, units[criterion.metric])


def unit_of(metric: Metric, expression: Expression) -> str:
    """Return the unit of a metric: its own, or that of its expression; empty if unknown."""
    known = expression.unit or PLAIN
    return Unit(metric.unit, definitions_of(known)) if metric.unit else known


def converted(criterion: Criterion, unit: str) -> Conversion:
    """Conversion from `unit` of a metric to the unit of a criterion.

    A metric with unknown unit is used in the unit of the criterion, except for percent: such a number may be
    a fraction as well.
    """
    requested = criterion.unit or unit
    found = conversion(unit or ONE, requested)
    problem = f"`criterion.{criterion.id}.unit` is `{requested}`, `metric.{criterion.metric}`"
    if not unit:
        if found is None or not found.changes:
            return UNCHANGED
        hint = f'Set `unit = "{ONE}"` in the metric if it is a fraction, otherwise `unit = "{requested}"`.'
        raise ExpressionError(f"{problem} has no unit; it is ambiguous", hint)
    if found is None:
        hint = f"Give the limits in `{unit}` without `unit`, or compute the metric in `{requested}`."
        raise ExpressionError(f"{problem} is in `{unit}`, which does not convert to it", hint)
    return found


def evaluate(criteria: tuple[Criterion, ...], measured: Mapping[str, Measured]) -> list[Verdict]:
    """Evaluate every criterion with its metric, in the unit of the criterion if it has one."""
    pairs = [(criterion, measured[criterion.metric]) for criterion in criteria]
    return [
        Verdict(criterion, converted(criterion, metric.unit)(metric.value), criterion.unit or metric.unit)
        for criterion, metric in pairs
    ]
