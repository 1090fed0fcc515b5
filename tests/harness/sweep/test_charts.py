"""Charts of a study: their data, and rejections before a run."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError
from cosim.report import charts
from cosim.scenario.model import Chart
from cosim.sweep import study
from cosim.sweep.charts import check_charts, columns, results
from cosim.sweep.designs import values_by_key
from cosim.sweep.plan import Plan
from cosim.sweep.summary import Summary

CASES = [
    {"controller.detector": "Glr", "plant.mass": 9.0, "plant.workpiece": False},
    {"controller.detector": "Slope", "plant.mass": 10.0},
    {"controller.detector": "Glr", "plant.mass": 11.0, "plant.workpiece": True},
]


def summarized(*depths: float | None) -> Summary:
    """Survey of a run of each case; without a depth it gave no result."""
    found = Summary(len(depths))
    names = dict.fromkeys(name for case in CASES for name in case)
    found.columns = {name: [case.get(name) for case in CASES] for name in names}
    found.columns["status"] = ["crashed" if depth is None else "passed" for depth in depths]
    found.columns["simulated_s"] = [None if depth is None else 2.0 for depth in depths]
    for metric in cosim.load("dob").metric:
        found.columns[f"metric.{metric.name}"] = list(depths)
    return found


def test_texts_have_items_and_runs_without_a_result_no_row() -> None:
    known = columns(cosim.load("dob"), values_by_key(CASES))
    assert known["controller.detector"] == {"Glr": 0, "Slope": 1}
    assert known["plant.mass"] is None
    table = results(summarized(1e-7, None, 3e-7), known)
    assert list(table) == list(known)
    assert table["time"].tolist() == [2.0, 2.0]
    assert table["controller.detector"].tolist() == [0.0, 0.0]
    assert table["plant.workpiece"].tolist() == [0.0, 1.0]
    assert table["metric.depth"].tolist() == [1e-7, 3e-7]
    assert math.isnan(results(summarized(1e-7, 2e-7, 3e-7), known)["plant.workpiece"][1])


def test_a_fraction_of_the_runs_of_a_text_is_drawn() -> None:
    known = columns(cosim.load("dob"), values_by_key(CASES))
    parts = ('controller.detector == "Glr"',)
    wanted = Chart("share", ("metric.depth",), parts=parts, names=("likelihood",), scale=1.0, x_scale=1e9)
    table = results(summarized(3e-7, 2e-7, 1e-7), known)
    (line,) = charts.lines(wanted, charts.evaluator(wanted, table, known))
    assert line.name == "likelihood"
    np.testing.assert_allclose(line.x, [100.0, 300.0])
    np.testing.assert_allclose(line.y, [0.5, 1.0])


STUDY = """
scenario = "dob"
[design]
kind = "grid"
[[vary]]
key = "plant.mass"
values = [9.0, 11.0]
[[charts]]
kind = "{kind}"
x = "{x}"
y = ["metric.depth"]
"""


@pytest.mark.parametrize(
    ("kind", "x", "words"),
    [
        ("path", "plant.mas", ("`charts[0]` = `plant.mas`", "plant.mass")),
        ("path", "plant.position", ("`charts[0]`", "`plant.position`")),
        ("path", "metric.deep", ("`charts[0]`", "metric.depth")),
        ("spectrum", "plant.mass", ("`charts[0]`", "needs the rows of one run", "[[plot.charts]]")),
        ("peaks", "plant.mass", ("`charts[0]`", "has no `split`")),
    ],
)
def test_a_chart_that_cannot_be_made_is_rejected(
    kind: str, x: str, words: tuple[str, ...], tmp_path: Path
) -> None:
    file = tmp_path / "study.toml"
    file.write_text(STUDY.format(kind=kind, x=x))
    with pytest.raises(CosimError) as caught:
        check_charts(Plan(study.load(file)))
    reported = f"{caught.value.message} {caught.value.hint}"
    assert all(word in reported for word in words), reported
