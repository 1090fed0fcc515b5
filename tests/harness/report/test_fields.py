"""Charts whose maps a function of the user makes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cosim.errors import CosimError
from cosim.metrics import drawable
from cosim.report import charts
from cosim.report.charts import ChartData
from cosim.scenario.model import Chart
from cosim.trace.columns import Held

MODULE = """
import numpy as np

EDGES = np.linspace(0.0, 1e-3, 4), np.linspace(0.0, 2e-3, 3)

def depths(x, y):
    deep = np.full((2, 3), np.nan)
    deep[0] = x.sum(), y.sum(), len(x)
    return {"flat": (*EDGES, np.zeros((2, 3))), "deep": (*EDGES, deep)}

def flat(x, y):
    return {"flat": (*EDGES, np.zeros((2, 3)))}

def turned(x, y):
    return {"deep": (*EDGES, np.ones((3, 2)))}

def broken(x, y):
    raise ArithmeticError("no surface")
"""
CHART = Chart(
    "field", ("plant.x", "2.0 * plant.x"), title="Depth", parts=("plant.x > 0", "time < 3.5"), x_scale=1e3
)
TIME = np.arange(5.0)


def trace() -> Held:
    table = np.zeros(5, dtype=[("time", np.float64), ("plant.x", np.float64)])
    table["time"] = table["plant.x"] = TIME
    return Held(table)


def views(chart: Chart, folder: Path) -> tuple[list[ChartData], list[str]]:
    return charts.of_columns([chart], trace(), dict.fromkeys(trace()), folder, {})


@pytest.fixture
def named(tmp_path: Path, request: pytest.FixtureRequest) -> str:
    """Name of a module in the folder of the scenario, of its own for each test."""
    name = f"depths_{abs(hash(request.node.nodeid))}"
    (tmp_path / f"{name}.py").write_text(MODULE)
    return name


def test_a_function_next_to_the_scenario_makes_the_maps(named: str, tmp_path: Path) -> None:
    (flat, deep), undrawn = views(replace(CHART, function=f"{named}:depths"), tmp_path)
    assert undrawn == []
    assert (flat.chart.title, deep.chart.title) == ("Depth: flat", "Depth: deep")
    cells = deep.cells
    assert cells is not None
    assert cells.x == pytest.approx([0.0, 1 / 3, 2 / 3, 1.0])
    assert cells.y == pytest.approx([0.0, 1e-3, 2e-3])
    # rows 1 to 3 are in both parts: sums 6 and 12, 3 rows; what is not a number is nothing
    assert cells.parts.ravel() == pytest.approx([0.5, 1.0, 0.25, 0.0, 0.0, 0.0], abs=1e-4)
    assert flat.cells is not None
    assert not flat.cells.parts.any()


def test_maps_without_anything_are_left_out(named: str, tmp_path: Path) -> None:
    assert views(replace(CHART, function=f"{named}:flat"), tmp_path) == ([], [])


@pytest.mark.parametrize(
    ("function", "reported"),
    [
        ("broken", ("failed: ArithmeticError: no surface",)),
        ("turned", ("gives `deep` of the shapes [(4,), (3,), (3, 2)]", "values (m, n)")),
        ("depth", ("does not exist", "depths")),
    ],
)
def test_what_a_function_does_wrong_is_reported_and_costs_the_chart(
    function: str, reported: tuple[str, ...], named: str, tmp_path: Path
) -> None:
    drawn, (problem,) = views(replace(CHART, function=f"{named}:{function}"), tmp_path)
    assert drawn == []
    assert problem.startswith(f"`plot.charts` `Depth`: the function `{named}:{function}`")
    assert all(text in problem for text in reported)


def test_a_module_that_is_not_there_gives_an_error_with_its_location(tmp_path: Path) -> None:
    drawn, (problem,) = views(replace(CHART, function="no_such_module:f"), tmp_path)
    assert drawn == []
    assert "cannot be imported: ModuleNotFoundError" in problem
    assert str(tmp_path) in problem


@pytest.mark.parametrize("function", ["", "heights", ":heights", "module:"])
def test_a_function_is_named_with_its_module(function: str) -> None:
    with pytest.raises(CosimError, match="function"):
        drawable.check_charts(
            [replace(CHART, function=function)], "plot.charts", {"time": None, "plant.x": None}
        )
