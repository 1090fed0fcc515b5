"""Inputs and commands that nothing drives: forgotten ones are told, meant ones are not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.loop import idle
from cosim.warned import warn_once

from ..conftest import SCENARIO

Write = Callable[..., Path]


def test_what_nothing_drives_is_warned_of_once(write: Write, caplog: pytest.LogCaptureFixture) -> None:
    warn_once.cache_clear()
    text = SCENARIO.replace(', "controller.flag", "plant.extra"', ', "plant.etra"')
    file = write(text=text)
    for _ in range(2):
        cosim.run(cosim.load(file))
    unknown, forgotten = (record.getMessage() for record in caplog.records)
    assert unknown.startswith("`lag.toml`: `idle` lists `plant.etra`, which is no input and no command; ")
    assert unknown.endswith("did you mean `plant.extra`?")
    assert forgotten.startswith("`lag.toml`: nothing drives `controller.flag`, `plant.extra`: wire what is ")


@pytest.mark.parametrize(
    "driven",
    [
        '[[signal]]\nto = "controller.flag"\ntimes = [0.0]\nvalues = [true]\n',
        '[[inject]]\nto = "controller.flag"\nfrom_time = 0.0\nto_time = 0.01\nvalue = 1.0\n',
        "[controller.parameters]\nflag = true\n",
    ],
)
def test_what_is_driven_otherwise_is_not_idle(
    write: Write, caplog: pytest.LogCaptureFixture, driven: str
) -> None:
    warn_once.cache_clear()
    cosim.run(cosim.load(write(driven, text=SCENARIO.replace(', "controller.flag"', ""))))
    assert not caplog.records


@pytest.mark.parametrize("name", ["centering", "deburr", "dob", "fts", "polish"])
def test_the_own_scenarios_leave_nothing_idle_by_mistake(name: str) -> None:
    scenario = cosim.load(name)
    with cosim.Session(scenario) as session:
        known = idle.ends(session.fmus, session.plant)
    assert (idle.undriven(scenario, known), idle.unknown(scenario, known)) == ([], "")
