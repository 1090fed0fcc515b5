"""The section of one study in a report, as plain data."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from cosim import paths
from cosim.formatting.quantity import prefixed, text
from cosim.metrics import criteria
from cosim.report import charts, curves, drawing
from cosim.report.charts import ChartData
from cosim.report.curves import Line
from cosim.report.page import Section, paragraphs
from cosim.scenario.model import Chart
from cosim.show import marks
from cosim.sweep import influence, study, summary_tables
from cosim.sweep.check import check_charts
from cosim.sweep.command import Options, run_study
from cosim.sweep.plan import Plan
from cosim.sweep.runner import worst
from cosim.sweep.store import DONE, Store
from cosim.sweep.summary import QUANTILES, Summary, columns, quantiles, quantities, results

Table = dict[str, Any]
"""Names of the columns, and rows of texts."""


def check(file: Path) -> None:
    """Check before long runs that a study can be run and plotted."""
    check_charts(Plan(study.load(paths.find_study(str(file)))))


def run(file: Path, workers: int | None, engine: str, quiet: bool) -> Section:
    """Continue a study as `cosim sweep`, without plots and traces."""
    options = Options(file, None, workers, engine=engine, plots=False, quiet=quiet, traces=False)

    def describe(plan: Plan, store: Store, found: Summary) -> Section:
        known = columns(plan.scenario, plan.cases)
        drawn, undrawn = charts.of_columns(plan.study.charts, results(found, known), known, file.parent, {})
        runs, spread = worst(plan, found), [*distributions(plan, found)]
        return {
            "name": file.stem,
            "scenario": plan.scenario.name,
            "title": plan.study.title or plan.study.name,
            "description": paragraphs(plan.study.description),
            "command": f"cosim sweep {shlex.quote(paths.shown(file))}",
            "verdict": summary_tables.verdict(found).plain,
            "short": short(found),
            "passed": found.passed,
            "tables": [*tables(plan, found), *worst_runs(plan, found, runs)],
            "repeat": [plan.command(plan.runs[run]) for run in runs],
            "charts": [chart.packed() for chart in drawn],
            "distributions": [chart.packed() for chart in spread],
            "drawings": [drawing.charts(drawn), drawing.charts(spread)],
            "undrawn": undrawn,
        }

    return run_study(options, describe)


def short(found: Summary) -> str:
    """Return the number of passed runs, or of completed runs without criteria."""
    if found.passed is None:
        return f"{found.rows} runs"
    return f"{found.statuses['passed']} of {found.wanted} runs passed"


def tables(plan: Plan, found: Summary) -> Iterator[Table]:
    """Tables of criteria, distributions, sensitivity and runs without result; empty ones are omitted."""
    claims = {entry.id: entry.claim for entry in plan.scenario.criterion}
    held = [(name, f"{count} of {found.results}", claims.get(name, "")) for name, count in found.held.items()]
    spread = [
        (name, *(text(value, found.units[name]) for value in quantiles(values).values()))
        for name, values in quantities(found).items()
    ]
    moved = [[cell.plain for cell in row] for row in influence.rows(found.influences)]
    lost = [
        (status, str(count), str(first), reason)
        for (status, reason), (count, first) in found.troubles.items()
    ]
    every = (
        (("criterion", "passed in", "claim"), held),
        (("metric", *QUANTILES), spread),
        (("sensitivity of", *influence.ranked_keys(found.influences)[: influence.MAX_KEYS]), moved),
        (("without result", "runs", "first run", "reason"), lost),
    )
    yield from ({"names": names, "rows": rows} for names, rows in every if rows)


def worst_runs(plan: Plan, found: Summary, runs: list[int]) -> Iterator[Table]:
    """Worst runs by the metric that the study names."""
    name = plan.study.traces.metric
    if runs:
        values = dict(zip(found.columns["run"], found.columns[f"metric.{name}"], strict=True))
        rows = [(str(run), text(values[run], found.units.get(name, ""))) for run in runs]
        yield {"names": ("worst run", name), "rows": rows}


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
        limits = [
            (scale * position, marks.limit_text(entry, relation, limit, entry.unit or found.units[name]))
            for entry in plan.scenario.criterion
            if entry.metric == name
            for position, (relation, limit) in zip(
                criteria.drawn(entry, found.units[name]), criteria.relations(entry), strict=False
            )
        ]
        chart = Chart(
            "share",
            (name,),
            title=described[name] or name,
            x_label=name,
            x_unit="" if unit == "1" else unit,
            label="cumulative fraction of the runs",
        )
        yield ChartData(chart, lines, marks=marks.visible(limits, [line.x for line in lines]))
