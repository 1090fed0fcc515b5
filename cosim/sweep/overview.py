"""What `cosim sweep` shows at its end: tables for the terminal and plots."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.text import Text

from cosim.errors import CosimError
from cosim.scenario.model import Scenario
from cosim.show.display import plain_table
from cosim.show.plot import STYLE
from cosim.show.quantity import number, text
from cosim.sweep import influence
from cosim.sweep.plan import Plan, Run
from cosim.sweep.store import DONE, Store
from cosim.sweep.survey import QUANTILES, Survey, confidence, quantiles, rows

MOST_TROUBLES = 8
MOST_PANELS = 6
FEWEST_FOR_TENDENCY = 2
"""Different numbers that a key must take to be drawn."""


def tables(plan: Plan, store: Store, found: Survey, worst: list[Run]) -> RenderableType:
    """Verdict, criteria, metrics, worst runs and what could not be run."""
    scenario = plan.build(plan.base)
    parts: list[RenderableType] = [Text(plan.study.title or plan.study.name, style="bold"), ""]
    if scenario.criterion and found.results:
        parts += [criteria_table(scenario, found), ""]
    if found.values:
        parts += [metric_table(found), ""]
    if found.influences:
        parts += [influence.table(found.influences), ""]
    if worst:
        parts += [worst_table(plan, store, found, worst), ""]
    if found.troubles:
        parts += [no_result_table(plan, found), ""]
    return Group(*parts, verdict(found))


def verdict(found: Survey) -> Text:
    """One line: how many passed."""
    low, high = confidence(found.statuses["passed"], found.rows)
    counts = ", ".join(f"{count} {status}" for status, count in found.statuses.most_common())
    line = Text(
        f"{found.rows} of {found.wanted} runs: {counts or 'nothing yet'}",
        style="bold green" if found.passed else "bold red",
    )
    if found.rows:
        rate = 100.0 * found.statuses["passed"] / found.rows
        interval = f"; {rate:.4g} % passed (95 % confidence: {100.0 * low:.3g} .. {100.0 * high:.3g} %)"
        line.append(interval, style="not bold default")
    return line


def criteria_table(scenario: Scenario, found: Survey) -> RenderableType:
    """How often each criterion held."""
    table = plain_table("criterion", "holds in", "claim")
    for entry in scenario.criterion:
        table.add_row(Text(entry.id), f"{found.held[entry.id]} of {found.results}", Text(entry.claim))
    return table


def metric_table(found: Survey) -> RenderableType:
    """Distribution of each metric."""
    table = plain_table("metric", *QUANTILES, "not finite")
    for name, values in found.values.items():
        missing = int(np.sum(~np.isfinite(values)))
        shown = [text(value, found.units[name]) for value in quantiles(values).values()]
        table.add_row(Text(name), *shown, str(missing) if missing else "")
    return table


def worst_table(plan: Plan, store: Store, found: Survey, worst: list[Run]) -> RenderableType:
    """Worst runs, and how to repeat them."""
    name = plan.study.traces.metric
    table = plain_table("worst run", name, "repeat it with")
    for run in worst:
        row = store.row(run)
        if row is not None:
            table.add_row(
                str(run.number), text(float(row["metrics"][name]), found.units[name]), Text(plan.command(run))
            )
    return table


def no_result_table(plan: Plan, found: Survey) -> RenderableType:
    """Table of the runs without a result, by reason."""
    table = plain_table("without result", "runs", "first", "reason")
    ranked = sorted(found.troubles.items(), key=lambda item: -item[1][0])
    for (status, reason), (count, first) in ranked[:MOST_TROUBLES]:
        table.add_row(status, str(count), str(first), Text(reason))
    if len(ranked) > MOST_TROUBLES:
        table.add_row("...", "", "", f"and {len(ranked) - MOST_TROUBLES} reasons more, see `results.jsonl`")
    return table


def can_plot() -> bool:
    """Whether matplotlib is installed."""
    return importlib.util.find_spec("matplotlib") is not None


def save_plots(plan: Plan, store: Store, found: Survey, file: Path) -> None:
    """Draw success rates, distributions with their limits, and the metrics over the numbers that were varied.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    scenario = plan.build(plan.base)
    names = drawn_metrics(scenario, found)
    keys = drawn_keys(plan)
    count = 1 + len(keys)
    with matplotlib.rc_context({**STYLE, "axes.formatter.limits": (-3, 4)}):
        size = (3.6 * count + 1.0, 2.4 * max(1, len(names)) + 1.6)
        figure, grid = pyplot.subplots(
            1 + len(names), count, squeeze=False, layout="constrained", figsize=size
        )
        for axes in grid[0][1:]:
            axes.set_axis_off()
        draw_rates(grid[0][0], scenario, found)
        draw_metrics(grid[1:], plan, store, found, names, keys)
        figure.suptitle(f"{plan.study.title or plan.study.name}\n{verdict(found).plain}", fontsize=10)
        try:
            figure.savefig(file, metadata={"Date": None})
        except OSError as error:
            raise CosimError(f"cannot write `{file}`: {error.strerror or error}") from None
        finally:
            pyplot.close(figure)


