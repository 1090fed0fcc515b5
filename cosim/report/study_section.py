"""The section of one study in a report, as plain data."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from cosim import paths
from cosim.formatting.quantity import prefixed
from cosim.metrics import criteria
from cosim.report import charts, curves, drawing
from cosim.report.charts import ChartData
from cosim.report.curves import Line
from cosim.report.page import Section, paragraphs
from cosim.scenario.model import Chart
from cosim.show import marks
from cosim.study.store import DONE, Store
from cosim.sweep import sensitivity_tables, study, summary_tables
from cosim.sweep.charts import check_charts, columns, results
from cosim.sweep.command import Options, run_study
from cosim.sweep.plan import Plan
from cosim.sweep.runner import worst
from cosim.sweep.summary import Summary, spread


def check(file: Path) -> None:
    """Check before long runs that a study can be run and plotted."""
    check_charts(Plan(study.load(paths.find_study(str(file)))))


def run(file: Path, workers: int | None, engine: str, quiet: bool) -> Section:
    """Continue a study as `cosim sweep`, without plots and traces."""
    options = Options(file, None, workers, engine=engine, plots=False, quiet=quiet, traces=False)

    def describe(plan: Plan, store: Store, found: Summary) -> Section:
        known = columns(plan.scenario, plan.varying)
        drawn, undrawn = charts.of_columns(plan.study.charts, results(found, known), known, file.parent, {})
        runs, shares = worst(plan, found), [*distributions(plan, found)]
        return {
            "name": file.stem,
            "scenario": plan.scenario.name,
            "title": plan.study.full_title,
            "description": paragraphs(plan.study.description),
            "command": f"cosim sweep {shlex.quote(paths.shown(file))}",
            "verdict": summary_tables.verdict(found).plain,
            # without criteria there are only completed runs
            "short": f"{found.rows} runs"
            if found.passed is None
            else f"{found.statuses['passed']} of {found.runs} runs passed",
            "passed": found.passed,
            "tables": [plain(table) for table in tables(plan, found, runs)],
            "repeat": plan.commands(runs),
            "charts": [chart.packed() for chart in drawn],
            "distributions": [chart.packed() for chart in shares],
            "drawings": [drawing.charts(drawn), drawing.charts(shares)],
            "undrawn": undrawn,
        }

    return run_study(options, describe)


def tables(plan: Plan, found: Summary, worst: list[int]) -> Iterator[Table]:
    """Nonempty tables of criteria, metrics, sensitivity, runs without result and worst runs."""
    if plan.scenario.criterion and found.results:
        yield summary_tables.criteria_table(plan.scenario, found)
    if spread(found):
        yield summary_tables.metric_table(found)
    if found.sensitivities:
        yield sensitivity_tables.table(found.sensitivities)
    if found.troubles:
        yield summary_tables.no_result_table(found, "first run")
    if worst:
        yield summary_tables.worst_table(plan, found, worst)


def plain(table: Table) -> dict[str, Any]:
    """Names of the columns, and rows of texts."""
    columns = [map(str, column.cells) for column in table.columns]
    return {"names": [str(column.header) for column in table.columns], "rows": [*zip(*columns, strict=True)]}


def distributions(plan: Plan, found: Summary) -> Iterator[ChartData]:
    """Distribution of the metrics with criteria, separately for passed and failed runs."""
    done = np.isin(found.columns["status"], DONE)
    failed = (np.array(found.columns["status"]) == "failed")[done]
    described = {metric.name: metric.description for metric in plan.scenario.metric}
    for name in summary_tables.plotted_metrics(plan.scenario, found):
        values = np.array(found.columns[f"metric.{name}"], dtype=np.float64)[done]
        known = np.isfinite(values)
        unit, scale = prefixed(found.units[name], float(np.max(np.abs(values[known]))))
        parts = {"all criteria passed": ~failed, "a criterion failed": failed}
        lines = [
            Line(f"{label} ({np.count_nonzero(part)})", scale * x, share)
            for label, part in parts.items()
            for x, share in curves.cumulative(values[part])
        ]
        limits = []
        for entry in (one for one in plan.scenario.criterion if one.metric == name):
            own = entry.unit or found.units[name]
            drawn = criteria.drawn(entry, found.units[name])
            for position, (relation, limit) in zip(drawn, criteria.relations(entry), strict=False):
                limits.append((scale * position, marks.limit_text(entry, relation, limit, own)))
        shown = "" if unit == "1" else unit
        texts: Any = {"x_label": name, "x_unit": shown, "label": "cumulative fraction of the runs"}
        chart = Chart("share", (name,), title=described[name] or name, **texts)
        yield ChartData(chart, lines, marks=marks.visible(limits, [line.x for line in lines]))
