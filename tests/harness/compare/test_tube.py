"""The tolerance tube against values that follow from its definition."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.compare.tube import tube

RAMP = np.arange(11.0)


def inside(times: object, reference: object, at: object, values: object, **limits: object) -> list[bool]:
    """Whether values lie in the tube."""
    arguments = {"atol": 0.0, "rtol": 0.0, **limits}
    around = tube(*(np.array(x, dtype=float) for x in (times, reference, at)), **arguments)  # type: ignore[arg-type]
    found = np.array(values, dtype=float)
    return list(around.deviation(found) <= around.tolerance(found))


def test_without_time_shift_it_is_isclose() -> None:
    reference = np.array([-2.0, 0.0, 1e-9, 3.0])
    times = np.arange(4.0)
    for off in (-0.03, -0.01, 0.0, 0.01, 0.0305):
        values = reference + off
        expected = np.isclose(values, reference, rtol=0.01, atol=1e-3)
        assert inside(times, reference, times, values, atol=1e-3, rtol=0.01) == list(expected)


def test_a_ramp_may_be_as_much_higher_as_it_rises_in_the_time_shift() -> None:
    around = tube(RAMP, 2.0 * RAMP, RAMP, 0.0, 0.0, dt=0.25)
    assert around.low[1:-1] == pytest.approx(2.0 * RAMP[1:-1] - 0.5)
    assert around.high[1:-1] == pytest.approx(2.0 * RAMP[1:-1] + 0.5)
    # the ends are held
    assert (around.low[0], around.high[-1]) == (0.0, 20.0)


def test_the_peak_between_the_ends_of_the_window_counts() -> None:
    triangle = np.minimum(RAMP, 10.0 - RAMP)
    around = tube(RAMP, triangle, np.array([4.7]), 0.0, 0.0, dt=1.0)
    assert around.high[0] == 5.0
    assert around.low[0] == pytest.approx(3.7)


def test_a_step_may_come_earlier_or_later_by_the_time_shift_and_no_more() -> None:
    times = np.linspace(0.0, 1.0, 101)

    def step(at: float) -> object:
        return (times >= at - 1e-9).astype(float)

    for shift, good in ((0.05, True), (-0.05, True), (0.07, False), (-0.07, False)):
        found = inside(times, step(0.5), times, step(0.5 + shift), dt=0.05, stepped=True)
        assert all(found) == good


def test_what_is_held_has_no_values_between_its_rows() -> None:
    assert inside([0, 1, 2], [0, 1, 1], [0.5], [0.5], stepped=False) == [True]
    assert inside([0, 1, 2], [0, 1, 1], [0.5], [0.5], stepped=True) == [False]
    assert inside([0, 1, 2], [0, 1, 1], [0.5, 1.0, 1.5], [0, 1, 1], stepped=True) == [True] * 3


def test_a_row_at_the_same_time_is_compared_with_that_row_alone() -> None:
    # k * 0.1 and k / 10 differ in their last bits
    times, at = np.arange(50.0) * 0.1, np.arange(50.0) / 10.0
    assert np.any(times != at)
    reference = np.random.default_rng(1).normal(size=50)
    around = tube(times, reference, at, 0.0, 0.0)
    assert np.array_equal(around.low, reference)
    assert np.array_equal(around.high, reference)


@pytest.mark.parametrize("stepped", [False, True])
def test_nan_is_equal_to_nan_and_to_nothing_else(stepped: bool) -> None:
    reference, values = [1, math.nan, math.nan, 1], [math.nan, math.nan, 1, 1]
    found = inside(range(4), reference, range(4), values, atol=1e9, rtol=0.9, stepped=stepped)
    assert found == [False, True, False, True]


def test_infinities_are_equal_to_themselves() -> None:
    found = inside(range(3), [math.inf, math.inf, -math.inf], range(3), [math.inf, 1, math.inf], rtol=0.1)
    assert found == [True, False, False]


samples = st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=30)
eighths = st.integers(0, 100).map(lambda count: count / 8.0)


@given(samples, eighths, eighths, st.booleans())
def test_the_window_holds_exactly_what_the_reference_takes_in_it(
    values: list[float], dt: float, offset: float, stepped: bool
) -> None:
    times, reference = np.arange(float(len(values))), np.array(values)
    at = np.minimum(times + offset, times[-1])
    around = tube(times, reference, at, 0.0, 0.0, dt, stepped)
    for moment, low, high in zip(at, around.low, around.high, strict=True):
        # a line between samples has its extremes at its ends
        window = np.array([moment - dt, *times[np.abs(times - moment) <= dt], moment + dt])
        window = np.clip(window, 0.0, times[-1])
        held = reference[np.searchsorted(times, window, side="right") - 1]
        taken = held if stepped else np.interp(window, times, reference)
        assert (low, high) == pytest.approx((taken.min(), taken.max()))
