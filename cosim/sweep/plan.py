"""The runs of a study: checked, with seed and hash, before the first run starts."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, overload

import numpy as np

from cosim.errors import CosimError
from cosim.fmu.description import FmuFile
from cosim.fmu.named import NamedFmu
from cosim.fmu.values import expand
from cosim.loop import plant
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.pool.job import Job
from cosim.scenario.load import build
from cosim.scenario.model import Criterion, Scenario
from cosim.study.run import Run, Variation, check, dependencies, job_of
from cosim.study.run_hash import finished, leaf, section, total
from cosim.sweep.designs import DESIGNS, Case, values_by_key
from cosim.sweep.study import Study

PART = re.compile(r"(\d{1,6})/(\d{1,6})")
MAX_SETTINGS = 1000
"""Maximum number of cached settings during planning."""


@dataclass(frozen=True)
class Setting:
    """Common data of runs that differ only in parameters.

    FMUs by their names, class of the plant, and the locations of the tables of both in the scenario. The
    hashes of the parameters there are `leaves`, the sum of the hashes of everything is `total`.
    """

    files: dict[str, FmuFile]
    plant: Any
    tables: dict[str, str]
    leaves: dict[str, int]
    total: int


class Plan(Variation):
    """All runs of a study, each checked, and the numbers of those in one of several parts."""

    def __init__(
        self, study: Study, engine: Engine = "native", progress: Progress | None = None, part: str = ""
    ) -> None:
        first, count = part_of(part)
        super().__init__(study)
        self.study, self.engine = study, engine
        self.scenario = replace(build(self.base), name=self.name, file=self.file)
        self.named = (*(choice.name for choice in self.scenario.fmus), "plant")
        self.settings: dict[str, Setting] = {}
        self.changed_criteria: dict[str, tuple[Criterion, ...]] = {}
        self.cases: Sequence[Case] = study.case
        if study.design.kind != "list":
            self.cases = DESIGNS[study.design.kind](study.vary, study.design.samples or 0, study.seed)
        self.varying = values_by_key(self.cases)
        self.runs = Runs(self, progress)
        self.numbers = range(first, len(self.runs), count)

    def commands(self, numbers: Iterable[int]) -> list[str]:
        """Command lines that repeat some runs."""
        return [self.command(run.changes, run.seed) for run in map(self.runs.__getitem__, numbers)]

    def different(self) -> list[int]:
        """List the numbers of the runs of this part, each hash once."""
        return list({self.runs.hash(number): number for number in self.numbers}.values())

    def admit(self, index: int) -> int:
        """Check one case; return the sum of the hashes of everything that affects its results."""
        case = self.cases[index]
        parameters = {key: value for key, value in case.items() if is_parameter(key, self.named)}
        rest = {key: value for key, value in case.items() if key not in parameters}
        name = repr(rest)
        if name not in self.settings:
            if len(self.settings) >= MAX_SETTINGS:
                self.settings.clear()
            self.settings[name] = self.setting(rest, index)
        setting = self.settings[name]
        try:
            return setting.total + sum(exchange(setting, key, value) for key, value in parameters.items())
        except CosimError:
            # the same with all origins, so that the error names the origin of the value
            check(self.built(case, index))
            raise

    def setting(self, changes: Case, index: int) -> Setting:
        """Check a case without its varied parameters."""
        merged = self.merged(changes, f"case {index}")
        scenario = build(merged, (self.base, self.scenario))
        files, kind, made = check(scenario)
        self.check_metric("traces.metric", self.study.traces.metric, scenario)
        summed = total(dependencies(scenario, files, made))
        for name, part in merged.table.items():
            same = part is self.base.table.get(name)
            summed += self.totals[name] if same else total(section(name, part))
        parts = {name: merged.table.get(name, {}) for name in ("controller", "fmu", "plant")}
        leaves = {
            key: leaf(key, value)
            for name, part in parts.items()
            for key, value in section(name, part).items()
        }
        tables = {"controller": "controller", "plant": "plant"}
        tables |= {choice.name: f"fmu[{index}]" for index, choice in enumerate(scenario.fmu)}
        return Setting(files, kind, tables, leaves, summed)

    def built(self, values: Case, index: int) -> Scenario:
        """Scenario of one case."""
        return build(self.merged(values, f"case {index}"), (self.base, self.scenario))

    def criteria(self, run: Run) -> tuple[Criterion, ...]:
        """Criteria of a run: those of the scenario, unless its case changes them."""
        changes = {key: value for key, value in run.changes.items() if key.startswith("criterion.")}
        name = repr(changes)
        if name not in self.changed_criteria:
            found = self.built(changes, run.case) if changes else self.scenario
            self.changed_criteria[name] = found.criterion
        return self.changed_criteria[name]

    def seed(self, number: int) -> int:
        """Seed of one run: from its number, independent of the order of execution."""
        design = self.study.design
        index, repeat = divmod(number, design.repeats)
        given = self.cases[index].get("loop.seed", self.study.set.get("loop.seed"))
        if given is not None:
            return int(given) + repeat
        key = repeat if design.seeds == "repeat" else number
        sequence = np.random.SeedSequence(self.study.seed, spawn_key=(key,))
        # 53 bits are exact in JSON and in a spreadsheet
        return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(11))

    def job(self, run: Run, keep_trace: bool = False) -> Job:
        """Job of one run."""
        return job_of(self.built(run.changes, run.case), run, self.engine, keep_trace)


def part_of(text: str) -> tuple[int, int]:
    """First number of a part such as `2/8`, and the distance between its numbers; all without a text."""
    found = PART.fullmatch(text or "1/1")
    if found is None or not 1 <= int(found[1]) <= int(found[2]):
        raise CosimError(f"`--part` is `{text}`", "Give part and number of parts, from `1/8` to `8/8`.")
    return int(found[1]) - 1, int(found[2])


class Runs(Sequence[Run]):
    """The runs of a plan, created on demand; only their seeds and hashes are stored."""

    def __init__(self, plan: Plan, progress: Progress | None = None) -> None:
        self.cases, self.repeats = plan.cases, plan.study.design.repeats
        count = len(plan.cases) * self.repeats
        self.seeds = np.empty(count, np.uint64)
        self.hashes = bytearray()
        for number in range(count):
            index, repeat = divmod(number, self.repeats)
            if repeat == 0:
                summed = plan.admit(index)
            seed = plan.seed(number)
            self.seeds[number] = seed
            self.hashes += finished(summed, seed)
            if progress is not None:
                progress(number + 1, count)

    def __len__(self) -> int:
        return self.seeds.size

    @overload
    def __getitem__(self, number: int) -> Run: ...
    @overload
    def __getitem__(self, number: slice) -> list[Run]: ...
    def __getitem__(self, number: int | slice) -> Run | list[Run]:
        if isinstance(number, slice):
            return [self[index] for index in range(len(self))[number]]
        number = range(len(self))[number]
        case = number // self.repeats
        return Run(number, case, int(self.seeds[number]), self.cases[case], self.hash(number))

    def hash(self, number: int) -> str:
        """Hash of a run, in hexadecimal."""
        return self.hashes[16 * number : 16 * number + 16].hex()


@functools.lru_cache(1000)
def is_parameter(key: str, names: tuple[str, ...]) -> bool:
    """Whether a key of a scenario is a parameter of the plant or of a named FMU."""
    part, _, name = key.partition(".")
    return part in names and name not in (("name",) if part == "plant" else ("fmu", "step"))


def exchange(setting: Setting, key: str, value: Any) -> int:
    """Check the value of a parameter; return its change of the sum of hashes."""
    part, _, name = key.partition(".")
    name = name.removeprefix("parameters.")
    if part == "plant":
        plant.check_parameter(setting.plant, name, value)
    else:
        owner = NamedFmu(part, "", alone=setting.tables[part] == "controller")
        expand(setting.files[part].variables, {name: value}, owner)
    location = f"{setting.tables[part]}.parameters.{name}"
    return leaf(location, value) - setting.leaves.get(location, 0)
