"""Check of a scenario or study before the first step."""

from __future__ import annotations

from pathlib import Path

from cosim import paths
from cosim.errors import CosimError, ScenarioError
from cosim.loop import lint
from cosim.loop.place import Place
from cosim.loop.session import Session
from cosim.metrics import drawable
from cosim.scenario.checked import Checked
from cosim.scenario.kinds import kind_of
from cosim.scenario.load import load
from cosim.scenario.model import Scenario
from cosim.scenario.toml import parse_file
from cosim.sweep import study
from cosim.sweep.plan import Plan
from cosim.sweep.summary import columns

OF_A_TRACE = ("bode", "field", "spectrum")
"""Kinds of charts that need the rows of one run."""


def check(name: str, place: Place | None = None) -> Checked:
    """Check a scenario, by name or file, or the file of a study; errors are found, not raised.

    `place` records whose code runs.
    """
    found = Checked(name)
    try:
        file = file_of(name)
        if kind_of(parse_file(file)) == "study":
            found.kind = "study"
            found.warnings = check_study(file, found, place)
        else:
            found.warnings = check_scenario(load(name), place)
    except CosimError as error:
        found.error, found.runs = error, 0
    return found


def check_charts(plan: Plan) -> None:
    """Check that the charts of a study can be made from its results.

    Raises
    ------
    CosimError
        As for `drawable.check`; or a chart needs the rows of one run.
    """
    origin, charts = f"`{paths.shown(plan.study.file)}`", plan.study.charts
    for index, chart in enumerate(charts):
        if chart.kind in OF_A_TRACE:
            problem = f"{origin}: `charts[{index}]` of the kind `{chart.kind}` needs the rows of one run"
            raise ScenarioError(problem, "Move it to `[[plot.charts]]` of the scenario.")
    try:
        drawable.check_charts(charts, "charts", columns(plan.scenario, plan.cases))
    except CosimError as error:
        raise ScenarioError(f"{origin}: {error.message}", error.hint) from None


def file_of(name: str) -> Path:
    """File of a scenario, by name or path, or of a study."""
    file = paths.expanded(name)
    if paths.is_file(file):
        return file
    if Path(name).parts[:1] == (paths.OWN_STUDIES.name,):
        return paths.find_study(name)
    return paths.find_scenario(name)


def check_scenario(scenario: Scenario, place: Place | None) -> list[str]:
    """Open FMU and plant and connect them; returns warnings."""
    with Session(scenario, place=place) as session:
        return lint.check(session)


def check_study(file: Path, found: Checked, place: Place | None) -> list[str]:
    """Check every case of a study, and the wires of the scenario that it varies; returns warnings."""
    plan = Plan(study.load(file))
    check_charts(plan)
    found.runs = len(plan.runs)
    return check_scenario(plan.job(plan.runs[0]).scenario, place)
