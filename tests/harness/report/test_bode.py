"""Margins of an open loop from a closed one, as charts of a page."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cosim.errors import ScenarioError
from cosim.metrics import drawable
from cosim.report import charts, curves, drawing
from cosim.scenario.model import Chart, Controller, Loop, Plot, Scenario
from cosim.trace.columns import Array, Held

from .traces import texts

OMEGA: Array = np.geomspace(0.05, 20.0, 60)


def open_loop(omega: Any) -> Any:
    """Three equal lags: the phase is -180 degrees at sqrt(3), where the gain is 4 / 8."""
    return 4.0 / (1.0 + 1j * np.asarray(omega)) ** 3


def row(response: Any) -> Held:
    """Trace of one row with a response in numbered columns, and an index that was never set."""
    values = {"time": 0.0}
    for i, (omega, one) in enumerate(zip([*OMEGA, 0.0], [*response, 0.0], strict=True), start=1):
        values |= {f"a.f[{i}]": omega, f"a.m[{i}]": abs(one), f"a.p[{i}]": np.angle(one)}
    table = np.zeros(1, dtype=[(name, np.float64) for name in values])
    for name, value in values.items():
        table[name] = value
    return Held(table)


CROSSOVER = math.sqrt(4.0 ** (2.0 / 3.0) - 1.0)
PHASE_MARGIN = math.pi - 3.0 * math.atan(CROSSOVER)


@pytest.mark.parametrize("closed", [False, True])
def test_margins_are_those_of_the_formula(closed: bool) -> None:
    loop = open_loop(OMEGA)
    given = loop / (1.0 + loop) if closed else loop
    found = curves.response(OMEGA, np.abs(given), np.angle(given), closed)
    assert found is not None
    phase, gain = found.phase_margin(), found.gain_margin()
    assert phase is not None
    assert gain is not None
    assert (phase.frequency, phase.value) == pytest.approx((CROSSOVER, PHASE_MARGIN), rel=0.01)
    assert (gain.frequency, gain.value) == pytest.approx((math.sqrt(3.0), 2.0), rel=0.01)


def test_an_unstable_loop_has_a_negative_phase_margin_and_no_gain_margin() -> None:
    given = 3.0 * open_loop(OMEGA)
    found = curves.response(OMEGA, np.abs(given), np.angle(given), closed=False)
    assert found is not None
    phase = found.phase_margin()
    assert phase is not None
    assert phase.value == pytest.approx(
        math.pi - 3.0 * math.atan(math.sqrt(12.0 ** (2.0 / 3.0) - 1.0)), rel=0.02
    )
    assert phase.value < 0.0
    assert found.gain_margin() is None


def test_a_loop_below_one_has_no_crossover() -> None:
    given = 0.2 * open_loop(OMEGA)
    found = curves.response(OMEGA, np.abs(given), np.angle(given), closed=False)
    assert found is not None
    assert found.phase_margin() is None


CHART = Chart("bode", ("a.m", "a.p"), x="a.f", title="Loop", closed=True, x_unit="Hz", x_scale=1.0 / math.tau)


def test_a_chart_of_the_kind_bode_is_two_charts_with_marks() -> None:
    loop = open_loop(OMEGA)
    gain, phase = charts.open_loop(CHART, row(loop / (1.0 + loop)))
    assert [one.chart.title for one in (gain, phase)] == ["Loop: gain", "Loop: phase"]
    assert [one.levels for one in (gain, phase)] == [[(1.0, "")], [(-180.0, "")]]
    assert (gain.chart.log, phase.chart.log, gain.chart.x_log, gain.x_label) == (True, False, True, "Hz")
    for one in (gain, phase):
        (crossover, first), (reversal, second) = one.marks
        assert crossover == pytest.approx(CROSSOVER / math.tau, rel=0.01)
        assert reversal == pytest.approx(math.sqrt(3.0) / math.tau, rel=0.01)
        assert first.startswith("phase margin 27.")
        assert second.startswith(("gain margin 2.0", "gain margin 1.99"))
        # both are in the drawing for print, too
        assert {first, second} <= set(texts(drawing.charts([one])))


def test_without_a_response_there_is_no_chart() -> None:
    assert charts.open_loop(CHART, row(np.zeros(60))) == []


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"y": ("a.m",)}, "has 1 `y` and needs 2"),
        ({"x": ""}, "has no `x`"),
        ({"kind": "path"}, "does not accept `closed`"),
        ({"y": ("a.m", "a.q")}, "names `a.q[1]`"),
    ],
)
def test_a_wrong_chart_is_rejected(change: Any, words: str) -> None:
    drawn = Plot(charts=(replace(CHART, **change),))
    scenario = Scenario("t", loop=Loop(step=1e-3, duration=1.0), controller=Controller("x"), plot=drawn)
    with pytest.raises(ScenarioError) as caught:
        drawable.check(scenario, dict.fromkeys(row(np.zeros(60))))
    assert words in str(caught.value)
