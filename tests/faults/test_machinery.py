"""The machinery of the fault matrices, with a detected, a harmless and an undetected fault."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cosim.scenario.injection import Injection

from . import page
from .matrix import DONE, Matrix, Row
from .outcome import Outcome, answered, early, running, unmet

LEARNING = 'controller.state == "Learn"'
ROWS = (
    Row(
        "no number from the encoder",
        ("PositionLost",),
        "max(plant.velocity * (time > first_time(controller.fault > 1)))",
        2e-2,
        "speed of the approach",
        (Injection("controller.position", when='controller.state == "Learn"', value=float("nan")),),
        unit="m/s",
    ),
    Row(
        "encoder 1 pm off",
        (DONE,),
        "last(plant.depth_max)",
        5e-7,
        "as without a fault",
        (Injection("controller.position", from_time=0.1, offset=1e-12),),
    ),
    Row(
        "too few expectations",
        ("Saturation",),
        "last(plant.depth_max)",
        1e-8,
        "less than the detector needs",
        (Injection("controller.spindle_speed", when="time > 1e3", frozen=True),),
    ),
)
MATRIX = Matrix(
    "dob",
    71_201,
    '(last(controller.state) == "Done") & (last(plant.depth_max) < 1e-6)',
    "abs(last(plant.velocity)) < 1e-3",
    ROWS,
)


@pytest.fixture(scope="module")
def outcomes() -> list[Outcome]:
    with running(MATRIX) as runner:
        return runner.outcomes()


def test_a_detected_fault_has_its_time(outcomes: list[Outcome]) -> None:
    detected = outcomes[0]
    assert (detected.found, detected.problems) == (("PositionLost",), ())
    assert 0.0 <= detected.after < 1e-3


def test_a_harmless_fault_leaves_a_good_result(outcomes: list[Outcome]) -> None:
    assert (outcomes[1].found, outcomes[1].problems) == ((), ())


def test_an_undetected_fault_lists_all_problems(outcomes: list[Outcome]) -> None:
    assert [each.partition(":")[0] for each in outcomes[2].problems] == [
        "undetected",
        "`inject.controller.spindle_speed` never started",
        f"the excursion is {outcomes[2].excursion * 1e9:.4g} nm, it must not be above 10 nm",
    ]


def test_an_undetectable_fault_is_no_success_either(outcomes: list[Outcome]) -> None:
    row = replace(ROWS[1], faults=("PositionLost",), undetectable="one picometer")
    assert list(unmet(row, (), good=False)) == []
    assert list(unmet(row, (), good=True)) == [
        "no fault was expected: the cycle completed with a good result"
    ]
    assert list(unmet(row, ("Saturation",), good=False)) == ["raised `Saturation`, expected `PositionLost`"]
    made = page.page("dob", MATRIX, [replace(outcomes[1], row=row), outcomes[2]])
    assert "Undetected: 1 (neither a correct fault nor a good result); undetectable: 1, with" in made
    assert "| undetectable: one picometer |" in made


def test_an_incorrect_fault_is_no_success(outcomes: list[Outcome]) -> None:
    problems = list(unmet(ROWS[1], ("PositionLost",), good=True))
    assert problems == ["raised `PositionLost`, expected `None`"]


def test_a_missing_or_early_second_fault_is_no_success() -> None:
    both = replace(ROWS[0], faults=("PositionLost", "InvalidInput"), sequence=True)
    assert list(unmet(both, both.faults, good=False)) == []
    for found in (("PositionLost",), ("InvalidInput", "PositionLost")):
        assert len(list(unmet(both, found, good=False))) == 1
    assert list(unmet(ROWS[1], (), good=False)) == ["undetected: no fault, and no good result"]


def test_the_page_shows_every_row_and_is_compared_by_words_and_numbers(outcomes: list[Outcome]) -> None:
    made = page.page("dob", MATRIX, outcomes)
    lines = made.splitlines()
    assert sum(line.startswith("| ") for line in lines) == 1 + len(ROWS)
    assert "| no number from the encoder | `PositionLost` | 300 us | " in made
    assert "| encoder 1 pm off | completes, good result |  | " in made
    assert "Undetected: 1 (" in made
    assert page.differences(made, made) == []
    assert len(page.differences(made.replace("`PositionLost`", "`Saturation`"), made)) == 1
    assert page.differences(made.replace("20 mm/s", "20.2 mm/s"), made) == []
    assert len(page.differences(made.replace("20 mm/s", "21 mm/s"), made)) == 1
    assert len(page.differences(made.replace("20 mm/s", "20 um/s"), made)) == 1
    assert page.differences(made + "more\n", made) == ["the page has 14 lines, the runs give 13"]


def test_the_page_shows_the_changes_of_a_row(outcomes: list[Outcome]) -> None:
    quick = ("plant.timestep=1e-5", "loop.duration=0.2")
    rows = [replace(row, changes=quick) for row in ROWS]
    rows[1] = replace(rows[1], changes=(*quick, "controller.io_delay=0"), scenario="dob/30")
    changed = [replace(one, row=row) for one, row in zip(outcomes, rows, strict=True)]
    made = page.page("dob", replace(MATRIX, rows=tuple(rows)), changed)
    assert "(seed 71201), all runs with `plant.timestep=1e-5`.\n" in made
    assert "| no number from the encoder | " in made
    assert "| encoder 1 pm off (in `dob/30`, `controller.io_delay=0`) | " in made


def test_a_fault_before_the_injection_is_no_response() -> None:
    raised = {"TravelLimit": 0.5, "PositionLost": 0.8}
    times = [answered(raised, began) for began in (0.5, 0.75, 0.9)]
    assert times == pytest.approx([0.0, 0.05, np.nan], nan_ok=True)
    assert list(early(ROWS[0], raised, 0.75)) == ["raised `TravelLimit` 250 ms before the injection"]
    assert (
        list(early(replace(ROWS[0], sequence=True), raised, 0.75)) == list(early(ROWS[0], raised, 0.5)) == []
    )
