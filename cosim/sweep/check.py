"""A scenario or study looked at without a run: everything that can be known before the first step."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from cosim import paths
from cosim.errors import CosimError
from cosim.loop import lint
from cosim.loop.session import Session
from cosim.scenario.load import load
from cosim.scenario.model import Scenario
from cosim.scenario.toml import parse_file
from cosim.sweep import study
from cosim.sweep.plan import Plan


@dataclass
class Checked:
    """What was found in one file.

    Parameters
    ----------
    name
        As it was asked for.
    kind
        What it is.
    error
        Why it cannot run, None if it can.
    warnings
        What is no error but seldom meant.
    runs
        Runs that it makes.
    """

    name: str
    kind: Literal["scenario", "study", "optimization"] = "scenario"
    error: CosimError | None = None
    warnings: list[str] = field(default_factory=list)
    runs: int = 1

    def to_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        error = self.error and {"message": self.error.message, "hint": self.error.hint}
        return {
            "file": self.name,
            "kind": self.kind,
            "ok": self.error is None,
            "runs": self.runs,
            "error": error,
            "warnings": self.warnings,
        }


def check(name: str) -> Checked:
    """Check a scenario, by name or file, or the file of a study; errors are found, not raised."""
    found = Checked(name)
    try:
        file = file_of(name)
        if is_study(file):
            found.kind = "study"
            found.warnings = check_study(file, found)
        else:
            found.warnings = check_scenario(load(name))
    except CosimError as error:
        found.error, found.runs = error, 0
    return found


def file_of(name: str) -> Path:
    """File of a scenario, by name or path, or of a study."""
    file = Path(name).expanduser()
    if file.is_file():
        return file
    if Path(name).parts[:1] == (paths.OWN_STUDIES.name,):
        return paths.find_study(name)
    return paths.find_scenario(name)


def is_study(file: Path) -> bool:
    """Whether a file names a scenario that it varies, which no scenario does."""
    return not {"scenario", "design"}.isdisjoint(parse_file(file))


def check_scenario(scenario: Scenario) -> list[str]:
    """Open FMU and plant and connect them; returns warnings."""
    with Session(scenario) as session:
        return lint.check(session)


def check_study(file: Path, found: Checked) -> list[str]:
    """Check every case of a study, and the wires of the scenario that it varies; returns warnings."""
    plan = Plan(study.load(file))
    found.runs = len(plan.runs)
    return check_scenario(plan.job(plan.runs[0]).scenario)
