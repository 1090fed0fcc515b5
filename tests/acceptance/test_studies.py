"""The studies of the project: all of their runs are possible, and one of each starts and is evaluated."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

import cosim
from cosim.pool.worker import JobRunner
from cosim.scenario.kinds import kind_of
from cosim.scenario.toml import parse_file
from cosim.sweep import study
from cosim.sweep.plan import Plan

FOLDER = Path(__file__).resolve().parents[2] / "studies"
STEPS = 200
"""Of that run; whole ones are those of the scenarios, and of the samples that their loops are held by."""


@pytest.mark.parametrize(
    "name",
    sorted(file.stem for file in FOLDER.glob("*.toml") if kind_of(parse_file(file)) == "study"),
)
def test_a_study_can_be_run(name: str) -> None:
    plan = Plan(study.load(FOLDER / f"{name}.toml"))
    assert len({run.hash for run in plan.runs}) == len(plan.runs)
    with JobRunner() as runner:
        job = plan.job(plan.runs[-1])
        short = replace(
            job.scenario, loop=replace(job.scenario.loop, duration=STEPS * job.scenario.loop.step)
        )
        result = runner.run(replace(job, scenario=short))
    assert isinstance(result, cosim.Result), result
    assert math.isclose(result.simulated_s, STEPS * job.scenario.loop.step)
