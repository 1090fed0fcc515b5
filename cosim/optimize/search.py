"""The search: propose points in batches, run them and report their scores, until all trials are done.

Every proposal depends only on the seed and the trials of earlier batches, never on the order in which runs
end. An interrupted search therefore proposes the same points again, finds the rows of completed runs, and
continues; the rows are the only state.
"""

from __future__ import annotations

import functools
import itertools
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosim import extras, paths
from cosim.closing import Closing
from cosim.errors import CosimError, closest
from cosim.formatting.strict import plain
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.result import Result
from cosim.loop.wires.transform import child
from cosim.metrics.criteria import RELATIONS, Verdict
from cosim.optimize.problem import Problem
from cosim.optimize.variants import Variants
from cosim.pool import executor
from cosim.pool.job import Outcome
from cosim.pool.limits import processors
from cosim.scenario.model import Criterion
from cosim.study.parameters import Vary
from cosim.study.run import Run
from cosim.study.store import DONE, TROUBLES, Row, Store, row_of, verdicts
from cosim.trace.columns import interpolated
from cosim.trace.stored import StoredTrace
from cosim.warned import once

MISFIT = "misfit"
"""Metric of a calibration: mean square of all deviations, each in standard deviations of its column."""
VIOLATED = 1e-12
"""Minimum violation of a failed criterion."""


@dataclass(frozen=True)
class Score:
    """Score of a trial."""

    value: float | None
    """Mean of the objective over its runs; None if a run gave no number."""
    violations: tuple[float, ...] = ()
    """Worst violation of each criterion over the runs; above 0 if it failed."""
    reason: str = ""
    """Reason for a missing value."""

    @property
    def feasible(self) -> bool:
        """Whether it has a value and passes all criteria."""
        return self.value is not None and all(violation <= 0.0 for violation in self.violations)


@dataclass(frozen=True)
class Trial:
    """One point: its number from 0, its values and its score."""

    number: int
    values: dict[str, Any]
    score: Score


