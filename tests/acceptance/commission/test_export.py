"""The file that a complete commissioning run writes, of all controllers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ..samples.runs import run, value

pytestmark = pytest.mark.acceptance

MEASURED = {
    "centering": ("slide.bandwidth", "bandwidth", ()),
    "deburr": ("expert.model.axis3.gain", "gain_3", ("controller.bank.compute=true",)),
    "dob": ("stage.force_constant", "force_constant", ()),
    "fts": ("servo.inertia", "inertia", ()),
    "polish": ("stiffness.nominal", "stiffness", ()),
}
"""Of each scenario a derived parameter, its metric, and further changes with the file."""


@pytest.mark.parametrize("loop", MEASURED)
def test_the_file_of_the_results_is_taken_as_parameters(loop: str, tmp_path: Path) -> None:
    parameter, metric, further = MEASURED[loop]
    file = tmp_path / "found.json"
    result = run(f"{loop}/commission", f"controller.commission.export='{file}'")
    found = json.loads(file.read_text(encoding="utf-8"))
    assert found[parameter] == value(result, metric)
    assert found["io_delay"] == round(value(result, "io_delay"))
    configured = [f"controller.{name}={given}" for name, given in found.items()]
    # configured from the start, without a commissioning run
    changes = (
        *configured,
        *further,
        "controller.commission.apply=false",
        "signal.controller.commission.values=[false, false]",
    )
    again = run(f"{loop}/commission", *changes)
    assert value(again, "good") == 1.0
    # it has no duration
    assert not value(again, "commissioned") > 0.0


# the same code in all controllers
@pytest.mark.parametrize(
    "loop", [loop if loop == "dob" else pytest.param(loop, marks=pytest.mark.full) for loop in MEASURED]
)
def test_a_file_that_cannot_be_written_stops_no_machine(loop: str, tmp_path: Path) -> None:
    file = tmp_path / "no" / "found.json"
    result = run(f"{loop}/commission", f"controller.commission.export='{file}'")
    assert value(result, "good") == 1.0
    assert not file.exists()
