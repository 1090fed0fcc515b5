"""Messages of FMUs in other processes are shown with the run, up to a limit."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.pool.executor import LogRelay
from cosim.pool.supervisor import MAX_LINES

Write = Callable[..., Path]


@pytest.mark.parametrize("workers", [1, 2])
def test_events_and_warnings_of_many_runs_are_reported(
    workers: int, write: Write, caplog: pytest.LogCaptureFixture
) -> None:
    scenario = cosim.load(write(), ["controller.warn_at=3"])
    odd = "Probe [logStatusWarning] something is odd at 0.003 s"
    with caplog.at_level(logging.INFO, "cosim"):
        cosim.run_many(scenario, [5, 6], workers, engine="reference")
    if workers == 1:
        named = ["run 0, seed 5:", odd, "run 1, seed 6:", odd]
        assert caplog.messages == named
        return
    assert sorted(caplog.messages) == [f"run 0, seed 5: {odd}", f"run 1, seed 6: {odd}"]
    caplog.clear()
    cosim.run_many(scenario, [5, 6], workers, engine="reference")
    (reported,) = caplog.messages
    assert reported.endswith(odd)
    assert reported.startswith("run ")


def test_an_fmu_that_warns_in_every_step_does_not_flood(caplog: pytest.LogCaptureFixture) -> None:
    relay = LogRelay()
    for number in range(10 * MAX_LINES):
        relay.report("run 0, seed 1", ("cosim.fmu", logging.WARNING, f"odd at {number} s"))
    assert len(caplog.messages) == MAX_LINES + 1
    assert caplog.messages[0] == "run 0, seed 1: odd at 0 s"
    assert caplog.messages[-1] == "further log lines are hidden; show all with `-v`"


@pytest.mark.skipif(sys.platform != "linux", reason="signals of Linux")
def test_a_crash_repeats_what_the_fmu_logged_last(write: Write) -> None:
    scenario = cosim.load(write(), ["controller.warn_at=2", "controller.raise_at=3"])
    fine = cosim.load(write())
    crashed, _ = cosim.run_each([scenario, fine], 2, engine="reference")
    assert isinstance(crashed, cosim.CosimError)
    assert "its last output: Probe [logStatusWarning] something is odd at 0.002 s" in crashed.message
