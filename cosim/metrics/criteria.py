"""Metrics and criteria: what is measured on a trace, and whether it is good enough."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosim.errors import ExpressionError, concerning
from cosim.metrics.expression import Columns, Expression, Items
from cosim.scenario.model import Criterion, Metric


@dataclass(frozen=True)
class Measured:
    """Value of a metric with its unit."""

    name: str
    value: float
    unit: str
    description: str = ""


@dataclass(frozen=True)
class Verdict:
    """A criterion, the value it was held against, and the outcome."""

    criterion: Criterion
    value: float
    unit: str

    @property
    def passed(self) -> bool:
        """Whether the value keeps every limit; NaN and inf, such as the time of no event, keep none."""
        criterion, value = self.criterion, self.value
        if not math.isfinite(value):
            return False
        return (
            (criterion.minimum is None or value >= criterion.minimum)
            and (criterion.maximum is None or value <= criterion.maximum)
            and (criterion.equals is None or value == float(criterion.equals))
        )

    @property
    def logical(self) -> bool:
        """Whether the value is a yes or no that was asked for as such."""
        return isinstance(self.criterion.equals, bool) and self.value in (0.0, 1.0)

    @property
    def limits(self) -> list[tuple[str, float]]:
        """Relations and limits, for example `[("<=", 4.5e-07)]`."""
        criterion = self.criterion
        relations = ((">=", criterion.minimum), ("<=", criterion.maximum), ("=", criterion.equals))
        return [(relation, float(limit)) for relation, limit in relations if limit is not None]


def compile_metrics(
    metrics: tuple[Metric, ...], columns: Mapping[str, Items | None], units: Mapping[str, str] | None = None
) -> list[Expression]:
    """Compile the expressions of metrics, so that a mistake is found before the run."""
    compiled = []
    for metric in metrics:
        with concerning(f"metric.{metric.name}.value"):
            where = f"`metric.{metric.name}.value`"
            compiled.append(Expression(metric.value, columns, where, units=units))
    return compiled


def measure(metric: Metric, expression: Expression, columns: Columns) -> Measured:
    """Value of one metric.

    Raises
    ------
    ExpressionError
        The expression gives a column instead of one number.
    """
    value: Any = np.asarray(expression(columns), dtype=np.float64)
    if value.ndim:
        raise ExpressionError(
            f"`metric.{metric.name}.value` = `{metric.value}` gives {value.size} values, not one",
            "reduce them, for example with `max(...)`, `last(...)` or `rms(...)`",
        )
    unit = metric.unit or expression.unit or "1"
    return Measured(metric.name, float(value), unit, metric.description)


def judge(criteria: tuple[Criterion, ...], measured: Mapping[str, Measured]) -> list[Verdict]:
    """Hold every criterion against its metric; the unit is the metric's unless the criterion names one."""
    return [
        Verdict(
            criterion, measured[criterion.metric].value, criterion.unit or measured[criterion.metric].unit
        )
        for criterion in criteria
    ]
