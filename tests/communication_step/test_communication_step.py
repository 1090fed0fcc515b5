"""The page on communication steps agrees with new measurements and with the warnings of the FMUs."""

from __future__ import annotations

import random
import zipfile
from pathlib import Path

import pytest

from cosim.paths import find_fmu

from . import document
from .__main__ import alike, measured
from .cells import CELLS, NOMINAL, SAMPLES, Cell, measure, warnings
from .loops import LOOPS, Loop

loops = pytest.mark.parametrize("loop", LOOPS, ids=lambda loop: loop.name)


@pytest.mark.acceptance
@loops
def test_a_cell_in_which_the_loop_works_is_measured_again(loop: Loop) -> None:
    outcomes = document.read()
    nominal = outcomes[loop.name, NOMINAL]
    working = [cell for cell in CELLS if document.works(outcomes[loop.name, cell], nominal)]
    assert NOMINAL in working
    cell = random.Random(loop.name).choice([cell for cell in working if cell.samples >= 1.0])
    assert alike(measure(loop, cell), outcomes[loop.name, cell]), cell


@loops
def test_the_fmu_warns_beyond_the_longest_step_with_which_its_loop_works(loop: Loop) -> None:
    outcomes = document.read()
    longest = document.limit(loop, outcomes)
    for samples in SAMPLES:
        cell = Cell(samples, 0, True)
        assert outcomes[loop.name, cell].warned is (samples > longest), samples
        assert warnings(loop, cell, steps=4) == int(samples > longest), samples


@loops
def test_the_page_in_the_fmu_shows_the_longest_step(loop: Loop) -> None:
    with zipfile.ZipFile(find_fmu(f"fmu-{loop.name}", Path())) as fmu:
        page = fmu.read("documentation/index.html").decode()
    longest = document.limit(loop, document.read())
    assert longest == 1.0
    assert "A closed loop works with steps of up to one sample period." in page


@pytest.mark.full
def test_the_page_says_what_is_measured() -> None:
    before = document.read()
    other = [
        key
        for key, outcome in measured([loop.name for loop in LOOPS], None).items()
        if not alike(before[key], outcome)
    ]
    assert not other
