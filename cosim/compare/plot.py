"""Plot of compared traces: the tube, the compared curve, and the rows outside the tube."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cosim.compare.comparison import Comparison, Deviation
from cosim.errors import CosimError
from cosim.show import figure as figures

MAX_PANELS = 6


def check(kind: str, path: Path) -> None:
    """Check before the comparison that the plot can be made."""
    if kind != "trace":
        raise CosimError(f"`--plot` cannot be used with a {kind}", "Use `--plot` with traces only.")
    figures.check(path)


def save(found: Comparison, path: Path) -> None:
    """Plot up to six columns with the largest deviations relative to their tolerance."""
    drawn = sorted(found.deviations, key=lambda d: (not d.outside, -d.outside))[:MAX_PANELS]
    with figures.styled((9.0, 1.2 + 1.7 * len(drawn))) as figure:
        grid = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)
        for (axes,), deviation in zip(grid, drawn, strict=True):
            draw(axes, found, deviation)
        grid[0][0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
        grid[-1][0].set_xlabel("time (s)")
        figure.suptitle(f"{found.other} against {found.reference}", fontsize=10)
        figures.save(figure, path)


def draw(axes: Any, found: Comparison, deviation: Deviation) -> None:
    """Plot one column."""
    curve = found.curves[deviation.name]
    low, high = curve.tube.walls
    axes.fill_between(curve.times, low, high, color="tab:green", alpha=0.3, label="tolerance")
    axes.plot(curve.times, 0.5 * (low + high), color="tab:green", linewidth=0.8, label="reference")
    axes.plot(curve.times, curve.values, color="tab:blue", linewidth=0.8, label="other")
    outside = curve.tube.deviation(curve.values) > curve.tube.tolerance(curve.values)
    where = np.where(outside, curve.values, np.nan)
    axes.plot(curve.times, where, ".", color="tab:red", markersize=3.0, label="outside", rasterized=True)
    unit = f" ({deviation.unit})" if deviation.unit not in ("", "1") else ""
    axes.set_title(f"{deviation.name}{unit}", fontsize=9, loc="left")
