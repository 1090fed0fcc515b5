"""Charts that are not over the time, what is marked in plots, and where limits come from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim.errors import CosimError
from cosim.formatting.quantity import prefixed
from cosim.metrics import drawable
from cosim.metrics.criteria import Verdict
from cosim.report import charts, curves, drawing
from cosim.report.charts import ChartData
from cosim.report.scenario_section import numbers, origin
from cosim.scenario.model import Chart, Criterion, Panel, Plot
from cosim.show import plot
from cosim.trace.columns import Held

from .traces import ROWS, TIME, lines, points, result, scenario, texts, traced, unpacked


def drawn(chart: Chart, trace: Held) -> ChartData:
    return ChartData(chart, charts.lines(chart, charts.evaluator(chart, trace, dict.fromkeys(trace))))


def test_a_path_has_a_line_for_each_value_of_its_split() -> None:
    trace = traced(plant_x=TIME, plant_y=TIME**2, plant_n=np.floor(TIME))
    chart = Chart("path", ("plant.y",), x="plant.x", split="plant.n", split_name="push", x_scale=1e3)
    found = lines(chart, trace)
    assert list(found) == ["push 0", "push 1", "push 2", "push 3"]
    x, y = found["push 2"]
    assert (x[0], x[-1]) == pytest.approx((2000.0, 2999.0))
    assert y == pytest.approx((1e-3 * x) ** 2)


def test_what_does_not_move_is_left_out() -> None:
    rounding = 1e-12 * np.sin(TIME)
    trace = traced(plant_x=1.0 + rounding, plant_y=2.0 + rounding, plant_z=TIME)
    assert lines(Chart("path", ("plant.y",), x="plant.x"), trace) == {}
    assert list(lines(Chart("path", ("plant.y", "plant.z"), x="plant.x"), trace)) == ["plant.z"]


def test_a_path_of_many_rows_keeps_its_peaks() -> None:
    peaked = np.where(np.arange(ROWS) == 1234, 50.0, 0.0)
    (x, y) = lines(Chart("path", ("plant.y",), x="plant.x"), traced(plant_x=TIME, plant_y=peaked))["plant.y"]
    assert len(x) <= curves.MAX_POINTS
    assert x[np.argmax(y)] == TIME[1234]
    assert y.max() == 50.0


def test_a_path_of_many_rows_keeps_extremes_next_to_what_is_no_number() -> None:
    away = np.where(np.arange(ROWS) == 1234, 50.0, 3.0)
    least = np.where(np.arange(ROWS) == 2345, 1.0, np.where(np.arange(ROWS) % 2, np.nan, 7.0))
    (x, y) = lines(Chart("path", ("plant.y",), x="plant.x"), traced(plant_x=away, plant_y=least))["plant.y"]
    assert (x.max(), np.nanmin(y)) == (50.0, 1.0)
    assert np.isfinite(y).mean() > 0.9


def test_a_spectrum_takes_the_longest_stretch_without_a_gap() -> None:
    wave = np.where(np.arange(ROWS) == 3404, np.nan, 0.25 * np.sin(2.0 * np.pi * 50.0 * TIME))
    # rows 0, 2, 4 are not neighbors
    trace = traced(plant_e=wave, plant_p=np.where((TIME < 0.005) & (np.arange(ROWS) % 2 == 1), 0.0, 1.0))
    ((x, y),) = lines(Chart("spectrum", ("plant.e",), parts=("plant.p",)), trace).values()
    assert x[np.argmax(y)] == pytest.approx(50.0, abs=0.5)
    assert (y.max(), x.max()) == (pytest.approx(0.25, rel=0.01), pytest.approx(500.0, rel=0.01))


def test_a_spectrum_leaves_out_rows_without_an_angle() -> None:
    angle = np.where(np.arange(ROWS) == ROWS - 1, np.nan, 2.0 * np.pi * 5.3 * TIME)
    wave = 2.0 * np.cos(4.0 * 2.0 * np.pi * 5.3 * TIME)
    ((_, y),) = lines(
        Chart("spectrum", ("plant.e",), x="plant.a"), traced(plant_a=angle, plant_e=wave)
    ).values()
    assert y[3] == pytest.approx(2.0, rel=1e-2)


@pytest.mark.parametrize("kind", ["path", "map", "share", "spectrum", "peaks"])
def test_a_chart_of_picked_rows_loses_no_other(kind: Any) -> None:
    trace = traced(plant_x=TIME, plant_y=TIME**2)
    more: Any = (
        {"split": "plant.x"} if kind == "peaks" else {"x": "plant.x"} if kind in ("path", "map") else {}
    )
    picked = Chart(kind, ("plant.y[plant.x > 1]",), title="Depth", **more)
    whole = Chart("path", ("plant.y",), x="plant.x", title="Way")
    of, found = result(trace, "max(plant.x)", maximum=4.0)
    shown, (reported,) = charts.of_run(replace(of, plot=Plot(charts=(picked, whole))), found)
    assert [data.chart.title for data in shown] == ["Way"]
    assert reported.startswith(
        "`plot.charts` `Depth` = `plant.y[plant.x > 1]` gives 2999 values for 4000 rows"
    )
    assert "hint: Select rows with `parts`" in reported


def test_a_spectrum_over_an_angle_shows_waves_per_revolution() -> None:
    # the speed changes, the waves do not
    angle = 2.0 * np.pi * (5.3 * TIME + 0.2 * TIME**2)
    wave = 3.0 + 2.0 * np.cos(4.0 * angle + 0.3) + 0.5 * np.sin(12.0 * angle)
    trace = traced(plant_a=angle, plant_e=wave)
    x, y = lines(Chart("spectrum", ("plant.e",), x="plant.a"), trace)["plant.e"]
    assert list(x) == list(range(1, curves.ORDERS + 1))
    assert y[3] == pytest.approx(2.0, rel=1e-2)
    # straight lines between the rows take a little of a wave of 12 rows
    assert y[11] == pytest.approx(0.5, rel=3e-2)
    assert np.delete(y, [3, 11]).max() < 0.01


def test_a_spectrum_by_frequency_finds_the_amplitude_of_a_sine() -> None:
    trace = traced(plant_e=7.0 + 0.25 * np.sin(2.0 * np.pi * 50.0 * TIME))
    x, y = lines(Chart("spectrum", ("plant.e",), parts=("time >= 2",)), trace)["plant.e, time >= 2"]
    assert x[np.argmax(y)] == pytest.approx(50.0, abs=0.5)
    assert y.max() == pytest.approx(0.25, rel=0.01)


def test_less_than_per_revolution_has_no_spectrum() -> None:
    trace = traced(plant_a=TIME, plant_e=TIME)
    assert lines(Chart("spectrum", ("plant.e",), x="plant.a"), trace) == {}


def test_peaks_and_ratios() -> None:
    trace = traced(plant_e=np.where(TIME < 1.0, -9.0, TIME), plant_n=np.floor(TIME))
    x, y = lines(Chart("peaks", ("plant.e",), split="plant.n"), trace)["plant.e"]
    assert list(x) == [0.0, 1.0, 2.0, 3.0]
    assert list(y) == pytest.approx([9.0, 1.999, 2.999, 3.999])
    x, y = lines(Chart("share", ("plant.e",)), trace)["plant.e"]
    assert np.interp(2.5, x, y) == pytest.approx(0.625, abs=2e-3)
    assert (np.diff(y) > 0.0).all()
    assert y[-1] == 1.0


def test_a_threshold_finds_and_takes_wrongly() -> None:
    # in air 0 .. 0.5, in contact 0.25 .. 0.75: half of the contact is found before the first wrong one
    first = TIME < 2.0
    trace = traced(plant_y=np.where(first, 0.25 * TIME, 0.25 + 0.25 * (TIME - 2.0)))
    chart = Chart("roc", ("plant.y",), parts=("time < 2", "time >= 2"), names=("slope",))
    wrong, found = lines(chart, trace)["slope"]
    assert (wrong[0], found[0], wrong[-1], found[-1]) == (0.0, 0.0, 1.0, 1.0)
    assert np.all(np.diff(wrong) >= 0.0)
    assert np.all(np.diff(found) >= 0.0)
    assert np.interp(0.25, wrong, found) == pytest.approx(0.75, abs=2e-3)
    assert found[wrong == 0.0].max() == pytest.approx(0.5, abs=2e-3)
    # without a row of one of them there is nothing to part
    assert lines(replace(chart, parts=("time < 2", "time > 9")), trace) == {}


def test_a_map_sums_up_in_cells() -> None:
    # a square that is gone round twice, its right side at three times the weight
    way = np.arange(ROWS) / ROWS * 8.0 % 4.0
    x = np.interp(way, [0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 1.0, 0.0, 0.0])
    y = np.interp(way, [0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 0.0, 1.0, 1.0, 0.0])
    weight = np.where((way > 1.0) & (way < 2.0), 3.0, 1.0)
    trace = traced(plant_x=x, plant_y=y, plant_w=weight)
    chart = Chart("map", ("plant.y",), x="plant.x", weight="plant.w", x_scale=1e3, equal=True)
    cells = charts.map_cells(chart, charts.evaluator(chart, trace, dict.fromkeys(trace)))
    assert cells is not None
    assert cells.parts.shape == (charts.CELLS, charts.CELLS)
    assert (cells.x[0], cells.x[-1], len(cells.x)) == pytest.approx((0.0, 1e3, charts.CELLS + 1))
    inner = slice(5, -5)
    assert cells.parts[inner, -1].mean() == pytest.approx(3.0 * cells.parts[inner, 0].mean(), rel=0.05)
    assert not cells.parts[inner, inner].any()
    packed = ChartData(chart, cells=cells).packed()["cells"]
    assert unpacked(packed) == pytest.approx(cells.parts.ravel(), abs=1e-4)
    assert "<image" in drawing.charts([ChartData(replace(chart, equal=False), cells=cells)])
    nothing = replace(chart, parts=("plant.x > 2",))
    assert charts.map_cells(nothing, charts.evaluator(nothing, trace, dict.fromkeys(trace))) is None


@pytest.mark.parametrize(
    ("chart", "message"),
    [
        (Chart("path", ("plant.x",)), "`plot.charts[0]` of the kind `path` has no `x`"),
        (Chart("peaks", ("plant.x",)), "has no `split`"),
        (Chart("roc", ("plant.x",), parts=("time < 1",)), "of the kind `roc` has 1 `parts` and needs 2"),
        (Chart("roc", ("plant.x",), parts=("time < 1", "time > 1"), names=("a", "b")), "2 names for 1 lines"),
        (Chart("path", ("plant.y",), x="plant.x"), "`plant.y`, which is not a known column"),
        (Chart("bode", ("plant.x", "plant.x"), x="plant.x"), "`plant.x[1]`, which is not a column"),
        (Chart("share", ("plant.x",), names=("a", "b")), "2 names for 1 lines"),
        (Chart("share", ("plant.x",), split="time"), "of the kind `share` does not accept `split`"),
        (Chart("map", ("plant.x",), x="time", names=("a",)), "of the kind `map` does not accept `names`"),
        (Chart("map", ("plant.x",), x="time", log=True), "of the kind `map` does not accept `log`"),
        (Chart("map", ("plant.x", "time"), x="time"), "of the kind `map` has 2 `y` and needs 1"),
        (Chart("spectrum", ("plant.x",), weight="time"), "of the kind `spectrum` does not accept `weight`"),
        (Chart("polar", ("plant.x",)), "of the kind `polar` has no `x`"),
        (Chart("path", ("plant.x",), x="time", error="time"), "has an `error` and no `equal`"),
        (
            Chart("path", ("plant.x",), x="time", error="plant.z", equal=True),
            "`plant.z`, which is not a known column",
        ),
        (Chart("bode", ("plant.x",), x="plant.x", parts=("time",)), "kind `bode` does not accept `parts`"),
    ],
)
def test_what_cannot_be_drawn_is_reported(chart: Chart, message: str) -> None:
    with pytest.raises(CosimError) as reported:
        drawable.check(scenario(chart), {"time": None, "plant.x": None})
    assert message in str(reported.value)


@pytest.mark.filterwarnings("error")
def test_a_trace_of_the_time_alone_has_no_panels(tmp_path: Path) -> None:
    of, found = result(traced(), "max(time)", maximum=4.0)
    assert plot.views(of, found)[0].panels == []
    plot.save(of, found, tmp_path / "plot.svg")


def test_only_what_is_whole_in_the_trace_is_drawn_in_steps() -> None:
    trace = traced(plant_x=np.where(TIME < 2.0, 0.0, 1e-9), plant_n=np.floor(TIME))
    of, found = result(trace, "max(plant.x)", maximum=4.0)
    of = replace(of, plot=Plot(panels=(Panel(("plant.x",)), Panel(("plant.n",), "m"))))
    shown = plot.views(of, found)[0].panels
    assert shown[0].unit == "nm"
    assert [panel.curves[0].stepped for panel in shown] == [False, True]


def test_panels_of_what_moves_show_what_they_leave_out() -> None:
    trace = traced(**{f"plant_x{i}": (i + 1.0) * TIME for i in range(20)})
    units = {f"plant.x{i}": "m" if i < 12 else f"u{i}" for i in range(20)}
    made = plot.default_panels(trace, replace(result(trace, "max(plant.x0)")[1], units=units))
    assert [len(panel.columns) for panel in made] == [8, 1, 1, 1, 1, 1]
    assert [panel.title for panel in made] == ["and 4 more columns", "", "", "", "", "and 3 more units"]


def test_lines_of_several_values_with_a_split_show_both() -> None:
    trace = traced(plant_x=TIME, plant_y=TIME, plant_z=-TIME, plant_n=np.floor(TIME / 2.0))
    chart = Chart("path", ("plant.y", "plant.z"), x="plant.x", split="plant.n", split_name="push")
    assert list(lines(chart, trace)) == [f"plant.{y}, push {n}" for y in "yz" for n in (0, 1)]


def test_a_polar_chart_goes_around_its_middle() -> None:
    turn = np.pi * TIME / 2.0
    trace = traced(plant_a=turn, plant_r=np.full(ROWS, 1e-3), plant_n=np.where(TIME < 2.0, 1.0, 2.0))
    chart = Chart("polar", ("plant.r",), x="plant.a", split="plant.n", split_name="push", scale=1e3, log=True)
    found = drawn(chart, trace)
    found = replace(found, levels=[(2.0, "r <= 2 mm")])
    assert found.packed()["polar"] is True
    assert [line.name for line in found.lines] == ["push 1", "push 2"]
    svg = drawing.charts([found])
    assert {"push 1", "push 2", "r <= 2 mm"} <= set(texts(svg))
    # the first line is the upper half of a circle, the second the lower one, within the limit
    upper, lower, limit = (points(svg, color) for color in ("#1f77b4", "#ff7f0e", "#595959"))
    middle = 0.5 * (limit.min(axis=0) + limit.max(axis=0))
    away = np.hypot(*(np.concatenate([upper, lower]) - middle).T)
    assert np.ptp(away) < 1.0
    assert away.max() < np.hypot(*(limit - middle).T).min()
    assert upper[:, 1].max() <= middle[1] + 1.0 <= lower[:, 1].min() + 2.0


def test_a_path_with_an_error_is_drawn_next_to_where_it_should_be() -> None:
    # a straight way to the upper right, 2 um to its left in the second half
    error = np.where(TIME < 2.0, 0.0, 2e-6)
    trace = traced(plant_x=TIME - error / 2**0.5, plant_y=TIME + error / 2**0.5, plant_e=error)
    chart = Chart("path", ("plant.y",), x="plant.x", error="plant.e", names=("tip",), equal=True)
    wanted, drawn = lines(chart, trace).items()
    assert wanted[0] == "nominal"
    assert wanted[1][1] == pytest.approx(wanted[1][0], abs=1e-9)
    assert drawn[0] == "tip, its error 200000 x larger"
    first, last = (np.array(drawn[1])[:, place] for place in (0, -1))
    assert first[1] - first[0] == pytest.approx(0.0, abs=1e-6)
    assert last[1] - last[0] == pytest.approx(0.4 * 2**0.5, rel=1e-3)
    # there may be no such rows, or nothing that moves in them
    assert lines(replace(chart, parts=("time > 9",)), trace) == {}
    assert lines(replace(chart, x="plant.e * 0", y=("plant.e * 0",)), trace) == {}


def test_whole_numbers_are_reported_at_whole_numbers() -> None:
    trace = traced(plant_f=TIME, plant_n=np.floor(TIME))
    chart = Chart("peaks", ("plant.f",), split="plant.n")
    found = drawn(chart, trace)
    assert found.integer is True
    assert [text for text in texts(drawing.charts([found])) if text.isdigit()][:4] == ["0", "1", "2", "3"]
    for other in (Chart("path", ("plant.f",), x="time"), replace(chart, x_log=True)):
        assert drawn(other, trace).integer is False


@pytest.mark.parametrize(
    ("more", "wanted"),
    [
        ({}, "frequency (Hz)"),
        ({"x": "plant.a"}, "waves per revolution"),
        ({"x_label": "f", "x_unit": "1/s"}, "f (1/s)"),
    ],
)
def test_a_spectrum_knows_what_its_axis_shows(more: dict[str, str], wanted: str) -> None:
    assert ChartData(Chart("spectrum", ("plant.f",), **more)).x_label == wanted  # type: ignore[arg-type]


def test_a_drawing_with_equal_scales_has_them() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 101)
    found = ChartData(
        Chart("path", ("y",), x="x", equal=True), [curves.Line("circle", np.cos(turn), np.sin(turn))]
    )
    across, down = np.ptp(points(drawing.charts([found]), "#1f77b4"), axis=0)
    assert across == pytest.approx(down, abs=1.0)


def test_a_chart_holds_the_numbers_of_its_lines() -> None:
    trace = traced(plant_x=TIME, plant_y=np.exp(-TIME))
    chart = Chart("path", ("plant.y",), x="plant.x", log=True, label="force", unit="N", title="Force")
    found = drawn(chart, trace)
    assert (found.label, found.points) == ("force (N)", False)
    x, y = (unpacked(found.packed()["lines"][0][axis]) for axis in "xy")
    assert 10.0**y == pytest.approx(np.exp(-x), rel=1e-3)


@pytest.mark.parametrize(
    ("paper", "limits", "source", "wanted"),
    [
        ("", {"maximum": 1.0}, "", "choice"),
        ("0.5 mm", {"maximum": 0.5}, "", "paper"),
        ("500 um or more", {"minimum": 0.5}, "", "paper"),
        ("0.5 mm", {"maximum": 0.038}, "", "prediction"),
        ("0.5 mm", {"minimum": 0.4, "maximum": 0.6}, "", "paper"),
        ("submicron", {"maximum": 1.0}, "", "prediction"),
        ("departs", {"equals": True}, "", "paper"),
        ("0.3 mm or < 0.05 cm", {"maximum": 0.5}, "", "paper"),
        ("0.5 mm", {"maximum": 0.5}, "choice", "choice"),
    ],
)
def test_where_a_limit_comes_from(paper: str, limits: Any, source: Any, wanted: str) -> None:
    criterion = Criterion("a", "c", "m", paper=paper, source=source, **limits)
    assert origin(Verdict(criterion, 1.0, "mm")) == wanted


@pytest.mark.parametrize(
    ("words", "unit", "wanted"),
    [
        ("50 to 60 mm/s", "m/s", [0.05, 0.06]),
        ("17,300 rpm", "rpm", [17300.0]),
        ("-0.5 to +1.0 mm", "m", [-5e-4, 1e-3]),
        ("less than about 2 %", "1", [0.02]),
        ("35 s, < 1 min", "m", []),
        ("35 s, < 1 min", "s", [35.0, 60.0]),
        ("up to 3 cm, 500 m/s2", "m", [0.03]),
        ("10 repetitions, 0.5 mm", "m", [5e-4]),
        ("3 or 4 mm", "m", [4e-3]),
        ("pass 12: 0.5 mm", "m", [5e-4]),
        ("5-6 um", "m", [5e-6, 6e-6]),
        ("20 .. 30 um", "m", [2e-5, 3e-5]),
        ("reached 2.5 um.", "m", [2.5e-6]),
        ("1.2 um rms with 5 harmonics", "m", [1.2e-6]),
    ],
)
def test_numbers_of_a_paper(words: str, unit: str, wanted: list[float]) -> None:
    assert numbers(words, unit) == pytest.approx(wanted)


@pytest.mark.parametrize(
    ("unit", "most", "wanted"),
    [
        ("m", 4.2e-7, ("nm", 1e9)),
        ("N", 1e3, ("kN", 1e-3)),
        ("s", 5e3, ("s", 1.0)),
        ("rad", 1e-6, ("rad", 1.0)),
        ("m", 0.0, ("m", 1.0)),
    ],
)
def test_an_axis_has_the_prefix_of_its_largest_value(unit: str, most: float, wanted: Any) -> None:
    name, factor = prefixed(unit, most)
    assert name == wanted[0]
    assert factor == pytest.approx(wanted[1])
