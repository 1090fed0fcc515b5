"""Undriven inputs and commands: a warning, except for intended ones."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.check import lint
from cosim.loop import undriven

from ..conftest import END, SCENARIO, entry

Write = Callable[..., Path]


def test_every_run_warns_once_of_what_nothing_drives(write: Write, caplog: pytest.LogCaptureFixture) -> None:
    text = SCENARIO.replace(', "controller.flag", "plant.extra"', ', "plant.etra"')
    scenario = cosim.load(write(text=text))
    for workers in (1, 2):
        cosim.run_many(scenario, range(4), workers=workers)
        assert len(caplog.records) <= 2 * workers
        caplog.clear()
    for _ in range(2):
        caplog.clear()
        cosim.run(scenario)
    unknown, forgotten = caplog.messages
    caplog.clear()
    with cosim.Session(scenario) as session:
        session.run()
        session.run()
    assert caplog.messages == 2 * [unknown, forgotten]
    assert unknown.startswith("`lag.toml`: `undriven` lists `plant.etra`, which is not an input or command. ")
    assert unknown.endswith("Use `plant.extra`.")
    assert forgotten.startswith("`lag.toml`: nothing drives `controller.flag`, `plant.extra`: add the ")


def test_a_command_that_nothing_drives_stays_at_its_start(
    write: Write, caplog: pytest.LogCaptureFixture
) -> None:
    text = SCENARIO.replace(', "plant.extra"', "").replace("probe_plants:Lag", "probe_plants:Switched")
    trace = cosim.run(cosim.load(write(text=text))).trace
    assert trace is not None
    assert set(trace["plant.extra"]) == {1.0}
    assert ["nothing drives `plant.extra` (stays at 1): add" in reported for reported in caplog.messages] == [
        True
    ]
    off = '[[inject]]\nto = "plant.extra"\nfrom_time = 0.01\nto_time = 0.02\nvalue = 0.0\n'
    trace = cosim.run(cosim.load(write(off, text=text))).trace
    assert trace is not None
    assert trace["plant.extra"].tolist() == [1.0] * 10 + [0.0] * 10 + [1.0] * 30


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
    cosim.run(cosim.load(write(driven, text=SCENARIO.replace(', "controller.flag"', ""))))
    assert not caplog.records


FAULT = '[[inject]]\nto = "controller.in"\nfrom_time = {}\nto_time = {}\nvalue = 1.0\n'
LIMIT = END + entry("criterion", id="end", claim="It ends", metric="end")


@pytest.mark.parametrize(
    ("content", "reported"),
    [
        (FAULT.format(0.05, 0.06), "`inject.controller.in` from 0.05 s to 0.06 s reaches no step of the run"),
        (FAULT.format(0.0012, 0.0018), "reaches no step of the run, which ends at 0.05 s: it never starts"),
        (FAULT.format(0.049, 9.0), ""),
        (LIMIT + "maximum = inf\n", "`criterion.end.maximum` is `inf`, which any number meets"),
        (LIMIT + "minimum = -inf\n", "`criterion.end.minimum` is `-inf`, which any number meets"),
        (LIMIT + "minimum = -1.0\n", ""),
    ],
)
def test_what_has_no_effect_is_warned_of_in_runs_and_checks(
    write: Write, caplog: pytest.LogCaptureFixture, content: str, reported: str
) -> None:
    scenario = cosim.load(write(content))
    cosim.run(scenario)
    messages = [record.getMessage() for record in caplog.records]
    assert len(messages) == bool(reported)
    assert all(message.startswith("`lag.toml`: ") and reported in message for message in messages)
    with cosim.Session(scenario) as session:
        warnings = [
            reported for reported in lint.check(session) if reported.startswith(("`inject", "`criterion"))
        ]
    assert len(warnings) == bool(reported)
    assert reported in "".join(warnings)


@pytest.mark.parametrize("name", ["centering", "deburr", "dob", "fts", "polish"])
def test_the_own_scenarios_leave_nothing_idle_by_mistake(name: str) -> None:
    scenario = cosim.load(name)
    with cosim.Session(scenario) as session:
        known = undriven.ends(session.fmus, session.plant)
    assert (undriven.undriven(scenario, known), undriven.unknown(scenario, known)) == ([], "")
