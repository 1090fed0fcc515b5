"""Comparison of two files or folders, or of a scenario with its baseline.

The baseline of a scenario is the trace of an accepted run, in a file next to the scenario.
"""

from __future__ import annotations

from pathlib import Path

from cosim import paths
from cosim.compare import metrics, traces
from cosim.compare.comparison import Comparison
from cosim.compare.tolerance import Tolerances
from cosim.errors import CosimError
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.result import Result
from cosim.pool.runs import run
from cosim.scenario.model import Scenario
from cosim.trace import endings, files
from cosim.trace.stored import StoredTrace

BASELINE = ".baseline.npz"
RESULT = ".json"
HINT = f"Give traces ({endings.listed(endings.READ)}), results (`{RESULT}`) or folders of sweeps."


def compare(reference: str, other: str, allowed: Tolerances) -> Comparison:
    """Compare two files or folders of the same kind."""
    kind, another = kind_of(reference), kind_of(other)
    if kind != another:
        problem = f"`{reference}` is a {kind} and `{other}` a {another}"
        raise CosimError(problem, "Give two files of the same kind.")
    if allowed.dt and kind != "trace":
        raise CosimError(f"`--dt` cannot be used with a {kind}", "Use `--dt` with traces only.")
    found = Comparison(f"{kind}s", reference, other, allowed)
    first, second = Path(reference), Path(other)
    if kind == "trace":
        traces.compare(found, files.read(first), files.read(second))
    elif kind == "result":
        metrics.compare_results(found, metrics.read_result(first), metrics.read_result(second))
    else:
        metrics.compare_sweeps(found, metrics.read_sweep(first), metrics.read_sweep(second))
    return found


def kind_of(name: str) -> str:
    """Kind of a file or folder."""
    path = Path(name)
    if path.is_dir():
        return "sweep"
    if path.suffix in (*endings.READ, RESULT):
        if not path.is_file():
            problem = "is not a regular file" if path.exists() else "does not exist"
            raise CosimError(f"the file `{name}` {problem}", HINT)
        return "result" if path.suffix == RESULT else "trace"
    raise CosimError(f"`{name}` cannot be compared" if path.exists() else f"`{name}` does not exist", HINT)


def compare_baseline(
    scenario: Scenario, allowed: Tolerances, engine: Engine, progress: Progress | None
) -> Comparison:
    """Run a scenario and compare its trace with the baseline."""
    file = baseline_of(scenario)
    shown = paths.shown(file)
    if not file.exists():
        is_listed = dict(paths.list_scenarios()).get(scenario.name) == paths.resolved(scenario.file)
        name = scenario.name if is_listed else paths.shown(scenario.file)
        raise CosimError(f"there is no baseline `{shown}`", f"Write it with `cosim compare {name} --update`.")
    before = files.read(file)
    result = run(scenario, progress=progress, engine=engine, isolated=True)
    now = StoredTrace(Path(), result.columns, result.units, result.items)
    found = Comparison("traces", shown, f"{result.scenario}, seed {result.seed}", allowed)
    traces.compare(found, before, now)
    return found


def update_baseline(scenario: Scenario, engine: Engine, progress: Progress | None) -> Result:
    """Run a scenario and write its baseline; after an error the previous one stays."""
    file = baseline_of(scenario)
    if file.is_dir():
        raise CosimError(f"cannot write `{paths.shown(file)}`: it is a folder")
    result = run(scenario, progress=progress, engine=engine, isolated=True)
    if result.passed is False:
        failed = ", ".join(f"`{held.criterion.id}`" for held in result.criteria if not held.passed)
        hint = "Show the measured values with `cosim run`."
        raise CosimError(f"a run that fails {failed} cannot be the baseline", hint)
    result.save_trace(file)
    return result


def baseline_of(scenario: Scenario) -> Path:
    """File of a scenario's baseline: `dob.toml` has `dob.baseline.npz`."""
    return scenario.file.with_suffix(BASELINE)
