"""Presentation of the sensitivity of a sweep: table, tornado plots and heat map."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table
from rich.text import Text

from cosim.show import figure as figures
from cosim.show.listing import plain_table
from cosim.sweep.sensitivity import UNKNOWN, Estimate, Sensitivity

MAX_KEYS = 6
"""Maximum number of keys in a table; the plots and the JSON have all."""
MAX_TORNADOS = 9


def table(found: list[Sensitivity]) -> Table:
    """Rank correlation of each metric with the strongest keys; bold if its interval excludes zero."""
    keys = ranked_keys(found)
    shown = plain_table("sensitivity of", *keys[:MAX_KEYS])
    by_both = {(entry.metric, entry.key): entry for entry in found}
    for metric in names(found):
        shown.add_row(Text(metric), *(cell(by_both[metric, key]) for key in keys[:MAX_KEYS]))
    if len(keys) > MAX_KEYS:
        shown.caption = f"and {len(keys) - MAX_KEYS} weaker keys, see `sensitivity.svg`"
    return shown


def cell(entry: Sensitivity) -> Text:
    """Rank correlation with its interval, and Sobol indices if available."""
    if math.isnan(entry.rank.value):
        return Text("")
    text = f"{entry.rank.value:+.2f} ({entry.rank.low:+.2f} .. {entry.rank.high:+.2f})"
    if entry.first is not None and entry.total is not None:
        text += f" S {entry.first.value:.2f} T {entry.total.value:.2f}"
    clear = entry.rank.low > 0.0 or entry.rank.high < 0.0
    return Text(text, style="bold" if clear else "")


def names(found: list[Sensitivity]) -> list[str]:
    """Metrics in their order."""
    return list(dict.fromkeys(entry.metric for entry in found))


def ranked_keys(found: list[Sensitivity]) -> list[str]:
    """Keys by their strongest effect, the strongest first."""
    keys = dict.fromkeys(entry.key for entry in found)
    strength = {key: max(entry.strength for entry in found if entry.key == key) for key in keys}
    return sorted(strength, key=lambda key: -strength[key])


def save_plots(found: list[Sensitivity], title: str, file: Path) -> None:
    """Draw the heat map of all metrics and keys, and a tornado for each metric."""
    metrics, keys = names(found), ranked_keys(found)
    drawn = metrics[:MAX_TORNADOS]
    columns = min(3, len(drawn))
    lines = -(-len(drawn) // columns)
    heat, line = 0.32 * len(metrics) + 1.4, 0.34 * len(keys) + 1.0
    size = (4.0 * max(2, columns) + 1.0, heat + line * lines + 0.6)
    with figures.styled(size, {"axes.grid": False}) as figure:
        grid = figure.add_gridspec(1 + lines, columns, height_ratios=[heat, *[line] * lines])
        draw_heat_map(figure, figure.add_subplot(grid[0, :]), found, metrics, keys)
        for index, metric in enumerate(drawn):
            axes = figure.add_subplot(grid[1 + index // columns, index % columns])
            draw_tornado(axes, [entry for entry in found if entry.metric == metric])
        figure.suptitle(f"{title}\nsensitivity, 95 % confidence", fontsize=10)
        figures.save(figure, file)


def draw_heat_map(
    figure: Any, axes: Any, found: list[Sensitivity], metrics: list[str], keys: list[str]
) -> None:
    """Rank correlation of every metric with every key as a color and a number."""
    by_both = {(entry.metric, entry.key): entry.rank.value for entry in found}
    values = np.array([[by_both[metric, key] for key in keys] for metric in metrics])
    image = axes.imshow(values, cmap="RdBu_r", vmin=-1.0, vmax=1.0, aspect="auto")
    axes.set_xticks(range(len(keys)), keys, rotation=20, ha="right")
    axes.set_yticks(range(len(metrics)), metrics)
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            colour = "white" if abs(value) > 0.6 else "black"
            axes.text(column, row, f"{value:.2f}", ha="center", va="center", color=colour, fontsize=7)
    figure.colorbar(image, ax=axes, label="rank correlation")


def draw_tornado(axes: Any, entries: list[Sensitivity]) -> None:
    """Bars of one metric, the strongest key on top: Sobol indices, otherwise rank correlations."""
    keys = [entry.key for entry in entries]
    if entries[0].total is not None:
        draw_bars(axes, -0.2, [entry.first for entry in entries], "tab:blue", "first order")
        draw_bars(axes, 0.2, [entry.total for entry in entries], "tab:orange", "total")
        axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
        axes.set_xlabel("fraction of the variance")
        axes.legend(fontsize=7, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    else:
        draw_bars(axes, 0.0, [entry.rank for entry in entries], "tab:blue", "")
        axes.set_xlim(-1.0, 1.0)
        axes.set_xlabel("rank correlation")
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.set_yticks(range(len(keys)), keys)
    axes.invert_yaxis()
    axes.set_title(entries[0].metric, fontsize=9, loc="left")


def draw_bars(axes: Any, shift: float, estimates: list[Estimate | None], colour: str, label: str) -> None:
    """Horizontal bars with their intervals."""
    known = [estimate or UNKNOWN for estimate in estimates]
    values, low, high = np.array([(estimate.value, estimate.low, estimate.high) for estimate in known]).T
    errors = np.fmax(0.0, [values - low, high - values])
    rows = np.arange(len(known)) + shift
    height = 0.36 if shift else 0.7
    axes.barh(rows, values, height, xerr=errors, color=colour, alpha=0.7, capsize=2.0, label=label)
