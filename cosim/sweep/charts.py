"""Charts over the runs of a study: their columns, and the check before the first run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from cosim import paths
from cosim.errors import CosimError, ScenarioError
from cosim.metrics import drawable
from cosim.metrics.expression import Items
from cosim.scenario.model import Scenario
from cosim.show.display import shorten
from cosim.study.store import DONE
from cosim.sweep.plan import Plan
from cosim.sweep.summary import Summary
from cosim.trace.columns import Columns

TIME = "time"
"""First column of the table for expressions; in a sweep the simulated time of each run, s."""
OF_A_TRACE = ("bode", "field", "spectrum")
"""Kinds of charts that need the rows of one run."""


def check_charts(plan: Plan) -> None:
    """Check that the charts of a study can be made from its results, without the rows of one run."""
    origin, charts = f"`{paths.shown(plan.study.file)}`", plan.study.charts
    for index, chart in enumerate(charts):
        if chart.kind in OF_A_TRACE:
            problem = f"{origin}: `charts[{index}]` of the kind `{chart.kind}` needs the rows of one run"
            raise ScenarioError(problem, "Move it to `[[plot.charts]]` of the scenario.")
    try:
        drawable.check_charts(charts, "charts", columns(plan.scenario, plan.varying))
    except CosimError as error:
        raise ScenarioError(f"{origin}: {error.message}", error.hint) from None


def columns(scenario: Scenario, varying: Mapping[str, list[Any]]) -> dict[str, Items | None]:
    """Columns for the charts of a study, with the items of text columns."""
    metrics = (f"metric.{metric.name}" for metric in scenario.metric)
    return {TIME: None, **{key: items(values) for key, values in varying.items()}, **dict.fromkeys(metrics)}


def items(values: list[Any]) -> Items | None:
    """Numbers of texts in their order; None if all are numbers."""
    if all(isinstance(value, int | float) for value in values):
        return None
    return {name: number for number, name in enumerate(dict.fromkeys(map(shorten, values)))}


def results(found: Summary, known: Mapping[str, Items | None]) -> Columns:
    """Columns of the runs with a result, each of shape (runs,); NaN for missing values."""
    done = np.isin(found.columns["status"], DONE)
    table = {**found.columns, TIME: found.columns["simulated_s"]}
    return {
        name: np.array(numbers(table[name], texts), dtype=np.float64)[done] for name, texts in known.items()
    }


def numbers(values: list[Any], known: Items | None) -> list[Any]:
    """Values of a column as numbers, of texts those of their items; None for missing values."""
    if known is None:
        return values
    return [None if value is None else known[shorten(value)] for value in values]
