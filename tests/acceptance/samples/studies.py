"""Runs of the studies of the project, and new random samples for the default run of the tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import cosim
from cosim.pool.worker import JobRunner
from cosim.sweep import study
from cosim.sweep.designs import Case
from cosim.sweep.plan import Plan

from .runs import value

FOLDER = Path(__file__).resolve().parents[3] / "studies"


@dataclass(frozen=True)
class Machine:
    """A machine of a study and how it ended."""

    changes: Case
    result: cosim.Result

    def __getitem__(self, metric: str) -> float:
        return value(self.result, metric)


def machines(name: str, few: tuple[int, int] | None = None, changes: Case | None = None) -> list[Machine]:
    """All machines of a study, with changes, or a number of new ones with a seed: (samples, seed)."""
    wanted = study.load(FOLDER / f"{name}.toml")
    wanted = replace(wanted, set={**wanted.set, **(changes or {})})
    if few is not None:
        samples, seed = few
        wanted = replace(wanted, seed=seed, design=replace(wanted.design, samples=samples))
    plan = Plan(wanted)
    found = []
    with JobRunner() as runner:
        for one in plan.runs:
            result = runner.run(plan.job(one))
            assert isinstance(result, cosim.Result), result
            found.append(Machine(one.changes, result))
    return found


def hold_stds(found: Sequence[Machine], errors: Mapping[str, Sequence[float]]) -> None:
    """Compare the claimed standard deviations, metrics `NAME_std`, with the errors of NAME."""
    for name, wrong in errors.items():
        ratio = np.array(wrong) / np.array([one[f"{name}_std"] for one in found])
        rms, high = float(np.sqrt(np.mean(ratio**2))), float(np.percentile(np.abs(ratio), 99))
        print(f"{name}: errors in claimed standard deviations {rms:.2f} rms, 99 % below {high:.2f}")
        assert 0.5 < rms < 1.5, name
        assert high < 3.5, name
