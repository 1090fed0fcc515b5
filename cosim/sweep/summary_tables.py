"""Final output of `cosim sweep`: tables for the terminal and plots."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from cosim.formatting.quantity import number, text
from cosim.formatting.verdicts import NOTHING_DEMANDED
from cosim.metrics import criteria
from cosim.metrics.expression import Items
from cosim.scenario.model import Scenario
from cosim.show import figure as figures
from cosim.show.display import STYLES, shorten
from cosim.show.listing import plain_table
from cosim.show.plot import and_more
from cosim.study.store import DONE
from cosim.sweep import sensitivity_tables
from cosim.sweep.charts import numbers
from cosim.sweep.plan import Plan
from cosim.sweep.runner import worst
from cosim.sweep.summary import QUANTILES, Summary, finite, is_logical, quantities, spread

MAX_TROUBLES = 8
MAX_METRICS = 6
MAX_KEYS = 4


def of_study(plan: Plan, found: Summary) -> RenderableType:
    """Tables of a study, with its worst runs and commands to repeat them, never wrapped."""
    more: list[RenderableType] = []
    if runs := worst(plan, found):
        commands = Text("\n".join(plan.commands(runs)), no_wrap=True, overflow="ignore")
        more = [Group(worst_table(plan, found, runs), "", Text("repeat them with", style="bold"), commands)]
    return tables(plan.study.full_title, plan.scenario, found, more)


def tables(
    title: str, scenario: Scenario, found: Summary, more: Iterable[RenderableType] = (), first: str = "first"
) -> RenderableType:
    """Tables of criteria, metrics, sensitivities and runs without result, and the verdict."""
    parts: list[RenderableType] = [Text(title, style="bold")]
    if scenario.criterion and found.results:
        parts.append(criteria_table(scenario, found))
    if quantities(found):
        parts.append(metric_table(found))
    if found.sensitivities:
        parts.append(sensitivity_tables.table(found.sensitivities))
    parts += more
    if found.troubles:
        parts.append(no_result_table(found, first))
    return Group(*(line for part in parts for line in (part, "")), verdict(found))


def verdict(found: Summary) -> Text:
    """One line with the number of passed runs."""
    counts = ", ".join(f"{count} {status}" for status, count in found.statuses.most_common())
    line = Text(f"{found.rows} of {found.runs} runs: {counts or 'no results'}", style=STYLES[found.passed])
    if found.statuses["done"]:
        line.append(f"; {NOTHING_DEMANDED}", style="not bold default")
    elif found.rows:
        ends = " .. ".join(f"{100.0 * end:.3g}" for end in found.interval(found.rate))
        interval = f" (95 % confidence: {ends} %)" if ends else ""
        line.append(f"; {100.0 * found.rate:.4g} % passed{interval}", style="not bold default")
    return line


def criteria_table(scenario: Scenario, found: Summary) -> Table:
    """Return the number of passed runs of each criterion."""
    table = plain_table("criterion", "passed in", "claim")
    for entry in scenario.criterion:
        table.add_row(Text(entry.id), f"{found.held[entry.id]} of {found.results}", Text(entry.claim))
    return table


def metric_table(found: Summary) -> Table:
    """Distribution of each metric that is not Boolean."""
    table = plain_table("metric", *QUANTILES, "not finite")
    for name, *shown in spread(found):
        missing = int(np.sum(~np.isfinite(found.values[name])))
        table.add_row(Text(name), *shown, str(missing) if missing else "")
    return table


def worst_table(plan: Plan, found: Summary, runs: list[int]) -> Table:
    """Worst runs by the metric that the study names."""
    name = plan.study.traces.metric
    values = dict(zip(found.columns["run"], found.columns[f"metric.{name}"], strict=True))
    table = plain_table("worst run", name)
    for run in runs:
        table.add_row(str(run), text(values[run], found.units.get(name, "")))
    return table


def no_result_table(found: Summary, first: str) -> Table:
    """Table of the runs without a result, by reason; `first` heads the first run of each."""
    table = plain_table("without result", "runs", first, "reason")
    ranked = sorted(found.troubles.items(), key=lambda item: -item[1][0])
    for (status, reason), (count, where) in ranked[:MAX_TROUBLES]:
        table.add_row(status, str(count), str(where), Text(reason))
    if len(ranked) > MAX_TROUBLES:
        table.add_row("...", "", "", f"and {len(ranked) - MAX_TROUBLES} more reasons, see `results.jsonl`")
    return table


def save_plots(plan: Plan, found: Summary, file: Path) -> None:
    """Plot success rates, distributions with their limits, and the metrics over the varied keys.

    The title states the number of omitted metrics and keys.
    """
    scenario = plan.scenario
    metrics, varied = plotted_metrics(scenario, found), plotted_keys(plan)
    names, keys = metrics[:MAX_METRICS], dict([*varied.items()][:MAX_KEYS])
    more = and_more("metric", len(metrics) - len(names)), and_more("key", len(varied) - len(keys))
    count = 1 + len(keys)
    size = (3.6 * count + 1.0, 2.4 * max(1, len(names)) + 1.6)
    with figures.styled(size, {"axes.formatter.limits": (-3, 4)}) as figure:
        grid = figure.subplots(1 + len(names), count, squeeze=False)
        for axes in grid[0][1:]:
            axes.set_axis_off()
        draw_rates(grid[0][0], scenario, found)
        draw_metrics(grid[1:], plan, found, names, keys)
        lines = plan.study.full_title, verdict(found).plain, ", ".join(filter(None, more))
        figure.suptitle("\n".join(filter(None, lines)), fontsize=10)
        figures.save(figure, file)


def plotted_metrics(scenario: Scenario, found: Summary) -> list[str]:
    """Metrics with criteria, or all; those with a distribution."""
    evaluated = dict.fromkeys(entry.metric for entry in scenario.criterion) or found.values
    different = {name: np.unique(finite(found.values.get(name, np.empty(0)))) for name in evaluated}
    return [name for name, values in different.items() if values.size > 1 and not is_logical(values)]


def plotted_keys(plan: Plan) -> dict[str, Items | None]:
    """Keys with several values; with the numbers of their texts, if they are not numbers."""
    found: dict[str, Items | None] = {}
    for key, taken in plan.varying.items():
        numeric = all(isinstance(value, int | float) and not isinstance(value, bool) for value in taken)
        different = dict.fromkeys(filter(math.isfinite, taken) if numeric else map(shorten, taken))
        if len(different) > 1:
            found[key] = None if numeric else {name: number for number, name in enumerate(different)}
    return found


def draw_rates(axes: Any, scenario: Scenario, found: Summary) -> None:
    """Bars: percentage of passed runs, and of passed results of each criterion."""
    held = {entry.id: found.held[entry.id] / max(1, found.results) for entry in scenario.criterion}
    rates = {"all": found.rate, **held}
    ends = [found.interval(rate) or (rate, rate) for rate in rates.values()]
    errors = [[rate - low, high - rate] for rate, (low, high) in zip(rates.values(), ends, strict=True)]
    # rounding may leave an end on the wrong side of the rate
    spread = 100.0 * np.transpose(errors).clip(0.0) if found.samples else None
    percent = [100.0 * value for value in rates.values()]
    axes.barh(list(rates), percent, xerr=spread, color="tab:green", alpha=0.7, capsize=2.0)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel("passed in (%)" + (", 95 % confidence" if found.samples else ""))


def draw_metrics(
    grid: Any, plan: Plan, found: Summary, names: list[str], keys: dict[str, Items | None]
) -> None:
    """Histogram of each metric with its limits, and the metric over each varied key; failed runs in red."""
    scenario, columns = plan.scenario, found.columns
    logarithmic = [vary.key for vary in plan.study.vary if vary.distribution == "log-uniform"]
    done = np.isin(columns["status"], DONE)
    failed = np.array(columns["status"])[done] == "failed"
    for axes, name in zip(grid, names, strict=True):
        values = np.array(columns[f"metric.{name}"], dtype=np.float64)[done]
        unit = found.units[name]
        parts = [finite(values[~failed]), finite(values[failed])]
        bins = np.histogram_bin_edges(np.concatenate(parts), "auto")
        axes[0].hist(parts, bins=bins, stacked=True, color=["tab:blue", "tab:red"], alpha=0.7)
        axes[0].set_xlabel(f"{name} ({unit})" if unit not in ("", "1") else name)
        held = (entry for entry in scenario.criterion if entry.metric == name)
        for limit in (limit for entry in held for limit in criteria.drawn(entry, unit)):
            axes[0].axvline(limit, color="tab:red", linestyle="--", label=f"limit {number(limit)}")
        for scatter, (key, texts) in zip(axes[1:], keys.items(), strict=True):
            at = np.array(numbers(columns[key], texts), dtype=np.float64)[done]
            # as pixels: a million vectors would be a file of gigabytes
            scatter.plot(at[~failed], values[~failed], ".", markersize=3.0, color="tab:blue", rasterized=True)
            scatter.plot(at[failed], values[failed], "x", markersize=4.0, color="tab:red", rasterized=True)
            scatter.set_xlabel(key)
            scatter.set_ylabel(name)
            if texts:
                scatter.set_xticks(range(len(texts)), [*texts])
            if key in logarithmic:
                scatter.set_xscale("log")
