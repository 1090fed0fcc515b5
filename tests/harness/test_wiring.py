"""The mathematics of wires."""

from __future__ import annotations

import math
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.errors import CosimError
from cosim.loop.time_series import sample
from cosim.loop.wires.transform import Delay, child, first_step, noise, shaper
from cosim.scenario.model import Wire

from .data.probe_plants import Channel

numbers = st.floats(-1e6, 1e6)
quanta = st.floats(1e-9, 1e3)
PLAIN = Channel("x")


@given(numbers, quanta)
def test_quantising_twice_is_quantising_once(value: float, quantum: float) -> None:
    shape = shaper(Wire("plant.x", "controller.in", quantum=quantum), PLAIN, True, None)
    once = shape(value, 0)
    assert shape(once, 1) == once
    assert abs(once - value) <= 0.5 * quantum * (1.0 + 1e-9) + 1e-9 * abs(value)


def test_quantising_rounds_half_to_even_as_numpy_does() -> None:
    shape = shaper(Wire("plant.x", "controller.in"), Channel("x", quantum=0.5), True, None)
    halves = np.arange(-2.25, 2.5, 0.5)
    assert [shape(value, 0) for value in halves] == list(np.round(halves / 0.5) * 0.5)


@given(st.floats(1.0, 1e6))
def test_a_quantum_finer_than_any_value_changes_none(value: float) -> None:
    wire = Wire("plant.x", "controller.in", quantum=sys.float_info.min)
    assert shaper(wire, PLAIN, True, None)(value, 0) == value


@given(numbers, st.floats(-10.0, 0.0), st.floats(0.0, 10.0))
def test_limits_hold_and_leave_the_inside_alone(value: float, minimum: float, maximum: float) -> None:
    shape = shaper(Wire("controller.out", "plant.u", minimum=minimum, maximum=maximum), PLAIN, False, None)
    assert minimum <= shape(value, 0) <= maximum
    if minimum <= value <= maximum:
        assert shape(value, 0) == value


@given(st.lists(numbers, min_size=1, max_size=40), st.integers(0, 10))
def test_a_delay_shifts_by_whole_steps_and_starts_with_the_first_value(
    values: list[float], steps: int
) -> None:
    delay = Delay(steps)
    delayed = [delay(value, k) for k, value in enumerate(values)]
    assert delayed == ([values[0]] * steps + values)[: len(values)]


def test_a_primed_delay_starts_with_what_it_was_given() -> None:
    delay = Delay(2)
    delay.prime(7.0)
    assert [delay(value, k) for k, value in enumerate([1.0, 2.0, 3.0])] == [7.0, 7.0, 1.0]


def test_noise_quantum_and_limits_act_in_the_unit_of_the_plant() -> None:
    channel = Channel("x", quantum=1.0, maximum=5.0)
    reading = shaper(Wire("plant.x", "controller.in", scale=100.0, offset=1.0), channel, True, None)
    command = shaper(Wire("controller.out", "plant.u", scale=0.01, offset=1.0), channel, False, None)
    assert reading(2.4, 0) == 201.0
    assert reading(9.0, 0) == 501.0
    assert command(140.0, 0) == 2.0
    assert command(1e6, 0) == 5.0


def test_a_wire_overrides_its_channel() -> None:
    channel = Channel("x", noise=1.0, quantum=1.0, minimum=-1.0, maximum=1.0)
    wire = Wire("plant.x", "controller.in", noise=0.0, quantum=0.0, minimum=-math.inf, maximum=math.inf)
    assert noise(wire, channel, 1, 10) is None
    assert shaper(wire, channel, True, None)(123.4, 0) == 123.4


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("from_plant", [True, False])
def test_a_limit_does_not_hide_what_is_not_finite(value: float, from_plant: bool) -> None:
    shape = shaper(Wire("plant.x", "controller.in", minimum=0.0, maximum=1.0), PLAIN, from_plant, None)
    with pytest.raises(CosimError, match="must be finite"):
        shape(value, 0)


def test_noise_depends_on_seed_and_target_only() -> None:
    channel = Channel("x", noise=2.0)
    first = noise(Wire("plant.x", "controller.in"), channel, 5, 20_000)
    again = noise(Wire("plant.other", "controller.in"), channel, 5, 20_000)
    other = noise(Wire("plant.x", "controller.count"), channel, 5, 20_000)
    assert first is not None
    assert again is not None
    assert other is not None
    assert first.tobytes() == again.tobytes()
    assert abs(np.corrcoef(first, other)[0, 1]) < 0.03
    assert np.std(first) == pytest.approx(2.0, rel=0.03)
    assert abs(np.mean(first)) < 0.05


def test_children_of_a_seed_differ_by_name_and_seed() -> None:
    states = {tuple(child(seed, name).generate_state(2)) for seed in (1, 2) for name in ("plant", "wire.a")}
    assert len(states) == 4


@given(st.integers(0, 10**7), st.sampled_from([1e-3, 1e-4, 2e-5, 1 / 3000]))
def test_the_first_step_of_a_grid_time_is_its_index(k: int, step: float) -> None:
    assert first_step(k * step, step) == k
    assert first_step((k + 0.5) * step, step) == k + 1


def test_a_signal_holds_each_value_from_its_time_on() -> None:
    times, values = (0.0, 0.002, 0.0025), [1.0, 2.0, 3.0]
    assert sample(times, values, 0.001, 5).tolist() == [1.0, 1.0, 2.0, 3.0, 3.0]


def test_a_stream_keeps_the_noise_of_a_renamed_target() -> None:
    old, new = (Wire(source="plant.x", to=to, noise=1.0) for to in ("controller.a", "controller.b"))
    kept = replace(new, stream=old.to)
    old_noise, new_noise, kept_noise = (noise(wire, PLAIN, 7, 5) for wire in (old, new, kept))
    assert old_noise is not None
    assert new_noise is not None
    assert kept_noise is not None
    assert np.array_equal(old_noise, kept_noise)
    assert not np.array_equal(old_noise, new_noise)
