"""Charts of the kind `field`: maps that a user function computes from a trace."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import ScenarioError, closest
from cosim.loop import own_code
from cosim.report.curves import Cells
from cosim.scenario.model import Chart
from cosim.trace.columns import Array


def maps(chart: Chart, values: Sequence[Array], folder: Path) -> list[tuple[str, Cells]]:
    """Make the maps of a chart by name, relative to the largest value; none if it is not above 0.

    `values` are the arguments of the function, `folder` is that of the scenario. An error if there is no such
    function, it raises, or its result is not a set of maps.
    """
    where = f"`plot.charts` `{chart.title}`: the function `{chart.function}`"
    function = import_function(chart.function, where, folder)
    try:
        made = {
            str(name): [np.asarray(part, dtype=float) for part in one]
            for name, one in function(*values).items()
        }
    except Exception as error:  # the function may raise anything
        problem = f"{where} failed: {type(error).__name__}: {error}"
        raise ScenarioError(problem, "Show the origin with `-v`.") from error
    for name, one in made.items():
        shapes = [part.shape for part in one]
        if [part.ndim for part in one] != [1, 1, 2] or shapes[2] != (len(one[1]) - 1, len(one[0]) - 1):
            problem = f"{where} gives `{name}` of the shapes {shapes}"
            hint = "Return edges along x (n + 1), edges along y (m + 1), and values (m, n)."
            raise ScenarioError(problem, hint)
    known = {name: np.where(np.isfinite(part), part, 0.0) for name, (_, _, part) in made.items()}
    most = max((float(part.max(initial=0.0)) for part in known.values()), default=0.0)
    return [
        (name, Cells(chart.x_scale * x, chart.scale * y, known[name] / most))
        for name, (x, y, _) in made.items()
        if most > 0.0
    ]


def import_function(name: str, where: str, folder: Path) -> Any:
    """Import the function of that name."""
    module_name, _, function = name.partition(":")
    try:
        module = own_code.module(module_name, folder)
    except Exception as error:  # the module may raise anything
        problem = f"{where} cannot be imported: {type(error).__name__}: {error}"
        raise ScenarioError(problem, own_code.where(folder)) from error
    if not callable(getattr(module, function, None)):
        public = [key for key, value in vars(module).items() if callable(value)]
        raise ScenarioError(f"{where} does not exist", closest(function, public))
    return getattr(module, function)
