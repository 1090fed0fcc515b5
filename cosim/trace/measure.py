"""Computation of the metrics of a trace."""

from __future__ import annotations

from collections.abc import Sequence

from cosim.metrics import criteria
from cosim.metrics.criteria import Measured
from cosim.metrics.expression import Expression
from cosim.scenario.model import Metric
from cosim.trace.columns import Columns, InOrder


def measured(
    metrics: Sequence[Metric], expressions: Sequence[Expression], columns: Columns
) -> dict[str, Measured]:
    """Values of metrics by name, each computed once; an `ExpressionError` if one is not a number.

    Of columns in a file, only those of one metric and its dependencies are in memory at the same time.
    """
    table = InOrder(columns)
    pairs = zip(metrics, expressions, strict=True)
    return {metric.name: criteria.measure(metric, found, table) for metric, found in pairs}