class Proposer:
    """Points of a search by Optuna's tree-structured Parzen estimator, with constraints."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        missing = "Optuna is not installed; it proposes the trials"
        self.optuna = extras.needed("optuna", missing, extras.hint("optimize"))
        self.optuna.logging.set_verbosity(self.optuna.logging.ERROR)
        with quiet():
            self.study = self.optuna.create_study(direction=problem.objective.direction)
        self.open: dict[int, Any] = {}

    def propose(self, number: int) -> dict[str, Any]:
        """Values of one trial; its score must be reported before the next batch."""
        # by its number: a search that is resumed draws the same
        seed = int(child(self.problem.seed, f"trial {number}").generate_state(1)[0])
        with quiet():
            self.study.sampler = self.optuna.samplers.TPESampler(seed=seed, constant_liar=True)
            trial = self.study.ask()
            self.open[number] = trial
            return {vary.key: suggested(trial, vary) for vary in self.problem.vary}

    def report(self, done: Trial) -> None:
        """Report the score of a trial."""
        trial = self.open.pop(done.number)
        with quiet():
            if done.score.value is None:
                self.study.tell(trial, state=self.optuna.trial.TrialState.FAIL)
                return
            for index, violation in enumerate(done.score.violations):
                trial.set_constraint(str(index), violation)
            self.study.tell(trial, done.score.value)


quiet = functools.partial(warnings.catch_warnings, action="ignore")
"""Context without the warnings of the library."""


def suggested(trial: Any, vary: Vary) -> Any:
    """Value of one key for a trial."""
    if vary.values:
        return trial.suggest_categorical(vary.key, vary.values)
    suggest, kind = (trial.suggest_int, int) if vary.integer else (trial.suggest_float, float)
    return suggest(vary.key, *map(kind, vary.range), log=vary.distribution == "log-uniform")


class Runner(Closing):
    """Executes the runs of a search on worker processes that are kept between batches."""

    def __init__(self, variants: Variants, workers: int | None, engine: Engine, again: bool) -> None:
        self.variants, self.engine = variants, engine
        self.redone = ("", *TROUBLES) if again else ("",)
        count = min(workers or processors(), variants.problem.search.batch * len(variants.seeds))
        self.jobs = executor.JobQueue()
        self.outcomes = executor.outcomes(self.jobs, count, variants.problem.limits.of_workers())

    def do(self, runs: Sequence[Run], store: Store) -> None:
        """Execute the runs without a row, each once; a row is written at the end of each run."""
        pending = list({run.hash: run for run in runs if store.status(run.hash) in self.redone}.values())
        for number, run in enumerate(pending):
            self.jobs.put((number, self.variants.job(run, self.engine)))
        for number, outcome in itertools.islice(self.outcomes, len(pending)):
            store.append(self.row(pending[number], outcome))

    def row(self, run: Run, outcome: Outcome) -> Row:
        """Row of a run; in a calibration with its distance from the measured trace."""
        row, target = row_of(run, outcome, self.variants.criteria), self.variants.target
        if isinstance(outcome, Result) and target is not None:
            distance = misfit(outcome, target, self.variants.problem.objective.columns)
            row["metrics"] = {**row["metrics"], MISFIT: plain(distance)}
            row["units"] = {**row["units"], MISFIT: "1"}
        return row

    def close(self) -> None:
        """End the worker processes."""
        self.outcomes.close()


def misfit(result: Result, target: StoredTrace, columns: Sequence[str]) -> float:
    """Mean square of the deviations from a measured trace, each in standard deviations of its column.

    The simulated trace is interpolated at the times of the measured one; NaN there is ignored.
    The distance is infinite if the run ended before the last of these times. The columns must have the units
    of the run.
    """
    simulation = result.columns
    times = simulation["time"]
    # a row represents the time up to the next
    end = result.simulated_s + (times[1] if len(times) > 1 else 0.0)
    squares = []
    file = f"`{paths.shown(target.file)}`"
    for name in columns or target.columns:
        if name not in simulation:
            text = f"{file} has the column `{name}`, which is not in the trace of a run"
            raise CosimError(text, closest(name, simulation))
        units = target.units.get(name, ""), result.units.get(name, "")
        if all(units) and units[0] != units[1]:
            raise CosimError(f"`{name}` in {file} is in `{units[0]}`, that of a run in `{units[1]}`")
        values = target.data[name]
        known = np.isfinite(values)
        if np.any(target.times[known] > end):
            return math.inf
        simulated = interpolated(times, simulation[name], target.times[known])
        scale = float(np.std(values[known])) or 1.0
        squares.append(np.square((simulated - values[known]) / scale))
    return float(np.mean(np.concatenate(squares)))


def score(problem: Problem, criteria: Sequence[Criterion], rows: Sequence[Row]) -> Score:
    """Score of a trial from the rows of its runs."""
    lost = next((row for row in rows if row["status"] not in DONE), None)
    if lost is not None:
        return Score(None, reason=str(lost["reason"]))
    name = problem.objective.metric or MISFIT
    value = float(np.mean([float(row["metrics"][name]) for row in rows]))
    if not math.isfinite(value):
        early = ": the run ended before the measured trace" if (name, value) == (MISFIT, math.inf) else ""
        return Score(None, reason=f"`{name}` is {value}{early}")
    runs = zip(*(verdicts(row, criteria) for row in rows), strict=True)
    return Score(value, tuple(max(map(violation, found)) for found in runs))


def violation(verdict: Verdict) -> float:
    """Violation of a criterion relative to its limit; 0 if it passed.

    The verdict decides; the distance only guides the search.
    """
    if verdict.passed:
        return 0.0
    if not math.isfinite(verdict.value):
        return 1.0 / VIOLATED
    value = verdict.value
    failed = [limit for relation, limit in verdict.limits if not RELATIONS[relation](value, limit)]
    return min(max(VIOLATED, *(abs(value - limit) / (abs(limit) or 1.0) for limit in failed)), 1.0 / VIOLATED)


@once()
def search(
    variants: Variants,
    store: Store,
    progress: Progress | None = None,
    workers: int | None = None,
    engine: Engine = "native",
    again: bool = False,
) -> list[Trial]:
    """Continue a search; return all trials. After any interruption, the next call continues from the rows.

    `progress` is called with the completed and the total number of trials. `again` repeats runs without a
    result.
    """
    length = variants.problem.search
    proposer = Proposer(variants.problem)
    trials: list[Trial] = []
    with Runner(variants, workers, engine, again) as runner:
        while len(trials) < length.trials:
            numbers = range(len(trials), min(len(trials) + length.batch, length.trials))
            runs = [variants.runs(number, proposer.propose(number)) for number in numbers]
            runner.do([run for group in runs for run in group], store)
            for group in runs:
                rows = [row for run in group if (row := store.row(run, variants.criteria)) is not None]
                found = score(variants.problem, variants.criteria, rows)
                trials.append(Trial(group[0].case, group[0].changes, found))
                proposer.report(trials[-1])
            if all(trial.score.value is None for trial in trials):
                reason = trials[0].score.reason
                raise CosimError(f"none of the first {len(trials)} trials gave a number; the first: {reason}")
            if progress is not None:
                progress(len(trials), length.trials)
    return trials


def best_of(problem: Problem, trials: Sequence[Trial]) -> Trial | None:
    """Best trial that passed all criteria, the first of equal ones; None if there is none."""
    sign = -1.0 if problem.objective.direction == "maximize" else 1.0
    feasible = (trial for trial in trials if trial.score.feasible)
    return min(feasible, key=lambda trial: sign * (trial.score.value or 0.0), default=None)
