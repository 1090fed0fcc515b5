"""Whether the charts of a scenario can be made of the columns of its trace."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from cosim.errors import ScenarioError, closest, concerning
from cosim.metrics.expression import Expression, Items
from cosim.scenario.model import Scenario


def check(scenario: Scenario, columns: Mapping[str, Items | None]) -> None:
    """Check that the charts of a scenario can be made of the columns of its trace.

    Raises
    ------
    CosimError
        Unknown column, wrong expression, or a chart without what its kind needs.
    """
    for number, chart in enumerate(scenario.plot.charts):
        where = f"plot.charts[{number}]"
        with concerning("plot.charts"):
            needed = {
                "path": ("x", "y"),
                "peaks": ("split", "y"),
                "array": ("x", "y"),
                "map": ("x", "y"),
            }.get(chart.kind, ("y",))
            if missing := [name for name in needed if not getattr(chart, name)]:
                problem = f"`{where}` of the kind `{chart.kind}` has no `{missing[0]}`"
                raise ScenarioError(problem, "it needs " + " and ".join(f"`{name}`" for name in needed))
            if chart.kind == "roc" and len(chart.parts) != 2:
                problem = f"`{where}` of the kind `roc` has {len(chart.parts)} `parts` and needs 2"
                raise ScenarioError(problem, "first the rows without what is sought, then those with it")
            # a threshold parts both
            count = len(chart.y) * (1 if chart.kind == "roc" else max(1, len(chart.parts)))
            if chart.names and len(chart.names) != count:
                raise ScenarioError(f"`{where}.names` has {len(chart.names)} names for {count} lines")
            if chart.kind == "array":
                for name in (chart.x, *chart.y):
                    if not numbered(name, columns):
                        raise ScenarioError(
                            f"`{where}` names `{name}[1]`, which is no column", closest(name, columns)
                        )
                continue
            for text in filter(None, (chart.x, *chart.y, *chart.parts, chart.split, chart.weight)):
                Expression(text, columns, f"`{where}`")


def numbered(name: str, columns: Iterable[str]) -> list[str]:
    """Columns `name[1]`, `name[2]`, ... in their order."""
    found = [
        (int(match[1]), one)
        for one in columns
        if (match := re.fullmatch(rf"{re.escape(name)}\[(\d+)\]", one))
    ]
    return [one for _, one in sorted(found)]
