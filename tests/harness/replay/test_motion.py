"""Which instants are shown, what is drawn larger, and what is written into the picture."""

from __future__ import annotations

import dataclasses
import math
import re
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError
from cosim.formatting.quantity import number
from cosim.replay import caption, enlarge
from cosim.replay.motion import Motion, Recorded, motion, of_result, of_trace
from cosim.replay.playback import RATE, time_scale
from plants.bare import Bare

RECORD = ["loop.record_qpos=true"]


def run(file: Path, *changes: str) -> Recorded:
    scenario = cosim.load(file, [*RECORD, *changes])
    return of_result(scenario, cosim.run(scenario))


@pytest.mark.parametrize(
    ("last", "seconds", "words"),
    [
        (8.0, 8.0, "real time"),
        (60.0, 8.0, "time-lapse: 7.5 x faster"),
        (2.0, 8.0, "slow motion: 4 x slower"),
        (7.84, 8.0, "nearly real time: 0.98 x"),
        (8.4, 8.0, "nearly real time: 1.05 x"),
    ],
)
def test_a_video_shows_how_fast_it_is(last: float, seconds: float, words: str) -> None:
    times = np.linspace(0.0, last, 1001)
    found = time_scale(times, seconds)
    assert found.text == words
    assert len(found.rows) == RATE * seconds
    assert (found.rows[0], found.rows[-1]) == (0, 1000)


def test_a_picture_shows_the_row_that_held_at_its_time() -> None:
    times = np.array([0.0, 0.1, 0.5, 1.0])
    found = time_scale(times, 1.0, 0.1, 0.6)
    shown = np.linspace(0.1, 0.6, RATE)
    assert [float(times[row]) for row in found.rows] == [0.5 if t >= 0.5 else 0.1 for t in shown]
    assert found.speed == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("seconds", "begin", "end"),
    [(0.0, None, None), (math.inf, None, None), (3601.0, None, None), (1.0, 0.6, 0.4), (1.0, 0.0, 2.0)],
)
def test_a_time_that_is_none_is_reported(seconds: float, begin: float | None, end: float | None) -> None:
    with pytest.raises(CosimError, match=r"must be above 0|is outside of the run"):
        time_scale(np.linspace(0.0, 1.0, 11), seconds, begin, end)


def test_the_coordinates_come_from_the_trace(cart: Path, folder: Path) -> None:
    recorded = run(cart)
    moved = motion(recorded)
    assert moved.names == ("plant.qpos.slide",)
    assert np.array_equal(moved.qpos[:, 0], recorded.columns["plant.slide.position"])
    cosim.run(cosim.load(cart, RECORD)).save_trace("cart.npz")
    stored = motion(of_trace(cosim.load(cart), cosim.read_trace("cart.npz")))
    assert np.array_equal(stored.qpos, moved.qpos)


