"""Fast tool servo with off-nominal drives, flexures and feeds: learned during the cut, or identified.

The default run takes a few machines of a seed of its own, `pytest -m full -rP` the whole studies.
"""

from __future__ import annotations

import numpy as np
import pytest

from ..measured.store import measured
from ..samples.runs import run, value
from ..samples.studies import machines

pytestmark = pytest.mark.acceptance

FEW = (3, 92_001)
"""Machines of the default run, and their seed, which no study uses."""
UNKNOWN: dict[str, dict[str, float]] = {
    "fts-feed": {"rms": 0.6e-6, "early": 0.6e-6},
    "fts-flexure": {"tip": 0.2e-6},
}
"""Largest error of each study, m."""


def hold(name: str, few: tuple[int, int] | None = None) -> dict[str, float]:
    """Run a study, or that many sampled machines, and compare the errors (um) with their limits."""
    done = machines(name, few)
    found: dict[str, float] = {"machines": len(done)}
    for metric, most in UNKNOWN[name].items():
        errors = np.array([one[metric] for one in done])
        print(f"{name}: {metric} {1e6 * np.median(errors):.3f}, most {1e6 * errors.max():.3f} um")
        assert errors.max() <= most
        found |= {metric: 1e6 * float(np.median(errors)), f"{metric}_most": 1e6 * float(errors.max())}
    assert all(one["good"] for one in done)
    return found


@pytest.mark.parametrize("name", UNKNOWN)
def test_a_few_machines(name: str) -> None:
    hold(name, FEW)


@pytest.mark.full
@pytest.mark.parametrize("name", UNKNOWN)
def test_the_whole_study(name: str) -> None:
    measured("fts-unknown", name, **hold(name))


def test_without_learning_the_response_the_drive_is_learned_ten_times_as_late() -> None:
    amplitudes = run("fts/weak-drive", "controller.expert.feedforward.adaptive=false", "loop.duration=2.0")
    assert value(amplitudes, "early") > 1.5e-6


def test_without_identification_the_tool_errs_where_the_encoder_does_not() -> None:
    nominal = run(
        "fts/500hz-flexure", "signal.controller.mode.values=['Track', 'Track']", "loop.duration=1.5"
    )
    assert value(nominal, "rms") < 0.2e-6
    assert value(nominal, "tip") == pytest.approx(1.85e-6, rel=0.05)
