"""The search: points are proposed in batches, run, and told, until all trials are done.

Every proposal follows from the seed and the trials of earlier batches alone, never from the order in which
runs end. A search that was interrupted therefore proposes the same points again, finds the rows of those that
were run, and goes on; the rows are the only state.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from cosim import paths
from cosim.errors import CosimError, ScenarioError, closest
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.result import Result, plain
from cosim.loop.wiring import child
from cosim.optimize.objective import MISFIT, Score, measured, misfit, score
from cosim.optimize.problem import Problem
from cosim.scenario import layers
from cosim.scenario.load import build
from cosim.scenario.model import Scenario
from cosim.sweep.designs import value_at
from cosim.sweep.many import run_each
from cosim.sweep.plan import PRESENTATION, Run, check, digest, versions
from cosim.sweep.store import Store, row_of
from cosim.sweep.study import Vary

Values = dict[str, Any]
"""Keys with their values."""


@dataclass(frozen=True)
class Trial:
    """One point: its number from 0, its values, and what it is worth."""

    number: int
    values: Values
    score: Score


class Variants:
    """The scenario of a problem with any values of its keys.

    Raises
    ------
    CosimError
        A key or an end of a range is wrong, the scenario has no such metric, or the measured trace is wrong.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.origin = f"`{paths.shown(problem.file)}`"
        near = problem.file.parent if problem.scenario.endswith(".toml") else None
        self.file = paths.find_scenario(problem.scenario, near).resolve()
        self.base = layers.read(self.file)
        for key, value in problem.set.items():
            layers.assign(self.base, key, value, f"{self.origin}, `set.{key}`")
        first, last = ({vary.key: value_at(vary, end) for vary in problem.vary} for end in (0.0, 1.0))
        self.scenario = self.at(first)
        fmu, plant = check(self.scenario)
        check(self.at(last))
        metric, names = problem.objective.metric, [entry.name for entry in self.scenario.metric]
        if metric and metric not in names:
            text = f"{self.origin}: `objective.metric` is `{metric}`, there is no such metric"
            raise ScenarioError(text, closest(metric, names))
        self.target = measured(problem, self.scenario)
        self.seeds = problem.search.seeds or (self.scenario.loop.seed,)
        kept = {name: part for name, part in self.base.table.items() if name not in PRESENTATION}
        self.identity = {
            "versions": versions(),
            "fmu": digest(fmu.path),
            "plant": plant,
            "scenario": kept,
            "target": "" if self.target is None else digest(self.target.file),
            "columns": problem.objective.columns,
        }

    def at(self, values: Values) -> Scenario:
        """Scenario with some values."""
        merged = layers.Layers(dict(self.base.table), dict(self.base.origins), self.base.files)
        for key, value in values.items():
            layers.assign(merged, key, value, f"{self.origin}, `{key}` = `{value}`")
        return replace(build(merged), name=paths.scenario_name(self.file), file=self.file)

    def runs(self, number: int, values: Values) -> list[Run]:
        """Make the runs of a trial, one for each seed."""
        found = []
        for index, seed in enumerate(self.seeds):
            text = json.dumps({**self.identity, "set": values, "seed": seed}, sort_keys=True, default=str)
            name = hashlib.sha256(text.encode()).hexdigest()[:32]
            found.append(Run(number * len(self.seeds) + index, number, seed, values, name))
        return found


@dataclass(frozen=True)
class SearchOptions:
    """How a search runs: worker processes, engine, and whether runs without a result are done again."""

    workers: int | None = None
    engine: Engine = "native"
    again: bool = False


def search(
    variants: Variants, store: Store, options: SearchOptions, progress: Progress | None = None
) -> list[Trial]:
    """Do what is left of a search; returns all trials.

    Whatever stops it, Ctrl-C included, the rows written stay, and the next call goes on from there.

    Parameters
    ----------
    variants
        The scenario with any values.
    store
        Where the rows of the runs are.
    options
        How it runs.
    progress
        Told the trials done and in all.

    Raises
    ------
    CosimError
        Optuna is not installed, or no trial of the first batch gave a number.
    """
    wanted = variants.problem.search
    proposer = Proposer(variants.problem)
    trials: list[Trial] = []
    while len(trials) < wanted.trials:
        numbers = range(len(trials), min(len(trials) + wanted.batch, wanted.trials))
        runs = [variants.runs(number, proposer.propose(number)) for number in numbers]
        do(variants, store, [run for group in runs for run in group], options)
        for group in runs:
            rows = [row for run in group if (row := store.row(run)) is not None]
            found = Trial(group[0].case, group[0].changes, score(variants.problem, variants.scenario, rows))
            proposer.tell(found)
            trials.append(found)
        if all(trial.score.value is None for trial in trials):
            reason = trials[0].score.reason
            raise CosimError(f"none of the first {len(trials)} trials gave a number; the first: {reason}")
        if progress is not None:
            progress(len(trials), wanted.trials)
    return trials


