"""The baseline of a scenario: the trace of an accepted run, in a file next to the scenario."""

from __future__ import annotations

from pathlib import Path

from cosim import paths
from cosim.compare import traces
from cosim.compare.comparison import Comparison
from cosim.compare.tolerance import Tolerances
from cosim.errors import CosimError
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.result import Result
from cosim.pool.runs import run
from cosim.scenario.model import Scenario
from cosim.trace.files import read
from cosim.trace.stored import StoredTrace

ENDING = ".baseline.npz"


def file_of(scenario: Scenario) -> Path:
    """File of a scenario's baseline: `dob.toml` has `dob.baseline.npz`."""
    return scenario.file.with_suffix(ENDING)


def stored(scenario: Scenario) -> StoredTrace:
    """Baseline of a scenario; without one, the error names the command that writes it."""
    file = file_of(scenario)
    if not file.exists():
        is_listed = dict(paths.list_scenarios()).get(scenario.name) == paths.resolved(scenario.file)
        name = scenario.name if is_listed else paths.shown(scenario.file)
        hint = f"Write it with `cosim compare {name} --update`."
        raise CosimError(f"there is no baseline `{paths.shown(file)}`", hint)
    return read(file)


def compare(scenario: Scenario, allowed: Tolerances, engine: Engine, progress: Progress | None) -> Comparison:
    """Run a scenario and compare its trace with the baseline."""
    before = stored(scenario)
    result = run(scenario, progress=progress, engine=engine, isolated=True)
    now = StoredTrace(Path(), result.columns, result.units, result.items)
    names = paths.shown(before.file), f"{result.scenario}, seed {result.seed}"
    return traces.compare(before, now, allowed, names)


def update(scenario: Scenario, engine: Engine, progress: Progress | None) -> Result:
    """Run a scenario and write its baseline; after an error the previous one stays."""
    file = file_of(scenario)
    if file.is_dir():
        raise CosimError(f"cannot write `{paths.shown(file)}`: it is a folder")
    result = run(scenario, progress=progress, engine=engine, isolated=True)
    if result.passed is False:
        failed = ", ".join(f"`{held.criterion.id}`" for held in result.criteria if not held.passed)
        raise CosimError(
            f"a run that fails {failed} cannot be the baseline", "Show the measured values with `cosim run`."
        )
    result.save_trace(file)
    return result