def drawn_metrics(scenario: Scenario, found: Survey) -> list[str]:
    """Metrics that criteria judge, or all; those with a distribution, and not too many."""
    judged = list(dict.fromkeys(entry.metric for entry in scenario.criterion)) or list(found.values)
    return [name for name in judged if is_quantity(found.values.get(name, np.empty(0)))][:MOST_PANELS]


def is_quantity(values: Any) -> bool:
    """Whether values vary and are more than yes and no."""
    different = np.unique(finite(values))
    return different.size > 1 and not np.all(np.isin(different, (0.0, 1.0)))


def drawn_keys(plan: Plan) -> list[str]:
    """Varied keys that are numbers."""
    numbers: dict[str, set[float]] = {}
    for run in plan.runs:
        for key, value in run.changes.items():
            if isinstance(value, int | float) and not isinstance(value, bool):
                numbers.setdefault(key, set()).add(value)
    return [key for key, values in numbers.items() if len(values) >= FEWEST_FOR_TENDENCY][:4]


def draw_rates(axes: Any, scenario: Scenario, found: Survey) -> None:
    """Bars: share of runs that passed, and of results in which each criterion holds."""
    bars = {"all": (found.statuses["passed"], found.rows)}
    bars |= {entry.id: (found.held[entry.id], found.results) for entry in scenario.criterion}
    rates = [100.0 * held / max(1, count) for held, count in bars.values()]
    intervals = [[100.0 * end for end in confidence(*pair)] for pair in bars.values()]
    errors = [
        [max(0.0, rate - low), max(0.0, high - rate)]
        for rate, (low, high) in zip(rates, intervals, strict=True)
    ]
    axes.barh(list(bars), rates, xerr=np.transpose(errors), color="tab:green", alpha=0.7, capsize=2.0)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel("holds in (%), 95 % confidence")


def draw_metrics(
    grid: Any, plan: Plan, store: Store, found: Survey, names: list[str], keys: list[str]
) -> None:
    """Histogram of each metric with its limits, and the metric over each varied key; failed runs in red."""
    scenario = plan.build(plan.base)
    done = [row for row in rows(plan, store) if row["status"] in DONE]
    logarithmic = [vary.key for vary in plan.study.vary if vary.distribution == "log-uniform"]
    failed = np.array([row["status"] == "failed" for row in done], dtype=bool)
    for axes, name in zip(grid, names, strict=True):
        values = np.array([float(row["metrics"][name]) for row in done])
        unit = found.units[name]
        axes[0].hist(finite(values), bins="auto", color="tab:blue", alpha=0.7)
        axes[0].set_xlabel(f"{name} ({unit})" if unit not in ("", "1") else name)
        for limit in limits(scenario, name):
            axes[0].axvline(limit, color="tab:red", linestyle="--", label=f"limit {number(limit)}")
        for place, key in zip(axes[1:], keys, strict=True):
            at = np.array([float(row["set"].get(key, math.nan)) for row in done])
            place.plot(at[~failed], values[~failed], ".", markersize=3.0, color="tab:blue")
            place.plot(at[failed], values[failed], "x", markersize=4.0, color="tab:red")
            place.set_xlabel(key)
            place.set_ylabel(name)
            if key in logarithmic:
                place.set_xscale("log")


def limits(scenario: Scenario, name: str) -> list[float]:
    """Limits of a metric."""
    held = [entry for entry in scenario.criterion if entry.metric == name]
    return [limit for entry in held for limit in (entry.minimum, entry.maximum) if limit is not None]


def finite(values: Any) -> Any:
    """Return only the finite values."""
    return values[np.isfinite(values)]
