"""The bias of the contact position taught by touches: `studies/dob-teach.toml`.

`pytest -m full -rP` runs the whole study and prints what is left of the error;
`fmu-dob/README.md` has its tables.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ..measured import store
from ..samples import studies

pytestmark = pytest.mark.acceptance

FEW = (3, 91_172)
"""Machines of the default run, and their seed; no study has it."""
SPEED = "controller.approach.velocity"
TAUGHT = (1e-5, 5.4772e-5, 3e-4)
"""Speeds of the study that are taught on work that is not too hard for the fastest, m/s."""
FASTEST = 2.9e-4
"""Less than this is a slower fastest speed, m/s."""
TEACHING = 48.0
"""Longest teaching, s: forty touches, where twenty do not make the bias sure."""
MACHINE_TIME = 70.0
"""Longest time of an unknown machine to the place of its work, s, as the scenario plans it."""
TWENTY = 28.0
"""Time in which four machines of five are taught, by twenty touches, s."""
TOUCH_SCATTER = 6e-8
"""`limits.touch_scatter`, m."""
NEAR = 1e-7
"""Error of a place that is near, m."""
FORCE = 0.8
"""Largest force of a touch that is demanded, N."""


def sure(one: studies.Machine) -> bool:
    """Whether the bias is as sure as it is to be at the speed of the job."""
    return float(one.changes[SPEED]) > 0.999 * one["sure_from"]


def errors(found: Sequence[studies.Machine], metric: str) -> tuple[float, float, float]:
    """Median, 90 % and most of the size of an error (nm)."""
    size = 1e9 * np.abs([one[metric] for one in found])
    return float(np.median(size)), float(np.percentile(size, 90)), float(size.max())


def deviations(found: Sequence[studies.Machine]) -> float:
    """Errors of the told place over the deviations that are told with it, root of the mean square."""
    ratio = [one["position_error"] / one["told_deviation"] for one in found]
    return float(np.sqrt(np.mean(np.square(ratio))))


def tell(found: Sequence[studies.Machine]) -> list[studies.Machine]:
    """Those that told a place, which is printed; apart by whether their speed was taught."""
    told = [one for one in found if one["valid"] and not one["named"]]
    named = sum(one["named"] > 0.0 for one in found)
    print(f"{len(found)} machines, {len(told)} told a place, {named} named a fault")
    for speed in sorted({one.changes[SPEED] for one in told}):
        those = [one for one in told if one.changes[SPEED] == speed]
        mean = 1e9 * float(np.mean([one["position_error"] for one in those]))
        for metric in ("late", "constant", "position_error"):
            median, high, most = errors(those, metric)
            print(f"{1e6 * speed:.0f} um/s, {metric}: {median:.0f}/{high:.0f}/{most:.0f} nm, N {len(those)}")
        print(f"    mean of what is left {mean:+.0f} nm, {deviations(those):.2f} of the deviation")
    return told


def hold(found: Sequence[studies.Machine], least: float) -> list[studies.Machine]:
    """Hold the machines against what is demanded of those that were taught; few may err silently."""
    told = tell(found)
    assert len(told) >= least * len(found)
    # beyond three of the deviations that it tells, without a fault
    assert sum(one["silent"] for one in found) <= 0.01 * len(found)
    assert all(one["taught"] <= TEACHING for one in found)
    assert np.percentile([one["taught"] for one in found], 80) <= TWENTY
    assert all(one.result.simulated_s <= MACHINE_TIME for one in found)
    assert errors(told, "position_error")[1] <= 60.0
    return told


def hold_force(found: Sequence[studies.Machine]) -> None:
    """Hold what the touches press with, in the teaching and in the job."""
    assert all(one["force"] <= FORCE for one in found)


def test_a_few_machines() -> None:
    found = studies.machines("dob-teach", FEW)
    hold(found, 0.3)
    hold_force(found)


def touched_as_taught(one: studies.Machine) -> bool:
    """Whether the job was as fast as some touch of the teaching."""
    return one.changes[SPEED] in TAUGHT or one.changes[SPEED] >= one["fastest"]


def keep(found: Sequence[studies.Machine]) -> None:
    """Keep how the machines ended, those that told a place apart by whether their speed was taught."""
    told = [one for one in found if one["valid"] and not one["named"]]
    rejected = [one for one in found if one["rejected"]]
    scattered = sum(one["scatter"] > TOUCH_SCATTER for one in rejected)
    store.measured(
        "dob-teach", "ends", machines=len(found), told=len(told), share=100.0 * len(told) / len(found),
        faster=sum(one["sure_from"] > 1.001 * TAUGHT[0] for one in told),
        silent=sum(one["silent"] for one in found), scattered=scattered, unsure=len(rejected) - scattered,
        others=len(found) - len(told) - len(rejected),
        hard=sum(one["force"] > FORCE for one in found), force=max(one["force"] for one in found),
        slower=sum(one["fastest"] < FASTEST for one in told),
        slowest=1e6 * min(one["fastest"] for one in told),
    )  # fmt: skip
    rows = {
        "taught": [one for one in told if sure(one) and touched_as_taught(one)],
        "between": [one for one in told if sure(one) and not touched_as_taught(one)],
        "slower": [one for one in told if not sure(one)],
    }
    for row, those in rows.items():
        size = errors(those, "position_error")
        store.measured(
            "dob-taught", row, machines=len(those),
            near=sum(abs(one["position_error"]) <= NEAR for one in those),
            median=size[0], high=size[1], most=size[2],
            constant=errors(those, "constant")[1], late=errors(those, "late")[1], rms=deviations(those),
        )  # fmt: skip


@pytest.fixture(scope="module")
def study() -> list[studies.Machine]:
    """All machines of the study."""
    return studies.machines("dob-teach")


@pytest.mark.full
def test_the_whole_study(study: list[studies.Machine]) -> None:
    assert len(study) == 120
    told = hold(study, 0.7)
    # taught or not, what is left is a fraction of what one constant leaves
    assert errors(told, "position_error")[1] <= 0.5 * errors(told, "constant")[1]
    assert 0.5 < deviations(told) < 1.3
    keep(study)


@pytest.mark.full
def test_nineteen_of_twenty_machines_tell_a_place(study: list[studies.Machine]) -> None:
    assert sum(one["valid"] > 0.0 and not one["named"] for one in study) >= 0.95 * len(study)


@pytest.mark.full
def test_no_touch_of_the_study_presses_harder(study: list[studies.Machine]) -> None:
    hold_force(study)
