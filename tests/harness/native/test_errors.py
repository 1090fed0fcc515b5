"""The native engine against the reference loop: the same errors at the same step."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError

from .loops import CHUNKS, both, chunked, outcome

PULSE = '[[inject]]\nto = "{}"\nfrom_time = 0.02\nto_time = 0.03\nvalue = {}\n'
FAILURES: dict[str, tuple[str, Sequence[str], str]] = {
    "FMU error": (
        "",
        ["controller.fail_at=20"],
        r"failed on request at 0.02 s \(fmi2DoStep returned fmi2Error\)",
    ),
    "fatal error": ("", ["controller.fatal_at=20"], r"step 20.*fmi2Fatal"),
    "input rejected": (
        '[[signal]]\nto = "controller.gain"\ntimes = [0.0, 0.02]\nvalues = [1.0, 11.0]\n',
        [],
        r"`gain` = 11 is above its limit \(fmi2SetReal",
    ),
    "output not finite": ("", ["controller.nan_at=20"], r"`controller.out` is `nan`.*step 20"),
    "command not finite": (PULSE.format("plant.drive", "inf"), [], r"command `drive` is `inf`.*"),
    "integer too large": ("", ["wire.controller.count.offset=3e9"], r"an integer input got `3000000000.0`"),
    "MuJoCo warning": (PULSE.format("plant.drive", 1e300), [], "MuJoCo warns: `mjWARN_BADCTRL`"),
}


def failure(session: cosim.Session) -> tuple[type, str, str]:
    with pytest.raises(CosimError) as caught:
        session.run()
    return type(caught.value), caught.value.message, caught.value.hint


@pytest.mark.parametrize("case", FAILURES)
def test_errors_are_the_same(cart: Callable[..., Path], case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    added, changes, words = FAILURES[case]
    reference, fast = both(cosim.load(cart(added), set=changes))
    with reference, fast:
        expected = failure(reference)
        assert expected[1].count("step ") == 1
        for chunk in CHUNKS:
            chunked(monkeypatch, chunk)
            if case == "fatal error" and chunk > 1:
                assert "a new run needs a new instance" in failure(fast)[1]
                continue
            assert failure(fast) == expected
    assert re.search(words, expected[1])


def broken_sensor(session: cosim.Session) -> Callable[[], None]:
    """Break the model after the reset; the result repairs it."""
    plant: Any = session.plant
    reset, kinds = plant.reset, plant.model.sensor_type.copy()

    def break_it(seed: Any, duration: float) -> None:
        mend()
        reset(seed, duration)
        plant.model.sensor_type[:] = 99
        plant.reset = break_it

    def mend() -> None:
        plant.model.sensor_type[:] = kinds
        plant.reset = reset

    plant.reset = break_it
    return mend


def short_signals(session: cosim.Session) -> None:
    plant: Any = session.plant
    reset = plant.reset
    plant.reset = lambda seed, duration: reset(seed, duration / 2)


def no_number(session: cosim.Session) -> None:
    plant: Any = session.plant
    reset = plant.reset

    def spoilt(seed: Any, duration: float) -> None:
        reset(seed, duration)
        plant.data.ctrl[:] = np.nan
        plant.data.qvel[:] = np.nan

    plant.reset = spoilt


INTO_THE_RING = """
extends = "centering"
[loop]
duration = 1.0
stop_when = ""
[[inject]]
to = "plant.slide_position_setpoint"
from_time = 0.1
to_time = 9.0
value = 0.2
# else the controller sees it and switches the drive off
[[inject]]
to = "plant.enable"
from_time = 0.0
value = 1.0
"""
BREAKS: dict[str, tuple[Callable[[cosim.Session], object] | None, str]] = {
    "MuJoCo error": (broken_sensor, r"step 0\): .*mj_computeSensorPos: invalid sensor type"),
    "signal ends": (short_signals, r"ends after `\d+` plant steps"),
    "state not finite": (no_number, r"mjWARN_BADQVEL"),
    "element stops": (None, r"element `table_edge`: the eccentricity is `0\.\d+` m, limit"),
}


@pytest.fixture
def _broken_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    """Repeat no run: a plant that a test breaks between two runs gives other results."""
    monkeypatch.setattr(cosim.Session, "_check_repeatable", lambda *_: None)


@pytest.mark.usefixtures("_broken_from_outside")
@pytest.mark.parametrize("case", BREAKS)
def test_errors_of_the_plant_are_the_same(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spoil, words = BREAKS[case]
    file = tmp_path / "ring.toml"
    file.write_text(INTO_THE_RING)
    scenario = cosim.load("fts", set=["loop.duration=0.02"]) if spoil else cosim.load(file)
    reference, fast = both(scenario)
    with reference, fast:
        for session in (reference, fast):
            if spoil:
                spoil(session)
        expected = failure(reference)
        for chunk in CHUNKS:
            chunked(monkeypatch, chunk)
            assert failure(fast) == expected
    assert re.search(words, expected[1])


@pytest.mark.usefixtures("_broken_from_outside")
def test_a_session_continues_after_an_error_of_mujoco() -> None:
    scenario = cosim.load("fts", set=["loop.duration=0.02"])
    reference, fast = both(scenario)
    with reference, fast:
        expected = outcome(reference)
        mend = broken_sensor(fast)
        failure(fast)
        mend()
        assert outcome(fast) == expected
