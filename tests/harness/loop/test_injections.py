"""Injections: what each kind does to the value that arrives, when it begins and how long it lasts."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError

from ..conftest import SCENARIO, entry

Write = Callable[..., Path]
RAMP = SCENARIO.replace("plant.x", "plant.ramp")
"""Scenario in which `controller.in` is the time, s."""


def arrives(write: Write, *entries: dict[str, Any], column: str = "controller.in", seed: int = 1) -> Any:
    """Column of a run with injections, default `controller.in`."""
    added = "".join(entry("inject", **({"to": "controller.in"} | one)) for one in entries)
    trace = cosim.run(cosim.load(write("\n" + added, text=RAMP), set=[f"loop.seed={seed}"])).trace
    assert trace is not None
    return trace[column]


TIME = np.arange(50) * 0.001
KINDS: dict[str, tuple[dict[str, Any], Any]] = {
    "value": ({"value": 7.0}, np.full(50, 7.0)),
    "frozen": ({"frozen": True}, np.full(50, 0.01)),
    "offset": ({"offset": -0.5}, TIME - 0.5),
    "scale": ({"scale": -1.0}, -TIME),
    "ramp": ({"ramp": 3.0}, TIME + 3.0 * (TIME - 0.01)),
    "late": ({"late": 4}, TIME - 0.004),
    "all lost": ({"drop": 1.0}, np.full(50, 0.009)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_changes_what_arrives_in_its_time(write: Write, kind: str) -> None:
    said, expected = KINDS[kind]
    found = arrives(write, {"from_time": 0.01, "to_time": 0.02, **said})
    assert found == pytest.approx(np.where((TIME > 0.0095) & (TIME < 0.0195), expected, TIME))


def test_without_an_end_a_fault_lasts_to_the_end_of_the_run(write: Write) -> None:
    assert arrives(write, {"from_time": 0.03, "offset": 1.0}) == pytest.approx(TIME + (TIME > 0.0295))


def test_a_duration_of_one_step_is_a_spike(write: Write) -> None:
    found = arrives(write, {"from_time": 0.0205, "duration": 0.001, "offset": 1.0})
    assert (found - TIME).round(9).nonzero()[0].tolist() == [21]


def test_injections_at_one_target_act_in_their_order(write: Write) -> None:
    found = arrives(write, {"from_time": 0.0, "offset": 1.0}, {"from_time": 0.0, "scale": 2.0})
    assert found == pytest.approx(2.0 * (TIME + 1.0))


def test_a_condition_begins_an_injection_after_its_row(write: Write) -> None:
    found = arrives(write, {"when": "plant.x < 0.01 and time > 0.0095", "offset": 1.0, "duration": 0.003})
    assert (found - TIME).round(9).nonzero()[0].tolist() == [11, 12, 13]
    found = arrives(write, {"when": "time > 0.0095", "after": 0.005, "offset": 1.0})
    assert (found - TIME).round(9).nonzero()[0].tolist() == [*range(15, 50)]


def test_noise_and_losses_are_seeded_and_independent(write: Write) -> None:
    noise = {"from_time": 0.0, "noise": 0.5}
    one, two = (arrives(write, noise, seed=seed) - TIME for seed in (50_071, 50_072))
    assert np.array_equal(one, arrives(write, noise, seed=50_071) - TIME)
    assert not np.array_equal(one, two)
    assert 0.3 < one.std() < 0.7
    both = arrives(write, noise, noise, seed=50_071) - TIME
    assert not np.allclose(both, 2.0 * one)
    lost = arrives(write, {"from_time": 0.0, "drop": 0.5}, seed=50_071)
    assert set(lost.round(9)) < {0.0, *TIME.round(9)}
    assert 10 < np.count_nonzero(np.diff(lost) == 0.0) < 40


def test_a_lost_truth_value_is_false(write: Write) -> None:
    signal = entry("signal", to="controller.flag", times=[0.0], values=[True])
    fault = entry("inject", to="controller.flag", from_time=0.01, drop=0.5)
    trace = cosim.run(cosim.load(write("\n" + signal + fault))).trace
    assert trace is not None
    flags = trace["controller.flag"]
    assert flags[:10].all()
    assert 5 < flags[10:].sum() < 35


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "no kind": (
        {"from_time": 0.0},
        r"`inject.controller.in` has no kind\nhint: Give one of",
    ),
    "two kinds": (
        {"from_time": 0.0, "value": 0.0, "offset": 1.0},
        r"`inject.controller.in.offset` cannot be combined with `value`\nhint: Give one kind each; several",
    ),
    "no start": ({"offset": 1.0}, r"`inject.controller.in.from_time` is missing\nhint: .*`when`"),
    "two beginnings": (
        {"from_time": 0.0, "when": "time > 0", "offset": 1.0},
        r"in.when` cannot be combined with",
    ),
    "end of a condition": (
        {"when": "time > 0", "to_time": 1.0, "offset": 1.0},
        r"in.to_time` is `1.0` s, but with `when` its start is unknown\nhint: Use `duration`",
    ),
    "after a time": (
        {"from_time": 0.0, "after": 1.0, "offset": 1.0},
        r"in.after` is `1.0` s, but there",
    ),
    "two ends": (
        {"from_time": 0.0, "to_time": 1.0, "duration": 1.0, "offset": 1.0},
        r"in.duration` cannot be combined with `to_time` = `1.0` s",
    ),
    "share": ({"from_time": 0.0, "drop": 1.1}, r"in.drop` is `1.1`, it must be in 0 .. 1"),
    "not late": ({"from_time": 0.0, "late": 0}, r"in.late` is `0`, it must be at least 1"),
    "too late": (
        {"from_time": 0.0, "late": 51},
        r"in.late` is `51` steps, it must not exceed the 50 steps",
    ),
    "no Boolean": (
        {"to": "controller.flag", "from_time": 0.0, "offset": 1.0},
        r"`inject.controller.flag.offset`: `controller.flag` is a Boolean\nhint: Use `value`, ",
    ),
    "no number": (
        {"to": "controller.mode", "from_time": 0.0, "scale": 2.0},
        r"`inject.controller.mode.scale`: `controller.mode` is an enumeration",
    ),
    "no condition": (
        {"when": "controller.out", "offset": 1.0},
        r"`lag.toml`: `inject.controller.in.when` = `controller.out` is not a condition\nhint: Compare it",
    ),
    "unknown column": (
        {"when": "controller.ot > 1", "offset": 1.0},
        (
            r"in.when` = .* names `controller.ot`, which is not a known column.*"
            r"\nhint: Use `controller.out`"
        ),
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_mistake_names_key_and_hint(write: Write, case: str) -> None:
    said, message = WRONG[case]
    with pytest.raises(CosimError, match=message):
        arrives(write, said)


def test_a_condition_that_never_holds_is_warned_of(write: Write, caplog: pytest.LogCaptureFixture) -> None:
    fault = entry("inject", to="controller.in", when="time > 1", offset=1.0)
    with caplog.at_level(logging.WARNING, "cosim"):
        result = cosim.run(cosim.load(write("\n" + fault)))
    assert result.injected == (None,)
    (reported,) = caplog.messages
    assert reported.startswith(
        "`lag.toml`: `inject.controller.in.when` = `time > 1` was true too late or in no row"
    )


def test_a_fault_that_changes_nothing_is_warned_of(write: Write, caplog: pytest.LogCaptureFixture) -> None:
    cosim.run(cosim.load(write("\n" + entry("inject", to="controller.in", from_time=0.0, scale=1.0))))
    assert caplog.messages == ["`lag.toml`: `inject.controller.in.scale` is `1`, which changes nothing"]