def do(variants: Variants, store: Store, runs: Sequence[Run], options: SearchOptions) -> None:
    """Do those of some runs that have no row yet, each once."""
    redone = ("", "error", "crashed", "timeout", "memory", "lost") if options.again else ("",)
    pending = list({run.hash: run for run in runs if store.status(run) in redone}.values())
    if not pending:
        return
    scenarios = []
    for run in pending:
        scenario = variants.at(run.changes)
        scenarios.append(replace(scenario, loop=replace(scenario.loop, seed=run.seed)))
    kept = variants.target is not None
    done = run_each(scenarios, options.workers, keep_trace=kept, engine=options.engine)
    for run, outcome in zip(pending, done, strict=True):
        row = row_of(run, outcome)
        if isinstance(outcome, Result) and variants.target is not None:
            distance = misfit(outcome, variants.target, variants.problem.objective.columns)
            row["metrics"] = {**row["metrics"], MISFIT: plain(distance)}
            row["units"] = {**row["units"], MISFIT: "1"}
        store.append(row)


class Proposer:
    """Points of a search by Optuna's tree-structured Parzen estimator, with constraints.

    Raises
    ------
    CosimError
        Optuna is not installed.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.optuna = imported()
        with quiet():
            self.study = self.optuna.create_study(direction=problem.objective.direction)
        self.open: dict[int, Any] = {}

    def propose(self, number: int) -> Values:
        """Values of one trial; they are to be told before the next batch."""
        # by its number: a search that is resumed draws the same
        seed = int(child(self.problem.seed, f"trial {number}").generate_state(1)[0])
        with quiet():
            self.study.sampler = self.optuna.samplers.TPESampler(seed=seed)
            trial = self.study.ask()
            self.open[number] = trial
            return {vary.key: suggested(trial, vary) for vary in self.problem.vary}

    def tell(self, done: Trial) -> None:
        """Tell what a trial is worth."""
        trial = self.open.pop(done.number)
        with quiet():
            if done.score.value is None:
                self.study.tell(trial, state=self.optuna.trial.TrialState.FAIL)
                return
            for index, violation in enumerate(done.score.violations):
                trial.set_constraint(str(index), violation)
            self.study.tell(trial, done.score.value)


def suggested(trial: Any, vary: Vary) -> Any:
    """Value of one key for a trial."""
    if vary.values:
        return trial.suggest_categorical(vary.key, vary.values)
    low, high = vary.range
    logarithmic = vary.distribution == "log-uniform"
    if vary.integer:
        return trial.suggest_int(vary.key, int(low), int(high), log=logarithmic)
    return trial.suggest_float(vary.key, low, high, log=logarithmic)


def imported() -> Any:
    """Import Optuna.

    Raises
    ------
    CosimError
        It is not installed.
    """
    try:
        optuna: Any = importlib.import_module("optuna")
    except ImportError:
        hint = "install the extra: `pip install machining-fmus[optimize]`"
        raise CosimError("Optuna is not installed, it proposes the trials", hint) from None
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return optuna


def quiet() -> Any:
    """Keep what the library says about itself out of the terminal."""
    return warnings.catch_warnings(action="ignore")


def best(problem: Problem, trials: Sequence[Trial]) -> Trial | None:
    """Best of the trials that hold all criteria, the first of equals; None if there is none."""
    sign: Callable[[float], float] = (
        (lambda v: -v) if problem.objective.direction == "maximize" else (lambda v: v)
    )
    feasible = [
        (sign(trial.score.value), trial)
        for trial in trials
        if trial.score.feasible and trial.score.value is not None
    ]
    return min(feasible, key=lambda pair: pair[0])[1] if feasible else None
