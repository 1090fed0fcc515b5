"""Points of a search, proposed by Optuna from the earlier trials."""

from __future__ import annotations

import functools
import warnings
from dataclasses import dataclass
from typing import Any

from cosim import extras
from cosim.loop.wires.transform import child
from cosim.optimize.objective import Score
from cosim.optimize.problem import Problem
from cosim.optimize.variants import Values
from cosim.study.parameters import Vary


@dataclass(frozen=True)
class Trial:
    """One point: its number from 0, its values and its score."""

    number: int
    values: Values
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

    def propose(self, number: int) -> Values:
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
