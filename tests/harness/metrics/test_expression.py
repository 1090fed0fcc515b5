"""The expression language: what it computes, and that it can do nothing else."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.errors import ExpressionError
from cosim.metrics.criteria import compile_metrics, unit_of
from cosim.metrics.expression import Expression, Items
from cosim.scenario.model import Metric
from cosim.trace.columns import InOrder
from cosim.trace.measure import measured

ITEMS = {"Idle": 1, "Detect": 4}
NAMES: dict[str, Items | None] = {
    "time": None,
    "plant.x": None,
    "controller.state": ITEMS,
    "controller.on": None,
    "controller.bias[1]": None,
    "controller.m[1,2]": None,
    "controller.der(x)": None,
}
TABLE = np.array(
    [
        [0.0, 1.0, 1.0, 0.0, 7.0, 8.0, 9.0],
        [0.1, -3.0, 4.0, 0.0, 7.0, 8.0, 9.0],
        [0.2, 2.0, 4.0, 1.0, 7.0, 8.0, 9.0],
        [0.3, 0.5, 1.0, 1.0, 7.0, 8.0, 9.0],
    ]
)


def evaluate(text: str) -> float:
    return float(Expression(text, NAMES, "`metric`")(TABLE.T))


VALUES = {
    "1 + 2 * 3 - 4 / 8": 6.5,
    "-2 ** 2": -4.0,
    "7 % 4": 3.0,
    "max(plant.x)": 2.0,
    "min(plant.x)": -3.0,
    "max(first(plant.x), 5)": 5.0,
    "mean(plant.x)": 0.125,
    "std(plant.x)": float(np.std(TABLE[:, 1])),
    "rms(plant.x)": float(np.sqrt(np.mean(TABLE[:, 1] ** 2))),
    "max(abs(plant.x))": 3.0,
    "first(plant.x)": 1.0,
    "last(plant.x)": 0.5,
    "median(plant.x)": 0.75,
    "percentile(plant.x, 50)": 0.75,
    "sum(plant.x > 0)": 3.0,
    "count(plant.x > 0)": 3.0,
    "any(plant.x < 0)": 1.0,
    "all(plant.x < 0)": 0.0,
    "sqrt(sum(where(controller.on, 4, 0)))": math.sqrt(8.0),
    "last(cummax(plant.x))": 2.0,
    "min(cummin(plant.x))": -3.0,
    "max(diff(plant.x))": 5.0,
    "max(plant.x[controller.on])": 2.0,
    "mean(plant.x[time >= 0.2])": 1.25,
    "first_time(plant.x < 0)": 0.1,
    "last_time(plant.x > 1)": 0.2,
    "first_time(plant.x > 99)": math.inf,
    "last_time(plant.x > 99)": -math.inf,
    "longest_time(plant.x < 0)": 0.1,
    "longest_time(controller.on)": 0.1,  # the trace ends, no next row
    "longest_time(plant.x > 0)": 0.1,
    "longest_time(plant.x > 99)": 0.0,
    "longest_time(1)": 0.3,
    "max(hypot(plant.x, 4))": 5.0,
    "last(hold(plant.x, plant.x < 0))": -3.0,
    "max(hold(plant.x, time < 0.15))": 1.0,
    "count(isfinite(hold(plant.x, controller.on)))": 2.0,
    'last(hold(controller.state, plant.x < 0)) == "Detect"': 1.0,
    'count(controller.state == "Detect")': 2.0,
    'count("Detect" != controller.state)': 2.0,
    'last(controller.state) == "Idle"': 1.0,
    'first(controller.state[controller.on]) == "Detect"': 1.0,
    "count(0 < plant.x < 2)": 2.0,
    "count((plant.x > 0) & ~(controller.on > 0))": 1.0,
    "count(plant.x > 0 and not controller.on)": 1.0,
    "count(plant.x < 0 or controller.on)": 3.0,
    "last(controller.bias[1])": 7.0,
    "last(controller.m[1,2])": 8.0,
    'last(column("controller.der(x)"))': 9.0,
    "pi": math.pi,
    "tan(1) - sin(1) / cos(1)": 0.0,
    "degrees(arctan2(1, -1)) + degrees(arcsin(1)) + degrees(arccos(0)) + degrees(arctan(1))": 360.0,
    "radians(180) / pi": 1.0,
    "log10(1000)": 3.0,
    "floor(-1.5) + ceil(-1.5) + round(2.5)": -1.0,
    "max(clip(plant.x, -1, 1.5))": 1.5,
    "ptp(plant.x)": 5.0,
    "last(cumsum(plant.x))": 0.5,
    "max(unwrap(plant.x))": 2.0 * math.pi - 3.0,
    "min(derivative(plant.x))": -40.0,
    "integral(plant.x)": -0.025,
    "at(plant.x, 0.2)": 2.0,
    "at(plant.x, 0.1999)": -3.0,
    "at(plant.x, 99)": 0.5,
    "isfinite(at(plant.x, -1))": 0.0,
    "isfinite(at(plant.x, nan))": 0.0,
    "isfinite(at(plant.x, first_time(plant.x > 99)))": 0.0,
    'at(controller.state, 0.1) == "Detect"': 1.0,
    "5 * um": 5e-6,
    "first(plant.x) / mm": 1000.0,
    "180 * deg": math.pi,
    "60 * rpm": 2.0 * math.pi,
    "max(\n    plant.x\n)": 2.0,
}


@pytest.mark.parametrize(("text", "value"), VALUES.items(), ids=VALUES.keys())
def test_value(text: str, value: float) -> None:
    assert evaluate(text) == pytest.approx(value)


UNITS = {
    "max(plant.x)": "m",
    "ptp(plant.x[controller.on])": "m",
    "2 * rms(plant.x - 1e-6) / 3": "m",
    "max(plant.x, 3 * mm)": "m",
    "-last(plant.x) % 2": "m",
    "where(plant.x > 0, plant.x, 0)": "m",
    "at(plant.x, 0.2)": "m",
    "max(derivative(plant.x))": "m/s",
    "last(plant.x) / mm": "",
    "last(plant.x) / 0.1": "m",
    "last(plant.x > 1 * mm)": "",
    "count(plant.x)": "",
    'last(controller.state) == "Idle"': "",
    "first_time(plant.x > 0) - 0.1": "s",
    "arctan2(1, 2)": "rad",
    "30 * deg": "rad",
    "last(plant.x) + 1 * N": None,
    "last(plant.x) ** 2": None,
    "last(plant.x) * last(plant.x)": None,
    "last(controller.on)": None,
    "max(controller.bias[1] - 0.1)": "1",
    "100 * max(controller.bias[1])": "",
    "max(controller.bias[1]) / 2": "",
    "max(controller.bias[1]) * plant.x": "m",
    "max(plant.x) / last(controller.bias[1])": "m",
    "last(plant.x) - last(controller.on)": "m",
    "integral(plant.x)": None,
    "derivative(derivative(plant.x))": None,
}


@pytest.mark.parametrize(("text", "unit"), UNITS.items(), ids=UNITS.keys())
def test_the_unit_is_reported_where_it_is_clear(text: str, unit: str | None) -> None:
    units = {"time": "s", "plant.x": "m", "controller.on": "", "controller.bias[1]": "1"}
    assert Expression(text, NAMES, "`metric`", units=units).unit == unit


@pytest.mark.parametrize("function", ["min", "max", "mean", "std", "rms", "first", "last", "median"])
def test_a_column_without_rows_has_no_value(function: str) -> None:
    assert math.isnan(evaluate(f"{function}(plant.x[time > 99])"))
    assert math.isnan(evaluate("percentile(plant.x[time > 99], 50)"))


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(0.1, 1e3))
def test_arithmetic_is_that_of_floats(a: float, b: float, c: float) -> None:
    assert evaluate(f"({a!r} + {b!r}) * {a!r} / {c!r} - {b!r}") == (a + b) * a / c - b


def test_numbers_never_become_huge() -> None:
    assert evaluate("9 ** 9 ** 9 ** 9") == math.inf
    assert math.isnan(evaluate("0 / 0"))


WRONG = {
    "plant.y": "names `plant.y`, which is not a known column of the trace\nhint: Use `plant.x`",
    "__import__('os')": "calls `__import__`, which is not a known function",
    "plant.x.__class__": "names `plant.x.__class__`, which is not a known column",
    "(1).__class__": "which is not a known column",
    "max.__globals__": "which is not a known column",
    "max(plant.x).real": "which is not a known column",
    "eval('1')": "calls `eval`, which is not a known function",
    "plant.x.sum()": "calls `plant.x.sum`, which is not a known function",
    "lambda: 1": "which is not supported",
    "[x for x in plant.x]": "which is not supported",
    "{1: 2}": "which is not supported",
    "f'{time}'": "which is not supported",
    "1 if time else 2": "which is not supported",
    "(x := 1)": "which is not supported",
    "1 << 99999": "which is not supported",
    "time is time": "which is not supported",
    "time @ time": "which is not supported",
    "'text'": "holds the text `text`",
    "time == 'Idle'": "compares `time` with a text, but it is not an enumeration",
    "controller.state == 'Detct'": "not one of its items\nhint: Use `Detect`",
    "max(plant.x, key=1)": "more than plain arguments",
    "max(*plant.x)": "more than plain arguments",
    "sqrt(1, 2)": "calls `sqrt` with 2 arguments instead of 1",
    "maxx(plant.x)": "not a known function\nhint: Use `max`",
    "column(1)": "exactly one name",
    "column('plant.z')": "which is not in the trace",
    "1 +": "is not an expression",
    "import os": "is not an expression",
    "1; 2": "is not an expression",
    "": "is not an expression",
    "1e999999 * 1" + "0" * 2000: "is longer than 2000 characters",
    "1" + "0" * 400: "a number that is too large",
    "(" * 300 + "1" + ")" * 300: "is not an expression",
    "-" * 1900 + "1": "is nested too deeply|is not an expression",
    "controller.bias[7]": "names `controller.bias\\[7\\]`",
}


@pytest.mark.parametrize(("text", "message"), WRONG.items(), ids=[text[:40] or "empty" for text in WRONG])
def test_what_the_language_does_not_have_is_rejected_when_it_is_compiled(text: str, message: str) -> None:
    with pytest.raises(ExpressionError, match=message) as caught:
        Expression(text, NAMES, "`metric.m.value`")
    assert caught.value.message.startswith("`metric.m.value` = `")


def test_a_condition_of_another_length_is_rejected() -> None:
    with pytest.raises(ExpressionError, match="cannot be computed"):
        evaluate("max(plant.x[plant.x[time > 0.05] > 0])")


def test_a_row_takes_the_same_expressions_but_nothing_that_needs_the_trace() -> None:
    row = Expression('controller.state == "Detect" and plant.x > 0', NAMES, "`stop`", rowwise=True)
    assert [bool(row(line)) for line in TABLE] == [False, False, True, False]
    for text in ("max(plant.x) > 1", "first_time(controller.on) > 1"):
        with pytest.raises(ExpressionError, match="needs the whole trace"):
            Expression(text, NAMES, "`stop`", rowwise=True)
    with pytest.raises(ExpressionError, match="one row at a time"):
        Expression("plant.x[controller.on]", NAMES, "`stop`", rowwise=True)


def test_a_metric_knows_the_others_with_their_units() -> None:
    metrics = (
        Metric("good", "metric.far <= 3 and metric.far > 2"),
        Metric("twice", "2 * metric.far"),
        Metric("far", "max(abs(plant.x))", "m"),
    )
    table = InOrder(dict(zip(NAMES, TABLE.T, strict=True)))
    good, twice, far = (one(table) for one in compile_metrics(metrics, NAMES))
    assert (far, bool(good), twice) == (3.0, True, 6.0)
    assert compile_metrics(metrics, NAMES)[1].unit == "m"
    with pytest.raises(ExpressionError, match=r"names `metric\.far`, which is not a known other metric"):
        compile_metrics(metrics[:2], NAMES)


class Counted(dict[str, Any]):
    """Columns that count how often they are read."""

    reads = 0

    def __getitem__(self, name: str) -> Any:
        self.reads += 1
        return super().__getitem__(name)


def test_a_metric_that_others_name_is_computed_once() -> None:
    chain = [Metric(f"m{i}", f"metric.m{i - 1} + metric.m{i - 1}") for i in range(1, 21)]
    metrics = (*chain[::-1], Metric("m0", "max(plant.x)", "m"))
    columns = Counted(zip(NAMES, TABLE.T, strict=True))
    found = measured(metrics, compile_metrics(metrics, NAMES), columns)
    assert (found["m20"].value, found["m20"].unit) == (2.0**20 * TABLE[:, 1].max(), "m")
    assert columns.reads == 1


def test_a_condition_on_a_row_knows_no_metric() -> None:
    with pytest.raises(ExpressionError, match=r"`metric\.far`, but metrics are available only in other"):
        Expression("metric.far > 1", NAMES, "`loop.stop_when`", rowwise=True)


def test_metrics_that_are_made_of_each_other_are_rejected() -> None:
    metrics = (Metric("far", "metric.near + 1"), Metric("near", "metric.far - 1"))
    with pytest.raises(ExpressionError, match=r"each other in a circle: `metric\.(far|near)` <- `metric\."):
        compile_metrics(metrics, NAMES)
    with pytest.raises(ExpressionError, match=r"names `metric\.far`, which is not a known other metric"):
        compile_metrics((Metric("far", "metric.far + 1"),), NAMES)


@pytest.mark.parametrize(
    ("value", "unit"),
    [("1e6 * max(plant.x)", "um"), ("max(plant.x) / um", "um"), ("max(plant.x)", "furlong")],
)
def test_a_metric_that_may_have_converted_keeps_the_unit_it_is_given(value: str, unit: str) -> None:
    metrics = (Metric("far", value, unit),)
    measured_one = compile_metrics(metrics, NAMES, {"plant.x": "m"})
    assert unit_of(metrics[0], measured_one[0]) == unit
