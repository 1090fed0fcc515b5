"""Check of a file of any kind without a run."""

from __future__ import annotations

from pathlib import Path

from cosim.errors import CosimError
from cosim.loop.place import Place
from cosim.optimize import problem
from cosim.optimize.variants import Variants
from cosim.scenario.checked import Checked
from cosim.scenario.kinds import kind_of
from cosim.scenario.toml import parse_file
from cosim.sweep import check as others


def check(name: str, place: Place | None = None) -> Checked:
    """Check a scenario, by name or file, a study or an optimization; errors are found, not raised.

    `place` records whose code runs.
    """
    found = Checked(name)
    try:
        file = others.file_of(name)
        if kind_of(parse_file(file)) != "optimization":
            return others.check(name, place)
        found.kind = "optimization"
        found.warnings = check_optimization(file, found, place)
    except CosimError as error:
        found.error, found.runs = error, 0
    return found


def check_optimization(file: Path, found: Checked, place: Place | None) -> list[str]:
    """Check an optimization at both ends of its ranges, and the wires of its scenario; returns warnings."""
    variants = Variants(problem.load(file))
    found.runs = variants.problem.search.trials * len(variants.seeds)
    return others.check_scenario(variants.scenario, place)
