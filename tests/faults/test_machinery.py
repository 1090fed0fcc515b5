"""The machinery of the fault matrices, with a fault that is told, a harmless and a silent one."""

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
        ("LostReading",),
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
        "too little told of",
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


def test_a_fault_that_is_told_is_found_with_its_time(outcomes: list[Outcome]) -> None:
    told = outcomes[0]
    assert (told.found, told.problems) == (("LostReading",), ())
    assert 0.0 <= told.after < 1e-3


def test_a_harmless_one_leaves_a_good_job(outcomes: list[Outcome]) -> None:
    assert (outcomes[1].found, outcomes[1].problems) == ((), ())


def test_one_that_is_not_told_is_silent_and_says_all_that_is_wrong(outcomes: list[Outcome]) -> None:
    assert [told.partition(":")[0] for told in outcomes[2].problems] == [
        "silent",
        "`inject.controller.spindle_speed` never began",
        f"the excursion is {outcomes[2].excursion * 1e9:.4g} nm, it must not be above 10 nm",
    ]


def test_what_no_reading_tells_is_no_success_either(outcomes: list[Outcome]) -> None:
    row = replace(ROWS[1], faults=("LostReading",), untold="one picometre")
    assert list(unmet(row, (), good=False)) == []
    assert list(unmet(row, (), good=True)) == ["nothing was to be told: the job is done and good"]
    assert list(unmet(row, ("Saturation",), good=False)) == ["`Saturation` was told, `LostReading` is right"]
    told = page.page("dob", MATRIX, [replace(outcomes[1], row=row), outcomes[2]])
    assert "Silent are 1, but for 1 that no reading tells, with the reason: neither" in told
    assert "| not told: one picometre |" in told


def test_a_fault_that_is_not_right_is_no_success(outcomes: list[Outcome]) -> None:
    told = list(unmet(ROWS[1], ("LostReading",), good=True))
    assert told == ["`LostReading` was told, `None` is right"]


def test_a_second_fault_that_is_not_told_or_told_first_is_no_success() -> None:
    both = replace(ROWS[0], faults=("LostReading", "InvalidInput"), sequence=True)
    assert list(unmet(both, both.faults, good=False)) == []
    for found in (("LostReading",), ("InvalidInput", "LostReading")):
        assert len(list(unmet(both, found, good=False))) == 1
    assert list(unmet(ROWS[1], (), good=False)) == ["silent: no fault, and the job is not done and good"]


def test_the_page_shows_every_row_and_is_compared_by_words_and_numbers(outcomes: list[Outcome]) -> None:
    made = page.page("dob", MATRIX, outcomes)
    lines = made.splitlines()
    assert sum(line.startswith("| ") for line in lines) == 1 + len(ROWS)
    assert "| no number from the encoder | `LostReading` | 300 us | " in made
    assert "| encoder 1 pm off | the job is done and good |  | " in made
    assert "Silent are 1: " in made
    assert page.differences(made, made) == []
    assert len(page.differences(made.replace("`LostReading`", "`Saturation`"), made)) == 1
    assert page.differences(made.replace("20 mm/s", "20.2 mm/s"), made) == []
    assert len(page.differences(made.replace("20 mm/s", "21 mm/s"), made)) == 1
    assert len(page.differences(made.replace("20 mm/s", "20 um/s"), made)) == 1
    assert page.differences(made + "more\n", made) == ["the page has 14 lines, the runs give 13"]


def test_the_page_says_beside_a_row_what_it_changes(outcomes: list[Outcome]) -> None:
    quick = ("plant.timestep=1e-5", "loop.duration=0.2")
    rows = [replace(row, changes=quick) for row in ROWS]
    rows[1] = replace(rows[1], changes=(*quick, "controller.io_delay=0"), scenario="dob/30")
    changed = [replace(one, row=row) for one, row in zip(outcomes, rows, strict=True)]
    made = page.page("dob", replace(MATRIX, rows=tuple(rows)), changed)
    assert "(seed 71201), all with `plant.timestep=1e-5`.\n" in made
    assert "| no number from the encoder | " in made
    assert "| encoder 1 pm off (in `dob/30`, `controller.io_delay=0`) | " in made


def test_a_fault_before_the_injection_is_none_that_answers_it() -> None:
    told = {"TravelLimit": 0.5, "LostReading": 0.8}
    times = [answered(told, began) for began in (0.5, 0.75, 0.9)]
    assert times == pytest.approx([0.0, 0.05, np.nan], nan_ok=True)
    assert list(early(ROWS[0], told, 0.75)) == ["`TravelLimit` was told 250 ms before anything was injected"]
    assert list(early(replace(ROWS[0], sequence=True), told, 0.75)) == list(early(ROWS[0], told, 0.5)) == []
