"""Controllers on machines that are not nominal: the studies `<loop>-machines`, judged by what the plants say.

Each machine ends in one of three ways: the job is done and good, or a fault is named, or neither: silent.
The default run takes a few machines of a seed of its own, `pytest -m full -rP` all of a study.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

import cosim
from cosim.pool.worker import JobRunner
from cosim.sweep import study
from cosim.sweep.plan import Plan

from .samples.runs import value

pytestmark = pytest.mark.acceptance

FOLDER = Path(__file__).resolve().parents[2] / "studies"
SOME, SEED = 4, 91_001
"""Machines of the default run, and their seed; no study has it."""


@dataclass(frozen=True)
class Least:
    """What a controller reaches on all machines of its study: what was measured and room for its scatter.

    Parameters
    ----------
    good
        Least share of machines on which the job is done and good.
    silent
        Largest share of machines on which it is not, without a fault.
    """

    good: float
    silent: float


LEAST = {
    "centering": Least(0.0, 1.0),
    "deburr": Least(0.0, 1.0),
    "dob": Least(0.0, 1.0),
    "fts": Least(0.0, 1.0),
    "polish": Least(0.0, 1.0),
}


@functools.cache
def machines(loop: str, samples: int | None = None) -> list[cosim.Result]:
    """Results of a study, or of so many machines that are drawn anew."""
    wanted = study.load(FOLDER / f"{loop}-machines.toml")
    if samples is not None:
        wanted = replace(wanted, seed=SEED, design=replace(wanted.design, samples=samples))
    plan = Plan(wanted)
    with JobRunner() as runner:
        results = [runner.run(plan.job(run)) for run in plan.runs]
    broken = [result for result in results if not isinstance(result, cosim.Result)]
    assert not broken, broken
    tell(loop, results)
    return results


def tell(loop: str, results: Sequence[cosim.Result]) -> None:
    """Print how the machines ended, and the seeds of those that ended badly without a fault."""
    good, named, silent = (
        sum(value(result, metric) > 0.0 for result in results) for metric in ("good", "named", "silent")
    )
    seeds = [result.seed for result in results if value(result, "silent")]
    print(f"{loop}: {len(results)} machines, {good} good, {named} named, {silent} silent {seeds}")


@pytest.mark.parametrize("loop", LEAST)
def test_every_machine_ends_good_or_with_a_name(loop: str) -> None:
    for result in machines(loop, SOME):
        ended = [value(result, metric) for metric in ("good", "silent")]
        # a fault after a good job would be both good and named
        assert ended in ([1.0, 0.0], [0.0, 0.0]), f"seed {result.seed}: {result.metrics}"


@pytest.mark.full
@pytest.mark.parametrize(("loop", "least"), LEAST.items())
def test_the_study_reaches_its_shares(loop: str, least: Least) -> None:
    results = machines(loop)
    assert len(results) == 200
    assert sum(value(result, "good") for result in results) >= least.good * len(results)
    assert sum(value(result, "silent") for result in results) <= least.silent * len(results)
