"""The native engine and the reference loop are bit-identical, with every scenario file."""

from __future__ import annotations

import dataclasses
import itertools
import logging
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import cosim
from cosim.loop import repeats

from ..conftest import entry
from .loops import CHUNKS, both, chunked, outcome

Write = Callable[..., Path]
FOLDER = Path(__file__).parents[3] / "scenarios"
NAMES = [str(file.relative_to(FOLDER).with_suffix("").as_posix()) for file in sorted(FOLDER.rglob("*.toml"))]
LOOPS = [file.stem for file in sorted(FOLDER.glob("*.toml"))]
STEPS = 250


@pytest.mark.parametrize(
    ("name", "chunk", "delay"),
    [
        (name, *how)
        for name, how in zip(NAMES, itertools.cycle(itertools.product(CHUNKS, (0, 1))), strict=False)
    ],
)
def test_every_scenario_gives_the_same_bytes(
    name: str, chunk: int, delay: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    chunked(monkeypatch, chunk)
    loop = cosim.load(name).loop
    duration = f"loop.duration={min(STEPS, loop.steps) * loop.step!r}"
    reference, fast = both(cosim.load(name, set=[duration, f"loop.compute_delay={delay}"]))
    with reference, fast:
        assert fast.engine == "native"
        assert outcome(fast) == outcome(reference)


@pytest.mark.parametrize("loop", LOOPS)
def test_long_runs_end_in_the_same_row(loop: str) -> None:
    scenario = cosim.load(loop)
    steps = min(scenario.loop.steps, 24_000 // scenario.loop.substeps)
    reference, fast = both(cosim.load(loop, set=[f"loop.duration={steps * scenario.loop.step!r}"]))
    with reference, fast:
        assert outcome(fast, 50_061) == outcome(reference, 50_061)


@pytest.mark.parametrize("loop", LOOPS)
def test_threads_and_resets_change_nothing(loop: str) -> None:
    scenario = cosim.load(loop)
    scenario = cosim.load(loop, set=[f"loop.duration={1000 * scenario.loop.step!r}"])
    sessions = [cosim.Session(scenario, engine="native") for _ in range(2)]

    def work(number: int) -> list[tuple[bytes, bytes, float]]:
        return [outcome(sessions[number], seed) for seed in (50_062 + number, 50_064, 50_064)]

    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(work, range(2)))
    for session in sessions:
        session.close()
    # after another seed, after itself, and in a second thread, the result is that of a new instance
    with cosim.Session(scenario, engine="native") as fresh:
        assert [found[0][1], found[0][2], found[1][1]] == [outcome(fresh, 50_064)] * 3
    assert found[0][0] != found[1][0]


def test_other_threads_go_on_meanwhile(cart: Callable[..., Path], monkeypatch: pytest.MonkeyPatch) -> None:
    chunked(monkeypatch, 10**9)
    with cosim.Session(cosim.load(cart(), set=["loop.duration=60.0"]), engine="native") as session:
        thread = threading.Thread(target=session.run)
        thread.start()
        turns = 0
        while thread.is_alive():
            turns += 1
            thread.join(0.001)
    assert turns > 5


def test_no_clock_is_read_in_a_step(cart: Callable[..., Path]) -> None:
    with cosim.Session(cosim.load(cart()), engine="native") as session:
        session.run()
        plant: Any = session.plant
        assert not np.any(plant.data.timer.duration)


options = st.fixed_dictionaries(
    {
        "scale": st.floats(-2.0, 2.0),
        "offset": st.floats(-0.5, 0.5),
        "delay": st.integers(0, 4),
    },
    optional={
        "noise": st.floats(0.0, 0.1),
        "quantum": st.floats(0.0, 0.01),
        "minimum": st.floats(-1.0, 0.0),
        "maximum": st.floats(0.0, 1.0),
    },
)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    inwards=options,
    outwards=options,
    delay=st.integers(0, 1),
    every=st.sampled_from([1, 2, 7, 60]),
    substeps=st.integers(1, 4),
    chunk=st.integers(1, 100),
)
def test_every_option_of_a_wire_gives_the_same_bytes(
    cart: Callable[..., Path],
    inwards: dict[str, float],
    outwards: dict[str, float],
    delay: int,
    every: int,
    substeps: int,
    chunk: int,
) -> None:
    changes = [f"wire.controller.in.{key}={value!r}" for key, value in inwards.items()]
    changes += [f"wire.plant.drive.{key}={value!r}" for key, value in outwards.items()]
    changes += [f"loop.compute_delay={delay}", f"loop.record_every={every}"]
    changes += [f"loop.substeps={substeps}", f"loop.step={substeps * 0.0005!r}"]
    changes += [f"loop.duration={60 * substeps * 0.0005!r}"]
    reference, fast = both(cosim.load(cart(), set=changes))
    with reference, fast, pytest.MonkeyPatch.context() as patch:
        chunked(patch, chunk)
        assert outcome(fast) == outcome(reference)


