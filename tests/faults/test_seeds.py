"""Fault matrices with other seeds than those of their pages."""

from dataclasses import replace

import pytest

from .matrix import load, names
from .outcome import running

pytestmark = [pytest.mark.acceptance, pytest.mark.full]


@pytest.mark.parametrize("name", names())
@pytest.mark.parametrize("seed", [71_302, 71_303])
def test_every_row_passes_with_another_seed(name: str, seed: int) -> None:
    with running(replace(load(name), seed=seed)) as runner:
        unmet = {outcome.row.name: outcome.problems for outcome in runner.outcomes() if outcome.problems}
    assert not unmet
