"""The search: points are proposed in batches, run, and told, until all trials are done.

Every proposal follows from the seed and the trials of earlier batches alone, never from the order in which
runs end. A search that was interrupted therefore proposes the same points again, finds the rows of those that
were run, and goes on; the rows are the only state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cosim.errors import CosimError
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.result import Result
from cosim.optimize.objective import MISFIT, misfit, score
from cosim.optimize.problem import Problem
from cosim.optimize.proposer import Proposer, Trial
from cosim.optimize.variants import Variants
from cosim.pool.runs import run_each
from cosim.sweep.plan import Run
from cosim.sweep.store import TROUBLES, Store, row_of
from cosim.words.strict import plain


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
    redone = ("", *TROUBLES) if options.again else ("",)
    pending = list({run.hash: run for run in runs if store.status(run.hash) in redone}.values())
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


def best(problem: Problem, trials: Sequence[Trial]) -> Trial | None:
    """Best of the trials that hold all criteria, the first of equals; None if there is none."""
    sign = -1.0 if problem.objective.direction == "maximize" else 1.0
    feasible = [(sign * t.score.value, t) for t in trials if t.score.feasible and t.score.value is not None]
    return min(feasible, key=lambda pair: pair[0])[1] if feasible else None
