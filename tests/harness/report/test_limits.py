"""Limits and events in plots: limits of a column from a criterion, and where they are plotted."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim.errors import CosimError
from cosim.metrics import drawable
from cosim.metrics.criteria import Measured, Verdict, drawn
from cosim.report import charts, drawing
from cosim.scenario.model import Chart, Criterion, Panel, Plot
from cosim.show import marks, plot

from .traces import ROWS, TIME, result, texts, traced

TRACE = traced(plant_x=1e-3 * TIME, controller_fault=np.where(TIME < 2.0, 1.0, 3.0))


@pytest.mark.parametrize(
    ("limits", "wanted"),
    [
        ({"minimum": 1.0, "maximum": 4.0}, [1e-3, 4e-3]),
        ({"equals": 2.0}, [2e-3]),
        ({"equals": True}, []),
    ],
)
def test_limits_are_drawn_in_the_unit_of_the_metric(limits: Any, wanted: list[float]) -> None:
    assert drawn(Criterion("a", "c", "m", unit="mm", **limits), "m") == pytest.approx(wanted)


def test_a_limit_is_next_to_a_value_of_zero() -> None:
    of, found = result(TRACE, "max(plant.x)", maximum=4.0)
    never = replace(
        found, metrics={"m": Measured("m", 0.0, "m")}, criteria=[Verdict(of.criterion[0], 0.0, "mm")]
    )
    assert marks.limits(of, never) == marks.limits(of, found)


@pytest.mark.parametrize(
    ("value", "wanted"),
    [
        ("max(plant.x)", [(4e-3, "depth <= 4 mm")]),
        ("last(plant.x[time > 1])", [(4e-3, "depth <= 4 mm")]),
        ("max(abs(plant.x)[time > 1])", [(4e-3, "depth <= 4 mm"), (-4e-3, "")]),
        ("std(plant.x)", None),
        ("max(plant.x) / mm", [(4e-6, "depth <= 4 mm")]),
        ("2 * max(abs(plant.x)) * 30 / pi", [(2.0943951e-4, "depth <= 4 mm"), (-2.0943951e-4, "")]),
        ("max(plant.x) - min(plant.x)", None),
        ("max(plant.x - 1)", None),
    ],
)
def test_a_limit_on_a_single_value_of_a_column_is_one_on_the_column(value: str, wanted: Any) -> None:
    found = marks.limits(*result(TRACE, value, maximum=4.0))
    if wanted is None:
        assert found == {}
        return
    assert [reported for _, reported in found["plant.x"]] == [reported for _, reported in wanted]
    assert [limit for limit, _ in found["plant.x"]] == pytest.approx([limit for limit, _ in wanted])


def test_limits_faults_and_injections_are_marked_in_the_panels() -> None:
    of, found = result(TRACE, "max(plant.x)", maximum=4.0)
    of = replace(of, plot=Plot(panels=(Panel(("plant.x",), "mm", 1e3),)))
    (view,) = plot.views(of, found)
    assert view.events == [(0.5, "fault injected: plant.u"), (2.0, "Stuck")]
    ((limit, reported),) = view.panels[0].limits
    assert limit == pytest.approx(4.0)
    assert reported == "depth <= 4 mm"
    assert {"depth <= 4 mm", "Stuck"} <= set(texts(drawing.views([view])))
    # one far away would hide the line
    far = replace(found, criteria=[Verdict(replace(of.criterion[0], maximum=400.0), 2.0, "mm")])
    assert plot.views(of, far)[0].panels[0].limits == []


def test_a_figure_marks_limits_and_events_too(tmp_path: Path) -> None:
    of, found = result(TRACE, "max(plant.x)", maximum=4.0)
    of = replace(of, plot=Plot(panels=(Panel(("plant.x",), "mm", 1e3), Panel(("plant.x",), "mm", 1e3))))
    file = tmp_path / "plot.svg"
    plot.save(of, found, file)
    # matplotlib draws letters and leaves the text as a comment; the events are named once, in the first panel
    reported = [unescape(text).strip() for text in re.findall(r"<!-- (.*?) -->", file.read_text())]
    assert [reported.count(text) for text in ("depth <= 4 mm", "fault injected: plant.u", "Stuck")] == [
        2,
        1,
        1,
    ]


def test_a_limit_that_is_near_in_one_window_only_is_named(tmp_path: Path) -> None:
    # it is far from the lines of the zoom
    of, found = result(TRACE, "max(plant.x)", maximum=4.0)
    of = replace(of, plot=Plot(panels=(Panel(("plant.x",), "mm", 1e3),), zoom="time > 0.1"))
    plot.save(of, found, tmp_path / "plot.svg")
    assert "<!-- depth &lt;= 4 mm -->" in (tmp_path / "plot.svg").read_text()


@pytest.mark.parametrize(
    ("value", "signs"), [("rms(plant.x)", [1.0]), ("max(abs(plant.x - 1))", [1.0, -1.0])]
)
def test_a_criterion_names_columns_that_show_its_limit(value: str, signs: list[float]) -> None:
    of, found = result(TRACE, value, maximum=4.0, columns=("controller.y",))
    # the metric is in m
    found = replace(found, units={**found.units, "controller.y": "um"})
    limits = marks.limits(of, found)
    assert list(limits) == ["controller.y"]
    assert [limit for limit, _ in limits["controller.y"]] == pytest.approx([4e3 * sign for sign in signs])
    with pytest.raises(CosimError, match=r"`controller\.y`, which is not a column of the trace"):
        drawable.check(of, {"time": None, "plant.x": None})


@pytest.mark.parametrize(
    ("kind", "more", "places", "levels"),
    [
        ("path", {"x": "time"}, [], [4.0]),
        ("peaks", {"split": "plant.n"}, [], [4.0]),
        ("polar", {"x": "time"}, [], [4.0]),
        ("share", {}, [4.0], []),
        # amplitudes are no values of the column
        ("spectrum", {}, [], []),
    ],
)
def test_a_chart_of_a_column_shows_its_limit(
    kind: Any, more: dict[str, Any], places: list[float], levels: list[float]
) -> None:
    trace = traced(plant_x=1e-3 * TIME, plant_n=np.floor(TIME))
    of, found = result(trace, "max(plant.x)", maximum=4.0)
    along: dict[str, Any] = {"x_scale": 1e3} if kind == "share" else {"scale": 1e3}
    chart = Chart(kind, ("plant.x",), **more, **along)
    ((reported,), undrawn) = charts.of_run(replace(of, plot=Plot(charts=(chart,))), found)
    assert undrawn == []
    assert [place for place, _ in reported.marks] == pytest.approx(places)
    assert [level for level, _ in reported.levels] == pytest.approx(levels)
    assert texts(drawing.charts([reported])).count("depth <= 4 mm") == len(places) + len(levels)
    # one far away would hide the line
    far = replace(found, criteria=[Verdict(replace(of.criterion[0], maximum=400.0), 2.0, "mm")])
    ((reported,), _) = charts.of_run(replace(of, plot=Plot(charts=(chart,))), far)
    assert (*reported.marks, *reported.levels) == ()


def test_faults_beyond_the_last_mark_are_counted() -> None:
    reported = np.where(np.arange(ROWS) // 100 % 2 == 1, 3.0, 1.0)
    of, found = result(traced(plant_x=TIME, controller_fault=reported), "max(plant.x)", maximum=4.0)
    every = marks.events(of, found)
    events = plot.events_between(TIME, every)
    labels = ["Stuck", "Stuck", "Stuck", "fault injected: plant.u", "Stuck", "Stuck, and 15 more"]
    assert [text for _, text in events] == labels
    assert events[-1][0] == pytest.approx(0.9)
    # those of a window are its own
    assert [t for t, _ in plot.events_between(TIME[TIME > 3.4], every)] == pytest.approx([3.5, 3.7, 3.9])


def test_a_fault_in_the_first_row_is_marked() -> None:
    of, found = result(traced(plant_x=TIME, controller_fault=np.full(ROWS, 3.0)), "max(plant.x)", maximum=4.0)
    assert marks.events(of, found) == [(0.0, "Stuck"), (0.5, "fault injected: plant.u")]


def test_a_logarithmic_panel_has_no_limit_that_is_not_positive() -> None:
    of, found = result(TRACE, "max(abs(plant.x))", maximum=4.0)
    for log, count in ((False, 2), (True, 1)):
        shown = replace(of, plot=Plot(panels=(Panel(("plant.x",), "mm", 1e3, log=log),)))
        (view,) = plot.views(shown, found)
        assert len(view.panels[0].limits) == count
        assert "nan" not in drawing.views([view])
