"""Plot of a run as SVG or PNG."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError, ScenarioError, closest
from cosim.result import Result
from cosim.scenario import Panel, Scenario

MOST_PANELS = 6
ENDINGS = (".svg", ".png", ".pdf")


def check(scenario: Scenario, columns: list[str], path: Path) -> None:
    """Check before the run that the plot can be made.

    Raises
    ------
    CosimError
        Unknown ending or column, or matplotlib is not installed.
    """
    if path.suffix not in ENDINGS:
        raise CosimError(
            f"cannot plot to `{path}`", f"the name must end in {', '.join(f'`{e}`' for e in ENDINGS)}"
        )
    for index, panel in enumerate(scenario.plot.panels):
        for column in panel.columns:
            if column not in columns:
                raise ScenarioError(
                    f"`plot.panels[{index}].columns` names `{column}`, which is no column of the trace",
                    closest(column, columns),
                )
    try:
        importlib.import_module("matplotlib")
    except ImportError:
        raise CosimError(
            "matplotlib is not installed, it makes the plots",
            "install the extra: `pip install machining-fmus[report]`",
        ) from None


def save(scenario: Scenario, result: Result, path: Path) -> None:
    """Plot the panels of a scenario, or all that moves if it names none, into a file.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    trace = result.trace
    if trace is None:
        raise CosimError("this result holds no trace, there is nothing to plot")
    panels = scenario.plot.panels or default_panels(trace, result.units)
    # SVG with the same bytes for the same run
    options: Any = {
        "svg.hashsalt": "cosim",
        "axes.grid": True,
        "grid.alpha": 0.3,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "font.size": 9.0,
        "legend.frameon": False,
        "path.simplify": True,
    }
    with matplotlib.rc_context(options):
        figure, grid = pyplot.subplots(
            len(panels),
            sharex=True,
            squeeze=False,
            layout="constrained",
            figsize=(9.0, 1.2 + 1.7 * len(panels)),
        )
        for axes, panel in zip(grid[:, 0], panels, strict=True):
            draw(axes, trace, panel, result.units)
        grid[-1, 0].set_xlabel("time (s)")
        verdict = (
            "" if not result.criteria else (" - all criteria hold" if result.passed else " - criteria fail")
        )
        figure.suptitle(f"{result.title}\n{result.scenario}, seed {result.seed}{verdict}", fontsize=10)
        try:
            figure.savefig(path, dpi=130, metadata={"Date": None} if path.suffix == ".svg" else None)
        except OSError as error:
            raise CosimError(f"cannot write `{path}`: {error.strerror or error}") from None
        finally:
            pyplot.close(figure)


def draw(axes: Any, trace: NDArray[Any], panel: Panel, units: dict[str, str]) -> None:
    """Draw one panel; values that only jump (modes, flags) are drawn as steps."""
    for column in panel.columns:
        values = trace[column]
        stepped = bool(np.all(values == np.round(values)))
        axes.plot(
            trace["time"],
            panel.scale * values,
            label=column,
            linewidth=1.1,
            drawstyle="steps-post" if stepped else "default",
        )
    unit = panel.unit or (units.get(panel.columns[0], "") if panel.scale == 1.0 else "")
    axes.set_ylabel(unit if unit != "1" else "")
    axes.set_title(panel.title, fontsize=9, loc="left")
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    axes.margins(x=0.0)


def default_panels(trace: NDArray[Any], units: dict[str, str]) -> tuple[Panel, ...]:
    """Panels of a scenario that names none: columns that move, one panel for each unit."""
    groups: dict[str, list[str]] = {}
    for name in trace.dtype.names or ():
        values = trace[name]
        if name != "time" and np.any(values != values[0]):
            groups.setdefault(units.get(name, ""), []).append(name)
    most = sorted(groups.items(), key=lambda group: -len(group[1]))[:MOST_PANELS]
    return tuple(Panel(columns=tuple(names[:8]), unit=unit) for unit, names in most) or (
        Panel(columns=tuple((trace.dtype.names or ())[1:4])),
    )
