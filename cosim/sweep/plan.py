"""The runs of a study: all of them are checked, and get their seed and hash, before the first begins."""

from __future__ import annotations

import functools
import hashlib
import importlib
import importlib.metadata
import json
import shlex
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cosim import paths
from cosim.errors import ScenarioError, closest, concerning
from cosim.fmu import stale
from cosim.fmu.archive import FmuFile, open_fmu
from cosim.fmu.values import expand
from cosim.loop import course, plant
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.session import located
from cosim.scenario import layers
from cosim.scenario.load import build
from cosim.scenario.model import Scenario
from cosim.sweep.designs import DESIGNS, Case
from cosim.sweep.study import Study
from cosim.sweep.worker import Job

PRESENTATION = ("title", "description", "plot")
"""Parts of a scenario that change no number."""
PACKAGES = ("machining-fmus", "mujoco-core", "fmpy", "numpy")
"""Their versions are part of every hash."""
PLANT_FILES = (".py", ".xml", ".so", ".pyd")
"""Files of the package `plants` that make its plants."""


@dataclass(frozen=True, eq=False)
class Run:
    """One run of a study.

    Parameters
    ----------
    number, case
        Number of the run, and of its case in the design; both from 0.
    changes
        Keys that the design varies, with their values.
    hash
        SHA-256, in hexadecimal, of everything that its numbers depend on.
    """

    number: int
    case: int
    seed: int
    changes: Case
    hash: str


class Plan:
    """All runs of a study.

    Raises
    ------
    CosimError
        A key, a value, the scenario or the FMU of any run is wrong; names study and case.
    """

    def __init__(self, study: Study, engine: Engine = "native", progress: Progress | None = None) -> None:
        self.study = study
        self.engine = engine
        self.origin = f"`{paths.shown(study.file)}`"
        near = study.file.parent if study.scenario.endswith(".toml") else None
        self.file = paths.find_scenario(study.scenario, near).resolve()
        self.name = paths.scenario_name(self.file)
        self.base = layers.read(self.file)
        for key, value in study.set.items():
            layers.assign(self.base, key, value, f"{self.origin}, `set.{key}`")
        cases = study.case
        if study.design.kind != "list":
            cases = tuple(DESIGNS[study.design.kind](study.vary, study.design.samples or 0, study.seed))
        self.runs: list[Run] = []
        for index, case in enumerate(cases):
            self.runs += self.runs_of(index, case)
            if progress is not None:
                progress(index + 1, len(cases))

    def runs_of(self, index: int, case: Case) -> Iterator[Run]:
        """Check one case and make its runs."""
        merged = self.merged(case, index)
        scenario = self.build(merged)
        fmu, made = check(scenario)
        if (metric := self.study.traces.metric) and metric not in (
            names := [m.name for m in scenario.metric]
        ):
            problem = f"{self.origin}: `traces.metric` is `{metric}`, there is no such metric"
            raise ScenarioError(problem, closest(metric, names))
        kept = {name: part for name, part in merged.table.items() if name not in PRESENTATION}
        identity = {"versions": versions(), "fmu": digest(fmu.path), "plant": made, "scenario": kept}
        identity |= {f"signal.{to}": digest(file) for to, file in course.files(scenario).items()}
        for repeat in range(self.study.design.repeats):
            number = index * self.study.design.repeats + repeat
            seed = self.seed(number, repeat, merged)
            text = json.dumps({**identity, "seed": seed}, sort_keys=True, default=str)
            yield Run(number, index, seed, case, hashlib.sha256(text.encode()).hexdigest()[:32])

    def merged(self, case: Case, index: int) -> layers.Layers:
        """Layers of one case."""
        merged = layers.Layers(dict(self.base.table), dict(self.base.origins), self.base.files)
        for key, value in case.items():
            layers.assign(merged, key, value, f"{self.origin}, case {index}")
        return merged

    def build(self, merged: layers.Layers) -> Scenario:
        """Scenario of one case."""
        return replace(build(merged), name=self.name, file=self.file)

    def seed(self, number: int, repeat: int, merged: layers.Layers) -> int:
        """Seed of one run: by its number, never by the order in which runs are done."""
        design = self.study.design
        if merged.origins.get("loop.seed", "").startswith(self.origin):
            return int(merged.table["loop"]["seed"]) + repeat
        index = repeat if design.seeds == "repeat" else number
        sequence = np.random.SeedSequence(self.study.seed, spawn_key=(index,))
        # 53 bits are exact in JSON and in a spreadsheet
        return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(11))

    def job(self, run: Run, keep_trace: bool = False) -> Job:
        """Job of one run."""
        scenario = self.build(self.merged(run.changes, run.case))
        fmu = paths.find_fmu(scenario.controller.fmu, scenario.folder)
        return Job(scenario, run.seed, self.engine, keep_trace, digest(fmu))

    def command(self, run: Run) -> str:
        """Command line that repeats a run."""
        changes = {**self.study.set, **run.changes}
        options = [shlex.quote(f"{key}={text(value)}") for key, value in changes.items()]
        words = ["cosim run", shlex.quote(self.study.scenario), *(f"--set {option}" for option in options)]
        return " ".join([*words, f"--seed {run.seed}"])


def text(value: Any) -> str:
    """Value as `--set` reads it."""
    if isinstance(value, float | str):
        return str(value)
    return json.dumps(value)


def check(scenario: Scenario) -> tuple[FmuFile, str]:
    """Check names, types and ranges of all parameters without running; returns the FMU and the plant's hash.

    Raises
    ------
    CosimError
        What the run would refuse.
    """
    with located(scenario):
        with concerning("controller.fmu"):
            file = open_fmu(paths.find_fmu(scenario.controller.fmu, scenario.folder))
            stale.warn(scenario.controller.fmu, file.path)
        with concerning("controller.parameters"):
            expand(file.variables, scenario.controller.parameters)
        with concerning("plant.name"):
            kind, found = plant_of(scenario.plant.name, scenario.folder)
        plant.check_parameters(kind, scenario.plant.parameters)
    return file, found


@functools.cache
def digest(path: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


@functools.cache
def plant_of(name: str, folder: Path) -> tuple[Any, str]:
    """Class of a plant and the SHA-256 of what it is made of."""
    kind = plant.plant_class(name, folder)
    parts = [digest(file) for file in sources(kind)]
    if name.endswith(plant.MJCF):
        # files that the MJCF includes and meshes count as well
        parts.append(importlib.import_module("plants.bare").fingerprint(kind.file))
    return kind, hashlib.sha256("".join(parts).encode()).hexdigest()


def sources(kind: Any) -> list[Path]:
    """Files of a plant's class and its bases; all of the package `plants` where one of them is in it."""
    modules = [sys.modules.get(base.__module__) for base in kind.__mro__]
    files = {Path(file) for module in modules if (file := getattr(module, "__file__", None))}
    if any(base.__module__.partition(".")[0] == "plants" for base in kind.__mro__):
        (folder,) = importlib.import_module("plants").__path__
        files |= {file for file in Path(folder).rglob("*") if file.suffix in PLANT_FILES}
    # by name, then folder: wherever the package lies
    return sorted(files, key=lambda file: file.parts[::-1])


@functools.cache
def versions() -> dict[str, str]:
    """Versions of what computes the numbers."""
    found = {}
    for name in PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = ""
    return found
