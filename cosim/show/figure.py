"""Figures: common functions of all plots, from the check before a run to the file."""

from __future__ import annotations

import contextlib
import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cosim import extras
from cosim.errors import CosimError
from cosim.writing import check_folder, whole

ENDINGS = (".svg", ".png", ".pdf")
STYLE: Any = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "font.size": 9.0,
    "grid.alpha": 0.3,
    "legend.frameon": False,
    "svg.hashsalt": "cosim",  # the same run gives the same bytes
}
SVG = {"Creator": "cosim", "Date": None}
"""Metadata of an SVG without a date, so that equal runs give identical bytes."""


def can_plot() -> bool:
    """Whether matplotlib is installed."""
    return importlib.util.find_spec("matplotlib") is not None


def plots_requested(plots: bool) -> bool:
    """Whether plots are requested and matplotlib is installed; checks that it starts."""
    return plots and can_plot() and library() is not None


def check(file: Path) -> None:
    """Check that a figure can be made: its ending and folder, and matplotlib."""
    if file.suffix not in ENDINGS:
        endings = ", ".join(f"`{ending}`" for ending in ENDINGS)
        raise CosimError(f"cannot plot to `{file}`", f"Use a name that ends in {endings}.")
    check_folder(file)
    if not can_plot():
        raise CosimError("matplotlib is not installed; it makes the plots", extras.hint("report"))
    library()


def library() -> Any:
    """Return matplotlib, which does not start with a wrong setting."""
    try:
        import matplotlib
    except ValueError as error:  # of a backend that is none
        raise CosimError(f"matplotlib does not start: {error}", "Unset `MPLBACKEND`.") from error
    return matplotlib


@contextlib.contextmanager
def styled(size: tuple[float, float], changes: Any = None) -> Iterator[Any]:
    """Return an empty figure of a size in inches in the style of all figures, with settings by name.

    It is not one of `pyplot`, which would choose and keep the backend of a notebook.
    """
    matplotlib = library()
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE | (changes or {})):
        yield Figure(figsize=size, layout="constrained")


def save(figure: Any, file: Path) -> None:
    """Write a figure."""
    escape_dollars(figure)
    with whole(file) as part:
        figure.savefig(part, dpi=110, metadata=SVG if file.suffix == ".svg" else None)


def escape_dollars(figure: Any) -> None:
    """Escape `$` in names, units and titles, except in labels of matplotlib on logarithmic axes."""
    from matplotlib.text import Text

    axes = [axis for part in figure.axes for axis in (part.xaxis, part.yaxis) if axis.get_scale() == "log"]
    formulas = {label for axis in axes for label in axis.get_ticklabels(which="both")}
    for text in figure.findobj(Text):
        text.set_parse_math(text in formulas)
