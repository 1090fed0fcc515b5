"""The file that a good commission writes, of all five."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ..samples.runs import run, value

pytestmark = pytest.mark.acceptance

MEASURED = {
    "centering": ("slide.bandwidth", "bandwidth", ()),
    "deburr": ("model.axis3.gain", "gain_3", ("controller.bank.compute=true",)),
    "dob": ("stage.force_constant", "force_constant", ()),
    "fts": ("servo.inertia", "inertia", ()),
    "polish": ("stiffness.nominal", "stiffness", ()),
}
"""Of each loop a parameter that is derived, the metric that it is, and what else is told with the file."""


@pytest.mark.parametrize("loop", MEASURED)
def test_the_file_of_the_results_is_taken_as_parameters(loop: str, tmp_path: Path) -> None:
    parameter, metric, besides = MEASURED[loop]
    file = tmp_path / "found.json"
    result = run(f"{loop}/commission", f"controller.commission.export='{file}'")
    found = json.loads(file.read_text(encoding="utf-8"))
    assert found[parameter] == value(result, metric)
    assert found["io_delay"] == round(value(result, "io_delay"))
    told = [f"controller.{name}={given}" for name, given in found.items()]
    # told beforehand, and nothing is commissioned
    changes = (
        *told,
        *besides,
        "controller.commission.apply=false",
        "signal.controller.commission.values=[false, false]",
    )
    again = run(f"{loop}/commission", *changes)
    assert value(again, "good") == 1.0
    # there is no time of it
    assert not value(again, "commissioned") > 0.0


# the same line in all five
@pytest.mark.parametrize(
    "loop", [loop if loop == "dob" else pytest.param(loop, marks=pytest.mark.full) for loop in MEASURED]
)
def test_a_file_that_cannot_be_written_stops_no_machine(loop: str, tmp_path: Path) -> None:
    file = tmp_path / "no" / "found.json"
    result = run(f"{loop}/commission", f"controller.commission.export='{file}'")
    assert value(result, "good") == 1.0
    assert not file.exists()
