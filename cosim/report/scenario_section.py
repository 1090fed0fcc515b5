"""The section of one scenario in a report, as plain data."""

from __future__ import annotations

import dataclasses
import math
import re
import shlex
from typing import TYPE_CHECKING, Any

from cosim import paths
from cosim.errors import ExpressionError
from cosim.formatting.quantity import text
from cosim.formatting.verdicts import counted, row
from cosim.loop.result import Result
from cosim.metrics.criteria import Verdict
from cosim.report import charts, drawing
from cosim.report.page import SOURCES, Section, paragraphs
from cosim.scenario.model import Scenario
from cosim.scenario.tables import toml_key
from cosim.show import plot
from cosim.show.display import injection_text, shorten
from cosim.show.plot import PlotView
from cosim.trace.columns import thinned
from cosim.units import conversion

if TYPE_CHECKING:
    from cosim.loop.session import Session

DIGITS = 3
"""Digits of measured values, as in the table of `cosim test`."""
NUMBER = re.compile(
    r"(?<![\w.])([-+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?)\s*((?!to\b)[A-Za-z%](?:[\w/.%]*[\w%])?)?"
)
RANGE = re.compile(r"\s*(?:to|-|\.\.)\s*")
"""Text between two numbers with a common unit."""


def describe(scenario: Scenario, result: Result, session: Session) -> Section:
    """Describe one run; a chart or zoom that cannot be made is replaced by a note."""
    drawn, undrawn = charts.of_run(scenario, result)
    try:
        views = plot.views(scenario, result)
    except ExpressionError as error:
        undrawn.append(str(error))
        without_zoom = dataclasses.replace(scenario.plot, zoom="")
        views = plot.views(dataclasses.replace(scenario, plot=without_zoom), result)
    return {
        "name": result.scenario,
        "loop": result.loop,
        "title": result.title,
        "description": paragraphs(scenario.description),
        "command": command(scenario, result.seed),
        "seed": result.seed,
        "simulated": text(result.simulated_s, "s"),
        "plant": scenario.plant.name,
        "fmus": [{"name": fmu.file.path.name, "guid": fmu.file.guid} for fmu in session.fmus],
        "claims": claims(result),
        "metrics": [
            {"name": one.name, "value": text(one.value, one.unit), "description": one.description}
            for one in result.metrics.values()
        ],
        "settings": settings(scenario, session),
        "injected": [f"{entry.to}: {injection_text(entry)}" for entry in scenario.inject],
        "verdict": counted(result.criteria),
        "passed": result.passed,
        "charts": [chart.packed() for chart in drawn],
        "views": [packed(view) for view in views if view.panels],
        "drawings": [drawing.charts(drawn), drawing.views(views)],
        "undrawn": undrawn,
        "video": None,
        "picture": None,
        "no_video": "",
    }


def packed(view: PlotView) -> dict[str, Any]:
    """Plain data of a view for the script of the page."""
    panels = []
    for panel in view.panels:
        values = [charts.packed_values(thinned(curve.values), panel.log) for curve in panel.curves]
        pairs = zip(panel.curves, values, strict=True)
        curves = [{"name": curve.name, "stepped": curve.stepped, **packed} for curve, packed in pairs]
        panels.append({**vars(panel), "curves": curves})
    return {**vars(view), "panels": panels}


def command(scenario: Scenario, seed: int) -> str:
    """Command that reproduces the results."""
    known = {name for name, _ in paths.list_scenarios()}
    given = scenario.name if scenario.name in known else paths.shown(scenario.file)
    return f"cosim run {shlex.quote(given)} --seed {seed}"


def claims(result: Result) -> list[dict[str, Any]]:
    """Return claims, measured values and limits."""
    found = []
    for verdict in result.criteria:
        claim, paper, measured, limit, _ = row(verdict, DIGITS)
        texts = {"claim": claim, "paper": paper, "measured": measured, "limit": limit}
        facts = {"id": verdict.criterion.id, "passed": verdict.passed, "number": not verdict.logical}
        source = origin(verdict)
        found.append({**texts, **facts, "origin": source, "source": SOURCES[source]})
    return found


def settings(scenario: Scenario, session: Session) -> list[dict[str, str]]:
    """Return the settings of a scenario for loop, FMUs and plant, with unit and description."""
    loop = scenario.loop
    found: list[tuple[str, Any, str, str]] = [
        ("loop.step", loop.step, "s", "Communication step"),
        ("loop.substeps", loop.substeps, "", "Plant steps per communication step"),
        ("loop.compute_delay", loop.compute_delay, "", "Delay of commands, steps"),
    ]
    for choice, fmu in zip(scenario.fmus, session.fmus, strict=True):
        for name, value in choice.parameters.items():
            known = fmu.file.variables.get(name)
            labels = (known.unit, known.description) if known else ("", "")
            found.append((f"{choice.name}.{name}", value, *labels))
    if scenario.plant.name:
        kind: Any = type(session.plant)
        fields = {toml_key(field): field.metadata for field in dataclasses.fields(kind.Parameters)}
        for name, value in scenario.plant.parameters.items():
            unit, description = (str(fields[name].get(key, "")) for key in ("unit", "description"))
            found.append((f"plant.{name}", value, unit, description))
    return [
        {"name": name, "value": shorten(value), "unit": unit, "description": description}
        for name, value, unit, description in found
    ]


def origin(verdict: Verdict) -> str:
    """Key of `SOURCES`: `source` of the criterion, otherwise derived from the text of the paper.

    Without both it is a choice. From the paper are a claim that is true or false, a limit with a number of
    the paper, and limits around such a number. Another number is a prediction of the models.
    """
    criterion = verdict.criterion
    if criterion.source or not criterion.paper:
        return criterion.source or "choice"
    if isinstance(criterion.equals, bool):
        return "paper"
    published = numbers(criterion.paper, verdict.unit)
    limits = [limit for _, limit in verdict.limits]
    same = any(math.isclose(number, limit, rel_tol=1e-9) for number in published for limit in limits)
    around = len(limits) == 2 and any(limits[0] <= number <= limits[1] for number in published)
    return "paper" if same or around else "prediction"


def numbers(words: str, unit: str) -> list[float]:
    """Find the numbers of a text that convert to a unit; in `50 to 60 mm/s` both are in mm/s."""
    found, behind, begin = [], "", len(words)
    for number in reversed([*NUMBER.finditer(words)]):
        digits, own = number[1], number[2] or ""
        if not own and RANGE.fullmatch(words, number.end(), begin):
            own = behind
        converted = conversion(own or "1", unit or "1")
        if converted is not None:
            found.append(converted(float(digits.replace(",", ""))))
        behind, begin = own, number.start()
    return found[::-1]
