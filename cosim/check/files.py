"""Check of a scenario, study or optimization before the first step."""

from __future__ import annotations

from pathlib import Path

from cosim import paths
from cosim.check import lint
from cosim.check.checked import Checked
from cosim.errors import CosimError
from cosim.loop.position import Position
from cosim.loop.session import Session
from cosim.optimize import problem
from cosim.optimize.variants import Variants
from cosim.scenario.kinds import kind_of
from cosim.scenario.load import load
from cosim.scenario.model import Scenario
from cosim.scenario.toml import parse_file
from cosim.sweep import study
from cosim.sweep.charts import check_charts
from cosim.sweep.plan import Plan


def check(name: str, position: Position | None = None) -> Checked:
    """Check a scenario, by name or file, a study or an optimization; errors are found, not raised.

    `position` records whose code runs.
    """
    found = Checked(name)
    try:
        file = file_of(name)
        found.kind = kind_of(parse_file(file)) or "scenario"
        match found.kind:
            case "scenario":
                scenario = load(name)
            case "study":
                scenario = check_study(file, found)
            case "optimization":
                scenario = check_optimization(file, found)
        found.warnings = check_scenario(scenario, position)
    except CosimError as error:
        found.error, found.runs = error, 0
    return found


def file_of(name: str) -> Path:
    """File of a scenario, by name or path, or of a study."""
    file = paths.expanded(name)
    if paths.is_file(file):
        return file
    if Path(name).parts[:1] == (paths.OWN_STUDIES.name,):
        return paths.find_study(name)
    return paths.find_scenario(name)


def check_scenario(scenario: Scenario, position: Position | None) -> list[str]:
    """Open FMU and plant and connect them; returns warnings."""
    with Session(scenario, position=position) as session:
        return lint.check(session)


def check_study(file: Path, found: Checked) -> Scenario:
    """Check every case of a study; returns the scenario of the first run."""
    plan = Plan(study.load(file))
    check_charts(plan)
    found.runs = len(plan.runs)
    return plan.job(plan.runs[0]).scenario


def check_optimization(file: Path, found: Checked) -> Scenario:
    """Check an optimization at both ends of its ranges; returns the scenario at the first."""
    variants = Variants(problem.load(file))
    found.runs = variants.problem.search.trials * len(variants.seeds)
    return variants.scenario
