"""A comparison of traces as a plot: the tube, the course of the other, and where it leaves."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np

from cosim.compare.comparison import Comparison, Deviation
from cosim.errors import CosimError
from cosim.show.plot import ENDINGS, STYLE

MOST_PANELS = 6


def check(kind: str, path: Path) -> None:
    """Check before the comparison that the plot can be made.

    Raises
    ------
    CosimError
        Not of traces, unknown ending, no such folder, or matplotlib is not installed.
    """
    if kind != "trace":
        raise CosimError(f"`--plot` does not go with a {kind}", "only traces have courses to draw")
    if path.suffix not in ENDINGS:
        endings = ", ".join(f"`{ending}`" for ending in ENDINGS)
        raise CosimError(f"cannot plot to `{path}`", f"the name must end in {endings}")
    if not path.absolute().parent.is_dir():
        raise CosimError(f"cannot write `{path}`: the folder `{path.absolute().parent}` does not exist")
    if importlib.util.find_spec("matplotlib") is None:
        hint = "install the extra: `pip install machining-fmus[report]`"
        raise CosimError("matplotlib is not installed, it makes the plots", hint)


def save(found: Comparison, path: Path) -> None:
    """Draw the columns that deviate most for their tolerance, at most six, one above the other.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    drawn = sorted(found.deviations, key=lambda d: (not d.outside, -d.outside))[:MOST_PANELS]
    with matplotlib.rc_context(STYLE):
        figure, grid = pyplot.subplots(
            len(drawn),
            1,
            sharex=True,
            squeeze=False,
            layout="constrained",
            figsize=(9.0, 1.2 + 1.7 * len(drawn)),
        )
        for (axes,), deviation in zip(grid, drawn, strict=True):
            draw(axes, found, deviation)
        grid[0][0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
        grid[-1][0].set_xlabel("time (s)")
        figure.suptitle(f"{found.other} against {found.reference}", fontsize=10)
        try:
            figure.savefig(path, dpi=110, metadata={"Date": None} if path.suffix == ".svg" else None)
        except OSError as error:
            raise CosimError(f"cannot write `{path}`: {error.strerror or error}") from None
        finally:
            pyplot.close(figure)


def draw(axes: Any, found: Comparison, deviation: Deviation) -> None:
    """Draw one column."""
    course = found.courses[deviation.name]
    low, high = course.tube.walls
    axes.fill_between(course.times, low, high, color="tab:green", alpha=0.3, label="tolerance")
    axes.plot(course.times, 0.5 * (low + high), color="tab:green", linewidth=0.8, label="reference")
    axes.plot(course.times, course.values, color="tab:blue", linewidth=0.8, label="other")
    outside = course.tube.deviation(course.values) > course.tube.tolerance(course.values)
    where = np.where(outside, course.values, np.nan)
    axes.plot(course.times, where, ".", color="tab:red", markersize=3.0, label="outside", rasterized=True)
    unit = f" ({deviation.unit})" if deviation.unit not in ("", "1") else ""
    axes.set_title(f"{deviation.name}{unit}", fontsize=9, loc="left")