def test_what_is_placed_by_chance_is_where_the_run_had_it(
    cart: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reset, walls = Bare.reset, list[float]()

    def place(plant: Bare, seed: np.random.SeedSequence, duration: float) -> None:
        reset(plant, seed, duration)
        walls.append(plant.stream("wall").normal())
        plant.model.geom_pos[0, 0] = walls[-1]

    monkeypatch.setattr(Bare, "reset", place)
    scenario = cosim.load(cart, RECORD)
    result = cosim.run(scenario, seed=7)
    result.save_trace("cart.npz")
    stored = cosim.read_trace("cart.npz")
    without_unit = dataclasses.replace(stored, about={})
    runs = (of_result(scenario, result), of_trace(scenario, stored), of_trace(scenario, without_unit))
    drawn = [motion(one).model.geom_pos[0, 0] for one in runs]
    assert drawn[:2] == [walls[0]] * 2
    cosim.run(scenario)
    assert drawn[2] == walls[-1] != walls[0]


def test_a_trace_without_coordinates_says_how_to_get_them(cart: Path) -> None:
    scenario = cosim.load(cart)
    with pytest.raises(CosimError, match="no coordinates") as caught:
        motion(of_result(scenario, cosim.run(scenario)))
    assert "--set loop.record_qpos=true --trace FILE" in caught.value.hint


@pytest.mark.parametrize(
    ("shown", "kept", "reported"),
    [
        ("fts", "plant.", "no column `plant.qpos.spindle`"),
        ("dob", "plant.qpos.", "no column `plant.position`"),
        ("dob", "controller.", "no coordinates"),
    ],
)
def test_a_trace_of_another_loop_or_without_ground_truth_is_reported(
    shown: str, kept: str, reported: str
) -> None:
    result = cosim.run(cosim.load("dob", [*RECORD, "loop.duration=0.01"]))
    columns = {name: column for name, column in result.columns.items() if name.startswith(("time", kept))}
    with pytest.raises(CosimError, match=reported):
        motion(Recorded(cosim.load(shown), 1, columns))


def test_the_block_that_draws_a_run_moves_the_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    text = (Path(cosim.__file__).parent / "README.md").read_text("utf-8")
    (block,) = re.findall(r"\*\*To draw a run yourself.*?```python\n(.*?)```", text, re.DOTALL)
    short = partial(cosim.load, "dob", [*RECORD, "loop.duration=0.01"])
    assert f"set={RECORD}".replace("'", '"') in block
    monkeypatch.setattr(cosim, "load", lambda *_, **__: short())
    names: dict[str, Any] = {}
    exec(block, names)
    moved = names["moved"]
    assert moved.model.ncam == 2
    assert np.array_equal(moved.data.qpos, moved.qpos[-1])
    assert moved.data.xpos.any()


def test_a_motion_too_small_to_be_seen_is_drawn_larger_and_said(cart: Path) -> None:
    moved = motion(run(cart))
    factors = enlarge.automatic_factors(moved)
    factor = factors["plant.qpos.slide"]
    span = float(np.ptp(moved.qpos)) / moved.model.stat.extent
    # as large as 1, 2, 5 ... allows
    assert enlarge.SEEN / 2.5 < factor * span <= enlarge.SEEN * (1.0 + 1e-9)
    assert enlarge.Enlargement(moved, factors).qpos == pytest.approx(factor * moved.qpos)
    assert enlarge.Enlargement(moved, factors).texts == [f"drawn {factor:g} x larger: slide"]


def test_what_can_be_seen_stays_as_it_is(cart: Path) -> None:
    moved = motion(run(cart, "controller.bias=[40.0, 0.0]"))
    assert enlarge.automatic_factors(moved) == {}
    assert np.array_equal(enlarge.Enlargement(moved, {}).qpos, moved.qpos)


def test_far_from_home_a_motion_is_drawn_larger_where_it_is(cart: Path) -> None:
    moved = motion(run(cart))
    far = Motion(moved.model, moved.data, moved.names, moved.units, moved.times, moved.qpos + 5.0)
    drawn = enlarge.Enlargement(far, {"plant.qpos.slide": 10.0}).qpos
    assert drawn.mean() == pytest.approx(far.qpos.mean())
    assert np.ptp(drawn) == pytest.approx(10.0 * np.ptp(far.qpos))


@pytest.mark.parametrize(
    ("word", "reported"),
    [("slide", "no factor"), ("slide=0", "no factor"), ("slid=2", "Use `slide`")],
)
def test_a_wrong_enlargement_is_reported(word: str, reported: str, cart: Path) -> None:
    with pytest.raises(CosimError) as caught:
        enlarge.parse_factors([word], motion(run(cart)))
    assert reported in str(caught.value)


def test_a_picture_shows_time_state_and_key_numbers(cart: Path) -> None:
    recorded = run(cart)
    lines = caption.lines(recorded)
    row = 150
    value = 1e3 * recorded.columns["plant.slide.position"][row]
    assert [line(row) for line in lines] == [
        "t = 0.1500 s",
        "mode: Fast",
        "mode_out: Fast",
        f"slide.position: {number(value, 3)} mm",
    ]
    assert lines[1](50) == "mode: Slow"


def test_a_picture_shows_numbers_as_people_write_them() -> None:
    column = np.array([9.64e-15, 0.01548, -2.5e-6])
    speed = np.array([0.0, 1847.3, 1840.0])
    of: Any = SimpleNamespace(
        columns={"plant.gap": column, "plant.speed": speed}, units={"plant.gap": "m", "plant.speed": "rad/s"}
    )
    gap = caption.quantity(of, "plant.gap", "um", 1e6)
    assert [gap(row) for row in range(3)] == ["gap: 0 m", "gap: 15.5 mm", "gap: 0 m"]
    turns = caption.quantity(of, "plant.speed", "rpm", 30.0 / np.pi)
    assert turns(1) == "speed: 17640 rpm"
