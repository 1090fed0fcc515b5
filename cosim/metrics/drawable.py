"""Whether all that a scenario wants drawn can be made of the columns of its trace."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from cosim.errors import ScenarioError, closest, concerning
from cosim.metrics.expression import Expression, Items
from cosim.scenario.model import Chart, Scenario

NEEDED = {
    "path": ("x", "y"),
    "polar": ("x", "y"),
    "peaks": ("split", "y"),
    "array": ("x", "y"),
    "map": ("x", "y"),
    "bode": ("x", "y"),
    "field": ("function", "y"),
}
"""What a chart of a kind cannot do without; the others need `y`."""
TAKEN = {
    "path": ("x", "parts", "names", "error", "split", "split_name", "log", "x_log"),
    "polar": ("x", "parts", "names", "split", "split_name", "log"),
    "spectrum": ("x", "parts", "names", "log", "x_log"),
    "peaks": ("parts", "names", "split", "log", "x_log"),
    "share": ("parts", "names", "log", "x_log"),
    "roc": ("parts", "names", "log", "x_log"),
    "array": ("x", "names", "log", "x_log"),
    "map": ("x", "parts", "weight"),
    "bode": ("x", "closed"),
    "field": ("parts", "function"),
}
"""What a chart of a kind takes of the keys that not all of them take."""
SOME = sorted({key for keys in TAKEN.values() for key in keys})


def check(scenario: Scenario, columns: Mapping[str, Items | None]) -> None:
    """Check that panels, limits, zoom and charts of a scenario can be made of the columns of its trace.

    Raises
    ------
    CosimError
        Unknown column, wrong expression, a panel without columns, or a chart without what its kind needs or
        with what it does not take.
    """
    with concerning("plot.panels"):
        for number, panel in enumerate(scenario.plot.panels):
            where = f"`plot.panels[{number}].columns`"
            if not panel.columns:
                raise ScenarioError(f"{where} is empty", "name the columns that the panel shows")
            check_columns(panel.columns, where, columns)
    for criterion in scenario.criterion:
        with concerning(f"criterion.{criterion.id}.columns"):
            check_columns(criterion.columns, f"`criterion.{criterion.id}.columns`", columns)
    zoom(scenario, columns)
    with concerning("plot.charts"):
        check_charts(scenario.plot.charts, "plot.charts", columns)


def check_columns(named: Iterable[str], where: str, columns: Mapping[str, Items | None]) -> None:
    """Check that columns are those of the trace."""
    for column in named:
        if column not in columns:
            problem = f"{where} names `{column}`, which is no column of the trace"
            raise ScenarioError(problem, closest(column, columns))


def check_charts(charts: Sequence[Chart], key: str, columns: Mapping[str, Items | None]) -> None:
    """Check that charts of a key can be made of columns.

    Raises
    ------
    CosimError
        As for `check`.
    """
    for number, chart in enumerate(charts):
        check_keys(chart, f"{key}[{number}]")
        check_names(chart, f"{key}[{number}]", columns)


def zoom(scenario: Scenario, columns: Mapping[str, Items | None]) -> Expression | None:
    """Compile the time of the zoom; None where the scenario wants none.

    Raises
    ------
    CosimError
        Unknown column or wrong expression.
    """
    if not scenario.plot.zoom:
        return None
    with concerning("plot.zoom"):
        return Expression(f"first_time({scenario.plot.zoom})", columns, "`plot.zoom`")


def check_keys(chart: Chart, where: str) -> None:
    """Check that a chart has what its kind needs, and nothing that it does not take."""
    kind = f"of the kind `{chart.kind}`"
    needed = NEEDED.get(chart.kind, ("y",))
    if missing := [name for name in needed if not getattr(chart, name)]:
        problem = f"`{where}` {kind} has no `{missing[0]}`"
        raise ScenarioError(problem, "it needs " + " and ".join(f"`{name}`" for name in needed))
    plain = Chart("path", ())
    for key in SOME:
        if key not in TAKEN[chart.kind] and getattr(chart, key) != getattr(plain, key):
            kinds = ", ".join(f"`{name}`" for name, keys in TAKEN.items() if key in keys)
            raise ScenarioError(f"`{where}` {kind} takes no `{key}`", f"it is for {kinds}")
    if chart.error and (chart.split or not chart.equal):
        problem = f"`{where}` has an `error` and {'a `split`' if chart.split else 'no `equal`'}"
        raise ScenarioError(problem, "an error is drawn across a whole way, both axes with the same scale")
    if chart.kind == "map" and len(chart.y) != 1:
        raise ScenarioError(f"`{where}` {kind} has {len(chart.y)} `y` and takes 1", "make a map of each")
    if chart.kind == "bode" and len(chart.y) != 2:
        raise ScenarioError(f"`{where}` {kind} has {len(chart.y)} `y` and needs 2", "gain, and phase in rad")
    if chart.kind == "field" and not all(chart.function.partition(":")):
        raise ScenarioError(f"`{where}.function` is `{chart.function}`", "a function is named `module:name`")
    if chart.kind == "roc" and len(chart.parts) != 2:
        problem = f"`{where}` {kind} has {len(chart.parts)} `parts` and needs 2"
        raise ScenarioError(problem, "first the rows without what is sought, then those with it")
    # a threshold parts both
    count = len(chart.y) * (1 if chart.kind == "roc" else max(1, len(chart.parts)))
    if chart.names and len(chart.names) != count:
        raise ScenarioError(f"`{where}.names` has {len(chart.names)} names for {count} lines")


def check_names(chart: Chart, where: str, columns: Mapping[str, Items | None]) -> None:
    """Check the columns that a chart is made of."""
    if chart.kind in ("array", "bode"):
        for name in (chart.x, *chart.y):
            if not numbered(name, columns):
                problem = f"`{where}` names `{name}[1]`, which is no column"
                raise ScenarioError(problem, closest(name, columns))
        return
    for text in filter(None, (chart.x, *chart.y, *chart.parts, chart.error, chart.split, chart.weight)):
        Expression(text, columns, f"`{where}`")


def numbered(name: str, columns: Iterable[str]) -> list[str]:
    """Columns `name[1]`, `name[2]`, ... in their order."""
    found = [
        (int(match[1]), one)
        for one in columns
        if (match := re.fullmatch(rf"{re.escape(name)}\[(\d+)\]", one))
    ]
    return [one for _, one in sorted(found)]
