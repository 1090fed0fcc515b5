"""The search: propose points in batches, run them and report their scores, until all trials are done.

Every proposal depends only on the seed and the trials of earlier batches, never on the order in which runs
end. An interrupted search therefore proposes the same points again, finds the rows of completed runs, and
continues; the rows are the only state.
"""

from __future__ import annotations

from collections.abc import Sequence

from cosim.errors import CosimError
from cosim.loop.reference import Progress
from cosim.optimize.objective import score
from cosim.optimize.problem import Problem
from cosim.optimize.proposer import Proposer, Trial
from cosim.optimize.runner import Runner, SearchOptions
from cosim.optimize.variants import Variants
from cosim.study.store import Store
from cosim.warned import once


@once()
def search(
    variants: Variants, store: Store, options: SearchOptions, progress: Progress | None = None
) -> list[Trial]:
    """Continue a search; return all trials.

    After any interruption, such as Ctrl-C, the written rows remain and the next call continues from them.

    Parameters
    ----------
    variants
        The scenario with any values.
    store
        Store of the rows.
    options
        Options of the search.
    progress
        Called with the completed and the total number of trials.

    Raises
    ------
    CosimError
        Optuna is not installed, or no trial of the first batch gave a number.
    """
    wanted = variants.problem.search
    proposer = Proposer(variants.problem)
    trials: list[Trial] = []
    with Runner(variants, options) as runner:
        while len(trials) < wanted.trials:
            numbers = range(len(trials), min(len(trials) + wanted.batch, wanted.trials))
            runs = [variants.runs(number, proposer.propose(number)) for number in numbers]
            runner.do([run for group in runs for run in group], store)
            for group in runs:
                rows = [row for run in group if (row := store.row(run, variants.criteria)) is not None]
                worth = score(variants.problem, variants.criteria, rows)
                trials.append(Trial(group[0].case, group[0].changes, worth))
                proposer.report(trials[-1])
            if all(trial.score.value is None for trial in trials):
                reason = trials[0].score.reason
                raise CosimError(f"none of the first {len(trials)} trials gave a number; the first: {reason}")
            if progress is not None:
                progress(len(trials), wanted.trials)
    return trials


def best(problem: Problem, trials: Sequence[Trial]) -> Trial | None:
    """Best trial that passed all criteria, the first of equal ones; None if there is none."""
    sign = -1.0 if problem.objective.direction == "maximize" else 1.0
    feasible = [(sign * t.score.value, t) for t in trials if t.score.feasible and t.score.value is not None]
    return min(feasible, key=lambda pair: pair[0])[1] if feasible else None
