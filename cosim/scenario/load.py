"""Loading of scenarios: merges the TOML files, makes a `Scenario` and checks it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from cosim import paths
from cosim.errors import ScenarioError
from cosim.scenario import checks, overrides
from cosim.scenario.assignment import Assignment
from cosim.scenario.model import Scenario
from cosim.scenario.overrides import Overrides
from cosim.scenario.tables import parse, parse_value


def load(name_or_path: str | Path, set: str | Sequence[str | Assignment] = ()) -> Scenario:  # noqa: A002
    """Load a scenario by name (`dob`, `dob/paper`) or from a file (`my.toml`).

    Parameters
    ----------
    name_or_path
        Name of a scenario in one of the scenario folders, or path of a TOML file.
    set
        Overrides `KEY=VALUE`, one or several, see `cosim.scenario.overrides.override`.

    Raises
    ------
    ScenarioError
        Missing or broken file, unknown key, wrong type, contradictory values; names file and key.
    """
    file = paths.find_scenario(str(name_or_path))
    merged = overrides.read(file)
    if isinstance(set, Mapping) or not all(isinstance(entry, str | Assignment) for entry in set):
        hint = 'Use, for example, `set=["loop.seed=1"]`.'
        raise ScenarioError(f"`set` is `{set!r}`, it must hold texts", hint)
    overrides.override(merged, [set] if isinstance(set, str) else set)
    return replace(build(merged), name=paths.scenario_name(file), file=file.resolve())


def build(merged: Overrides, before: tuple[Overrides, Scenario] | None = None) -> Scenario:
    """Scenario of merged tables; parts that other merged tables have in common are taken from their scenario.

    The caller sets name and file.
    """
    if before is None:
        scenario = parse(Scenario, merged.table, "", merged.fail)
    else:
        known, scenario = before
        changed = {key: value for key, value in merged.table.items() if value is not known.table.get(key)}
        read = {key: parse_value(Scenario, key, value, "", merged.fail) for key, value in changed.items()}
        scenario = replace(scenario, **read)
    checks.check(scenario, merged)
    return replace(scenario, origins=merged.origins)