STIMULI = (
    "\n"
    + entry("signal", to="controller.gain", times=[0.0, 0.01, 0.03], values=[-40.0, 3.0, -10.0])
    + entry("signal", to="plant.kick", times=[0.0, 0.015], values=[0.0, -0.0])
    + entry("inject", to="controller.in", from_time=0.011, to_time=0.013, value=0.7)
    + entry("inject", to="controller.count", from_time=0.02, to_time=0.04, value=-7)
    + entry("inject", to="plant.drive", from_time=0.03, to_time=0.035, value=-2.5)
    + entry("inject", to="plant.kick", from_time=0.04, to_time=1.0, value=0.1)
)


def test_signals_and_injections_give_the_same_bytes(cart: Callable[..., Path]) -> None:
    reference, fast = both(cosim.load(cart(STIMULI)))
    with reference, fast:
        expected = outcome(reference)
        assert outcome(fast) == expected
        trace = fast.run().trace
    assert trace is not None
    assert set(trace["controller.flag"]) == {0.0, 1.0}
    assert trace["controller.count"][25] == -7.0


KINDS: dict[str, dict[str, Any]] = {
    "frozen": {"frozen": True},
    "offset": {"offset": 0.3},
    "scale": {"scale": -0.7},
    "ramp": {"ramp": 3.7},
    "noise": {"noise": 0.1},
    "drop": {"drop": 0.4},
    "late": {"late": 3},
}
TARGETS = {
    "controller.in": list(KINDS),
    "controller.count": list(KINDS),
    "controller.flag": ["frozen", "drop", "late"],
    "controller.mode": ["frozen", "drop", "late"],
    "plant.drive": list(KINDS),
    "plant.kick": list(KINDS),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "begin",
    [{"from_time": 0.0123}, {"when": "controller.calls >= 10", "after": 0.0035}],
    ids=["time", "when"],
)
def test_every_kind_of_injection_gives_the_same_bytes(
    cart: Callable[..., Path], kind: str, begin: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    chunked(monkeypatch, 7)
    targets = [to for to, kinds in TARGETS.items() if kind in kinds]
    kick = "\n" + entry("signal", to="plant.kick", times=[0.0, 0.015, 0.02], values=[0.5, -0.5, 0.7])
    faults = "".join(entry("inject", to=to, **begin, **KINDS[kind]) for to in targets)
    with cosim.Session(cosim.load(cart(kick))) as sound:
        unchanged = outcome(sound)
    reference, fast = both(cosim.load(cart(kick + faults)))
    with reference, fast:
        expected = outcome(reference)
        assert expected != unchanged
        # a second run starts from the beginning
        assert outcome(fast) == outcome(fast) == expected
        assert fast.run().injected == reference.run().injected == pytest.approx([0.013] * len(targets))


WHEN = {
    "controller.calls >= 7": 0.007,
    "controller.mode == 'Fast'": 0.021,
    # numpy's own bits: looked at in Python after every step
    "sin(time) > sin(0.0255)": 0.027,
    "1 > 2": None,
}


@pytest.mark.parametrize("every", [1, 4])
@pytest.mark.parametrize("when", WHEN)
def test_the_same_row_begins_an_injection(cart: Callable[..., Path], when: str, every: int) -> None:
    added = entry("inject", to="controller.in", when=when, offset=0.2, duration=0.004)
    added += entry("inject", to="plant.drive", when="plant.slide.position > 1e-6", after=0.002, scale=-1.0)
    reference, fast = both(cosim.load(cart("\n" + added), set=[f"loop.record_every={every}"]))
    with reference, fast:
        assert outcome(fast) == outcome(reference)
        found = fast.run().injected
        assert found == reference.run().injected
    if every == 1:
        assert found[0] == (WHEN[when] and pytest.approx(WHEN[when]))


def test_a_command_that_nothing_drives_stays_at_its_start(cart: Callable[..., Path]) -> None:
    found = []
    for session in both(cosim.load(cart())):
        with session:
            plant: Any = session.plant
            drive, kick = plant.commands
            plant.commands = (drive, dataclasses.replace(kick, start=0.3))
            # a repetition would have the plant of the scenario
            repeats.first_runs.clear()
            found.append(outcome(session))
            assert plant.data.ctrl[1] == 0.3
    assert found[0] == found[1]


STOPS = {
    "controller.calls >= 7": 7,
    "not controller.flag and time > 0.0155 or controller.mode == 'Fast' and time < 0": 0,
    "0.01 < time <= 0.02": 12,
    "abs(-time + 2 * 0.01) < sqrt(1e-8) / 2": 21,
    "minimum(time, 0.0295) == maximum(0.0295, 0) and isfinite(time)": 31,
    # numpy's own bits: these are looked at in Python after every step
    "sin(time) > sin(0.0255)": 27,
    "where(time > 0.0305, true, false) == true": 32,
    "(time > 0.01) + (time > 0.02) == 2": 0,
    "time % 0.01 > 0.0095": 0,
    "1 > 2": 60,
}


@pytest.mark.parametrize("every", [1, 4])
@pytest.mark.parametrize("stop", STOPS)
def test_the_same_row_ends_the_run(cart: Callable[..., Path], stop: str, every: int) -> None:
    scenario = cosim.load(cart(), set=[f"loop.stop_when={stop}", f"loop.record_every={every}"])
    reference, fast = both(scenario)
    with reference, fast:
        expected = outcome(reference)
        assert outcome(fast) == expected
        if every == 1 and STOPS[stop]:
            assert expected[2] == pytest.approx(STOPS[stop] * 0.001)


def test_every_nth_row_is_recorded(cart: Callable[..., Path]) -> None:
    added = '[[metric]]\nname = "rows"\nvalue = "count(isfinite(time))"\n'
    whole, some = (cosim.run(cosim.load(cart(added), set=[f"loop.record_every={n}"])) for n in (1, 7))
    assert whole.trace is not None
    assert some.trace is not None
    assert some.trace.tobytes() == whole.trace[::7].tobytes()
    assert some.metrics["rows"].value == 9
    assert some.simulated_s == whole.simulated_s == 0.06


def test_a_plant_in_python_runs_in_the_reference_loop_without_a_warning(
    write: Write, caplog: pytest.LogCaptureFixture
) -> None:
    scenario = cosim.load(write())
    with caplog.at_level(logging.INFO, "cosim"):
        result = cosim.run(scenario)
    assert result.engine == "reference"
    assert result.trace is not None
    expected = cosim.run(scenario, engine="reference").trace
    assert expected is not None
    assert result.trace.tobytes() == expected.tobytes()
    assert [(record.levelname.lower(), record.getMessage()) for record in caplog.records] == [
        ("info", "the plant `probe_plants:Lag` runs in the reference engine: it is written in Python")
    ]


def test_progress_is_reported_alike(cart: Callable[..., Path]) -> None:
    scenario = cosim.load(cart(), set=["loop.duration=1.2"])
    reported: dict[str, list[tuple[int, int]]] = {"reference": [], "native": []}
    for session in both(scenario):
        with session:
            session.run(progress=lambda *step, engine=session.engine: reported[engine].append(step))
    assert reported["native"] == reported["reference"] == [(0, 1200), (500, 1200), (1000, 1200)]
