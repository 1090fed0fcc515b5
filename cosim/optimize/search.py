"""The search: propose points in batches, run them and report their scores, until all trials are done.

Every proposal depends only on the seed and the trials of earlier batches, never on the order in which runs
end. An interrupted search therefore proposes the same points again, finds the rows of completed runs, and
continues; the rows are the only state.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from cosim.closing import Closing
from cosim.errors import CosimError
from cosim.formatting.strict import plain
from cosim.loop.engines import Engine
from cosim.loop.reference import Progress
from cosim.loop.result import Result
from cosim.optimize.objective import MISFIT, misfit, score
from cosim.optimize.problem import Problem
from cosim.optimize.proposer import Proposer, Trial
from cosim.optimize.variants import Variants
from cosim.pool import executor
from cosim.pool.job import Outcome
from cosim.pool.limits import processors
from cosim.study.run import Run
from cosim.study.store import TROUBLES, Row, Store, row_of
from cosim.warned import once


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
