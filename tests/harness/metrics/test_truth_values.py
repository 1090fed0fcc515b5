"""Truth values are the numbers 1.0 and 0.0: every expression computes as numpy with 64-bit floats."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cosim
from cosim.errors import ExpressionError
from cosim.fmu.description import Variable
from cosim.loop import condition
from cosim.metrics.expression import Expression, Items

from ..conftest import SCENARIO, entry

Write = Callable[..., Path]
Pair = tuple[str, Callable[[Any, Any], Any]]
"""Text of an expression of `p.a` and `p.b`, and the same with numpy."""
NAMES: dict[str, Items | None] = {"time": None, "p.a": None, "p.b": None}


def truth(found: Any) -> Any:
    return np.where(found, 1.0, 0.0)


UNARY: dict[str, Callable[[Any], Any]] = {
    "-{}": np.negative,
    "not {}": lambda x: truth(x == 0.0),
    "abs({})": np.abs,
    "sin({})": np.sin,
    "round({})": np.rint,
    "isfinite({})": lambda x: truth(np.isfinite(x)),
}
BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "{} + {}": np.add,
    "{} - {}": np.subtract,
    "{} * {}": np.multiply,
    "{} / {}": np.divide,
    "hypot({}, {})": np.hypot,
    "maximum({}, {})": np.maximum,
    "{} < {}": lambda x, y: truth(x < y),
    "{} >= {}": lambda x, y: truth(x >= y),
    "{} == {}": lambda x, y: truth(x == y),
    "{} != {}": lambda x, y: truth(x != y),
    "{} and {}": lambda x, y: truth((x != 0.0) & (y != 0.0)),
    "{} or {}": lambda x, y: truth((x != 0.0) | (y != 0.0)),
}


def unary(inner: Pair, name: str) -> Pair:
    text, compute = inner
    return f"({name.format(text)})", lambda a, b: UNARY[name](compute(a, b))


def binary(left: Pair, right: Pair, name: str) -> Pair:
    text = f"({name.format(left[0], right[0])})"
    return text, lambda a, b: BINARY[name](left[1](a, b), right[1](a, b))


LEAVES: list[Pair] = [
    ("p.a", lambda a, b: a),
    ("p.b", lambda a, b: b),
    ("2", lambda a, b: np.full_like(a, 2.0)),
]
PAIRS = st.recursive(
    st.sampled_from(LEAVES),
    lambda inner: st.one_of(
        st.builds(unary, inner, st.sampled_from([*UNARY])),
        st.builds(binary, inner, inner, st.sampled_from([*BINARY])),
    ),
    max_leaves=8,
)
NUMBERS = st.lists(st.floats(width=64), min_size=4, max_size=4)


@given(PAIRS, NUMBERS, NUMBERS)
def test_expressions_compute_as_numpy_with_floats(
    pair: Pair, first: list[float], second: list[float]
) -> None:
    a, b = np.array(first), np.array(second)
    with np.errstate(all="ignore"):
        wanted = pair[1](a, b)
    found = np.broadcast_to(Expression(pair[0], NAMES, "`m`")([np.arange(4.0), a, b]), (4,))
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, wanted)
    on_row = Expression(pair[0], NAMES, "`m`", rowwise=True)
    rows = [on_row(row) for row in np.array([np.arange(4.0), a, b]).T]
    assert {np.asarray(value).dtype for value in rows} == {np.dtype(np.float64)}
    np.testing.assert_allclose(rows, wanted, rtol=1e-15)


VALUES = {
    "integral(time >= 0)": 0.3,
    "max((time >= 0) + (time >= 0.1))": 2.0,
    "min(diff(time < 0.1))": -1.0,
    "max(sin(time >= 0))": float(np.sin(1.0)),
    "min((p.a > 0) - (p.b > 0))": -1.0,
    "ptp(p.a > 0)": 1.0,
    "percentile(p.a > 0, 50)": 0.5,
    "min(derivative(time < 0.15))": -5.0,
    "-any(p.a > 0)": -1.0,
    "all(p.a > 0) - all(p.b > 0)": -1.0,
    "min(-isfinite(p.a))": -1.0,
    "count(p.a > 99) % count(p.a > 99)": np.nan,
    "count(p.a > 0) ** -1": 0.5,
    "count(p.a[p.a] < 99)": 4.0,
}


@pytest.mark.parametrize(("text", "value"), VALUES.items(), ids=VALUES.keys())
def test_a_condition_is_a_number(text: str, value: float) -> None:
    table = [0.1 * np.arange(4.0), np.array([1.0, -1.0, 2.0, -2.0]), np.ones(4)]
    found = Expression(text, NAMES, "`m`")(table)
    assert np.asarray(found).dtype == np.float64
    assert found == pytest.approx(value, nan_ok=True)


def variable(kind: str) -> Variable:
    return Variable("on", 0, kind, "output", "discrete", "", "", "", "", "")


@pytest.mark.parametrize(
    ("text", "accepted"),
    [
        ("c.on", True),
        ('column("c.on")', True),
        ("c.x > 0", True),
        ("where(c.on, c.x > 0, c.x < 0)", True),
        ("minimum(c.x > 0, c.on > 0)", True),
        ("(c.x > 0) * (c.x < 1)", True),
        ("c.x", False),
        ("c.x - (c.x > 0)", False),
        ("where(c.x > 0, c.x, 1)", False),
    ],
)
def test_only_what_is_true_or_false_is_a_condition(text: str, accepted: bool) -> None:
    columns = {"time": None, "c.on": variable("Boolean"), "c.x": variable("Real")}
    if accepted:
        assert condition.compiled(text, "loop.stop_when", columns) is not None
        return
    with pytest.raises(ExpressionError, match="is not a condition"):
        condition.compiled(text, "loop.stop_when", columns)


NEVER = entry("metric", name="beyond", value="any(plant.x > 10)") + entry(
    "criterion", id="never", claim="never beyond", metric="beyond", equals=False
)
NAN = """
from probe_plants import Channel, Lag, math, np

class Lost(Lag):
    truths = (*Lag.truths, Channel("lost"), Channel("good"))
    readings = (*Lag.readings, Channel("unwired"), Channel("first"))

    def truth(self):
        return np.array([*super().truth(), math.nan if self.n == 7 else 0.0, 0.0])

    def sense(self):
        return np.array([*super().sense(), math.nan if self.n == 3 else 0.0, 0.0 if self.n else math.nan])
"""


def test_a_column_or_measurement_with_nan_is_reported_once_in_a_run(
    write: Write, folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (folder / "nan_plants.py").write_text(NAN)
    file = write(NEVER.replace("plant.x", "plant.lost"))
    for _ in range(2):
        assert cosim.run(cosim.load(file, set=["plant.name=nan_plants:Lost"])).passed is True
    reported = [text for text in caplog.messages if "was NaN during the run" in text]
    assert [text.split()[0] for text in reported] == ["`plant.lost`", "`plant.unwired`", "`plant.first`"] * 2


def test_an_output_with_nan_is_reported(write: Write, folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    text = SCENARIO.split("[[wire]]")[0].replace('"plant.extra"', '"plant.extra", "plant.u", "controller.in"')
    cosim.run(cosim.load(write(text=text), set=["controller.nan_at=5"]))
    assert [text.split()[0] for text in caplog.messages if "NaN" in text] == ["`controller.out`"]
