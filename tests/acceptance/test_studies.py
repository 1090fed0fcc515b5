"""The studies of the project: every run of them is possible, and one of each gives a result."""

from __future__ import annotations

from pathlib import Path

import pytest

import cosim
from cosim.pool.worker import JobRunner
from cosim.sweep import study
from cosim.sweep.plan import Plan

FOLDER = Path(__file__).resolve().parents[2] / "studies"


@pytest.mark.parametrize("name", sorted(file.stem for file in FOLDER.glob("*.toml")))
def test_a_study_can_be_run(name: str) -> None:
    plan = Plan(study.load(FOLDER / f"{name}.toml"))
    assert len({run.hash for run in plan.runs}) == len(plan.runs)
    with JobRunner() as runner:
        assert isinstance(runner.run(plan.job(plan.runs[-1])), cosim.Result)
