"""One scenario with varied keys, and its runs."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cosim import paths
from cosim.errors import ScenarioError, closest, concerning
from cosim.fmu import stale
from cosim.fmu.description import FmuFile
from cosim.fmu.values import expand
from cosim.loop import fmus, plant, time_series
from cosim.loop.engines import Engine
from cosim.loop.session import located
from cosim.pool.job import Job
from cosim.scenario import overrides
from cosim.scenario.model import Scenario
from cosim.scenario.toml import toml_value
from cosim.study.parameters import VariedScenario
from cosim.study.run_hash import digest, plant_of, project, section, total


@dataclass(frozen=True, slots=True)
class Run:
    """One run: its number and that of its case, both from 0, and the values of the varied keys.

    `hash` is the SHA-256, in hexadecimal, of everything that affects its results.
    """

    number: int
    case: int
    seed: int
    changes: dict[str, Any] = field(compare=False)
    hash: str


class Variation:
    """The scenario of a study or an optimization, to be merged with values of its keys."""

    def __init__(self, varied: VariedScenario) -> None:
        self.varied = varied
        self.origin = f"`{paths.shown(varied.file)}`"
        self.is_file = varied.scenario.endswith(".toml")
        folder = varied.file.parent if self.is_file else None
        self.file = paths.find_scenario(varied.scenario, folder).resolve()
        self.name = paths.scenario_name(self.file)
        self.base = overrides.read(self.file)
        for key, value in varied.set.items():
            overrides.assign(self.base, key, value, f"{self.origin}, `set.{key}`")
        self.totals = {name: total(section(name, part)) for name, part in self.base.table.items()}
        # the files of a plant may have changed since the last study
        plant_of.cache_clear()

    def merged(self, values: Mapping[str, Any], where: str = "") -> overrides.Overrides:
        """Merge the tables with values; `where` is their origin, by default the value itself."""
        merged = self.base.copy()
        for key, value in values.items():
            overrides.assign(merged, key, value, f"{self.origin}, {where or f'`{key}` = `{value}`'}")
        return merged

    def check_metric(self, key: str, name: str, scenario: Scenario) -> None:
        """Check that a key names a metric of the scenario, or none."""
        names = [metric.name for metric in scenario.metric]
        if name and name not in names:
            problem = f"{self.origin}: `{key}` = `{name}` is not a metric of the scenario"
            raise ScenarioError(problem, closest(name, names))

    def command(self, values: Mapping[str, Any], seed: int) -> str:
        """Command line that repeats a run from the current working directory."""
        scenario = paths.shown(self.file) if self.is_file else self.varied.scenario
        changes = {**self.varied.set, **values}
        options = [f"--set {shlex.quote(f'{key}={text(value)}')}" for key, value in changes.items()]
        return " ".join(["cosim run", shlex.quote(scenario), *options, f"--seed {seed}"])


def job_of(scenario: Scenario, run: Run, engine: Engine, keep_trace: bool) -> Job:
    """Job of a run, with the hashes of its FMUs."""
    fmus = (paths.find_fmu(choice.fmu, scenario.folder) for choice in scenario.fmus)
    return Job(scenario, run.seed, engine, keep_trace, tuple(map(digest, fmus)))


def dependencies(scenario: Scenario, files: Mapping[str, FmuFile], plant_hash: str) -> dict[str, str]:
    """Hashes of everything that affects the results of a run, except the values of its scenario."""
    signals = {f"signal.{to}": digest(path) for to, path in time_series.files(scenario).items()}
    digests = {f"fmu.{name}": digest(file.path) for name, file in files.items()}
    return {**project(), **signals, **digests, "plant": plant_hash}


def text(value: Any) -> str:
    """Value as `--set` reads it."""
    if isinstance(value, list | tuple):
        return f"[{', '.join(json.dumps(item) if isinstance(item, str) else text(item) for item in value)}]"
    bare = isinstance(value, float) or (isinstance(value, str) and toml_value(value, "") == value)
    return str(value) if bare else json.dumps(value)


def check(scenario: Scenario) -> tuple[dict[str, FmuFile], Any, str]:
    """Check names, types and ranges of all parameters; returns the FMUs, the plant's class and its hash."""
    with located(scenario):
        files = fmus.open_files(scenario)
        stale.warn_of(scenario.fmus, scenario.folder)
        for choice in scenario.fmus:
            with concerning(f"{choice.name}.parameters"):
                expand(files[choice.name].variables, choice.parameters, choice)
        with concerning("plant.name"):
            kind, found = plant_of(scenario.plant.name, scenario.folder)
        plant.check_parameters(kind, scenario.plant.parameters)
    return files, kind, found
