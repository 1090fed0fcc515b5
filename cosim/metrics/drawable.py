"""Checks that the plots and charts of a scenario can be made from the columns of its trace."""

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
    "map": ("x", "y"),
    "bode": ("x", "y"),
    "field": ("function", "y"),
}
"""Required keys of a kind of chart; the others need `y`."""
TAKEN = {
    "path": ("x", "parts", "names", "error", "split", "split_name", "log", "x_log"),
    "polar": ("x", "parts", "names", "split", "split_name", "log"),
    "spectrum": ("x", "parts", "names", "log", "x_log"),
    "peaks": ("parts", "names", "split", "log", "x_log"),
    "share": ("parts", "names", "log", "x_log"),
    "roc": ("parts", "names", "log", "x_log"),
    "map": ("x", "parts", "weight"),
    "bode": ("x", "closed"),
    "field": ("parts", "function"),
}
"""Special keys accepted by each kind of chart."""
SPECIAL = sorted({key for keys in TAKEN.values() for key in keys})
"""Keys that not all kinds of charts accept."""
COUNTS = {
    "map": ("y", 1, "Make one map for each."),
    "bode": ("y", 2, "Give gain, and phase in rad."),
    "roc": ("parts", 2, "Give the rows without the event, then the rows with it."),
}
"""Key of a kind of chart with a fixed number of items, the number, and the hint."""


def check(scenario: Scenario, columns: Mapping[str, Items | None]) -> None:
    """Check that panels, limits, zoom and charts of a scenario can be made from the columns of its trace."""
    with concerning("plot.panels"):
        for number, panel in enumerate(scenario.plot.panels):
            where = f"`plot.panels[{number}].columns`"
            if not panel.columns:
                raise ScenarioError(f"{where} is empty", "Name the columns of the panel.")
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
            problem = f"{where} names `{column}`, which is not a column of the trace"
            raise ScenarioError(problem, closest(column, columns))


def check_charts(charts: Sequence[Chart], key: str, columns: Mapping[str, Items | None]) -> None:
    """Check that charts of a key can be made from columns."""
    for number, chart in enumerate(charts):
        where = f"{key}[{number}]"
        check_keys(chart, where)
        check_names(chart, where, columns)


def zoom(scenario: Scenario, columns: Mapping[str, Items | None]) -> Expression | None:
    """Compile the time of the zoom; None if the scenario has none."""
    if not scenario.plot.zoom:
        return None
    with concerning("plot.zoom"):
        return Expression(f"first_time({scenario.plot.zoom})", columns, "`plot.zoom`")


def check_keys(chart: Chart, where: str) -> None:
    """Check the required and the accepted keys of a chart."""
    kind = f"of the kind `{chart.kind}`"
    needed = NEEDED.get(chart.kind, ("y",))
    if missing := [name for name in needed if not getattr(chart, name)]:
        problem = f"`{where}` {kind} has no `{missing[0]}`"
        raise ScenarioError(problem, f"Give {' and '.join(f'`{name}`' for name in needed)}.")
    for key in SPECIAL:
        if key not in TAKEN[chart.kind] and getattr(chart, key) != getattr(Chart, key):
            kinds = ", ".join(f"`{name}`" for name, keys in TAKEN.items() if key in keys)
            raise ScenarioError(f"`{where}` {kind} does not accept `{key}`", f"Use it for {kinds}.")
    if chart.error and (chart.split or not chart.equal):
        problem = f"`{where}` has an `error` and {'a `split`' if chart.split else 'no `equal`'}"
        raise ScenarioError(problem, "Set `equal`, and no `split`: an error is drawn normal to a path.")
    key, needs, hint = COUNTS.get(chart.kind, ("y", len(chart.y), ""))
    if (has := len(getattr(chart, key))) != needs:
        raise ScenarioError(f"`{where}` {kind} has {has} `{key}` and needs {needs}", hint)
    if chart.kind == "field" and not all(chart.function.partition(":")):
        raise ScenarioError(f"`{where}.function` is `{chart.function}`", "Name the function `module:name`.")
    # both parts of a `roc` make one line
    count = len(chart.y) * (1 if chart.kind == "roc" else max(1, len(chart.parts)))
    if chart.names and len(chart.names) != count:
        raise ScenarioError(f"`{where}.names` has {len(chart.names)} names for {count} lines")


def check_names(chart: Chart, where: str, columns: Mapping[str, Items | None]) -> None:
    """Check the columns of a chart."""
    if chart.kind == "bode":
        for name in (chart.x, *chart.y):
            if not numbered(name, columns):
                problem = f"`{where}` names `{name}[1]`, which is not a column"
                raise ScenarioError(problem, closest(name, columns))
        return
    for text in filter(None, (chart.x, *chart.y, *chart.parts, chart.error, chart.split, chart.weight)):
        Expression(text, columns, f"`{where}`")


def numbered(name: str, columns: Iterable[str]) -> list[str]:
    """Columns `name[1]`, `name[2]`, ... in their order."""
    matches = filter(None, (re.fullmatch(rf"{re.escape(name)}\[(\d+)\]", one) for one in columns))
    return [match[0] for match in sorted(matches, key=lambda match: int(match[1]))]
