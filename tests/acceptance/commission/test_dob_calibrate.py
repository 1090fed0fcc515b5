"""Calibration of the contact bias by touches: `studies/dob-calibrate.toml`.

`pytest -m full -rP` runs the whole study and prints the remaining errors;
`docs/results/dob.md` has its tables.
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
CALIBRATED = (1e-5, 5.4772e-5, 3e-4)
"""Calibrated speeds of the study on a workpiece that is not too hard for the fastest, m/s."""
FASTEST = 2.9e-4
"""A lower fastest speed was reduced by the force limit, m/s."""
CALIBRATION_TIME = 48.0
"""Maximum time of a calibration cycle, s: forty touches."""
MACHINE_TIME = 70.0
"""Maximum time of an unknown machine until it has measured its surface, s, as in the scenario."""
TWENTY = 28.0
"""Time of a calibration cycle of twenty touches, sufficient for four machines of five, s."""
TOUCH_SCATTER = 6e-8
"""`expert.limits.touch_scatter`, m."""
NEAR = 1e-7
"""Error of an accurate position, m."""
FORCE = 0.8
"""Maximum force of a touch, N."""


def accurate(one: studies.Machine) -> bool:
    """Whether the bias is within its allowed standard deviation at the approach speed."""
    return float(one.changes[SPEED]) > 0.999 * one["accurate_from"]


def errors(found: Sequence[studies.Machine], metric: str) -> tuple[float, float, float]:
    """Median, 90 % and maximum of the absolute error (nm)."""
    size = 1e9 * np.abs([one[metric] for one in found])
    return float(np.median(size)), float(np.percentile(size, 90)), float(size.max())


def deviations(found: Sequence[studies.Machine]) -> float:
    """Ratio of the position errors to their reported standard deviations, root of the mean square."""
    ratio = [one["position_error"] / one["position_std"] for one in found]
    return float(np.sqrt(np.mean(np.square(ratio))))


def show(found: Sequence[studies.Machine]) -> list[studies.Machine]:
    """Print and return the machines that reported a position."""
    reported = [one for one in found if one["valid"] and not one["reported"]]
    faults = sum(one["reported"] > 0.0 for one in found)
    print(f"{len(found)} machines, {len(reported)} reported a position, {faults} a fault")
    for speed in sorted({one.changes[SPEED] for one in reported}):
        those = [one for one in reported if one.changes[SPEED] == speed]
        mean = 1e9 * float(np.mean([one["position_error"] for one in those]))
        for metric in ("late", "constant", "position_error"):
            median, high, most = errors(those, metric)
            print(f"{1e6 * speed:.0f} um/s, {metric}: {median:.0f}/{high:.0f}/{most:.0f} nm, N {len(those)}")
        print(f"    mean error {mean:+.0f} nm, {deviations(those):.2f} of the standard deviation")
    return reported


def hold(found: Sequence[studies.Machine], least: float) -> list[studies.Machine]:
    """Check the calibrated machines; few may be wrong without a fault."""
    reported = show(found)
    assert len(reported) >= least * len(found)
    # beyond three reported standard deviations, without a fault
    assert sum(one["undetected"] for one in found) <= 0.01 * len(found)
    assert all(one["calibration_time"] <= CALIBRATION_TIME for one in found)
    assert np.percentile([one["calibration_time"] for one in found], 80) <= TWENTY
    assert all(one.result.simulated_s <= MACHINE_TIME for one in found)
    assert errors(reported, "position_error")[1] <= 60.0
    return reported


def hold_force(found: Sequence[studies.Machine]) -> None:
    """Check the force of the touches, in the calibration cycle and in the approach."""
    assert all(one["force"] <= FORCE for one in found)


def test_a_few_machines() -> None:
    found = studies.machines("dob-calibrate", FEW)
    hold(found, 0.3)
    hold_force(found)


def touched_as_calibrated(one: studies.Machine) -> bool:
    """Whether the approach was as fast as a touch of the calibration cycle."""
    return one.changes[SPEED] in CALIBRATED or one.changes[SPEED] >= one["fastest"]


def keep(found: Sequence[studies.Machine]) -> None:
    """Keep the results of the machines, grouped by whether their speed was calibrated."""
    reported = [one for one in found if one["valid"] and not one["reported"]]
    rejected = [one for one in found if one["rejected"]]
    scattered = sum(one["scatter"] > TOUCH_SCATTER for one in rejected)
    store.measured(
        "dob-teach", "ends", machines=len(found), positions=len(reported),
        share=100.0 * len(reported) / len(found),
        faster=sum(one["accurate_from"] > 1.001 * CALIBRATED[0] for one in reported),
        undetected=sum(one["undetected"] for one in found), scattered=scattered,
        unsure=len(rejected) - scattered,
        others=len(found) - len(reported) - len(rejected),
        hard=sum(one["force"] > FORCE for one in found), force=max(one["force"] for one in found),
        slower=sum(one["fastest"] < FASTEST for one in reported),
        slowest=1e6 * min(one["fastest"] for one in reported),
    )  # fmt: skip
    rows = {
        "calibrated": [one for one in reported if accurate(one) and touched_as_calibrated(one)],
        "between": [one for one in reported if accurate(one) and not touched_as_calibrated(one)],
        "slower": [one for one in reported if not accurate(one)],
    }
    for row, those in rows.items():
        size = errors(those, "position_error")
        store.measured(
            "dob-calibrated", row, machines=len(those),
            near=sum(abs(one["position_error"]) <= NEAR for one in those),
            median=size[0], high=size[1], most=size[2],
            constant=errors(those, "constant")[1], late=errors(those, "late")[1], rms=deviations(those),
        )  # fmt: skip


@pytest.fixture(scope="module")
def study() -> list[studies.Machine]:
    """All machines of the study."""
    return studies.machines("dob-calibrate")


@pytest.mark.full
def test_the_whole_study(study: list[studies.Machine]) -> None:
    assert len(study) == 120
    reported = hold(study, 0.7)
    # at every speed the error is a fraction of that with a constant bias
    assert errors(reported, "position_error")[1] <= 0.5 * errors(reported, "constant")[1]
    assert 0.5 < deviations(reported) < 1.3
    keep(study)


@pytest.mark.full
def test_nineteen_of_twenty_machines_report_a_position(study: list[studies.Machine]) -> None:
    assert sum(one["valid"] > 0.0 and not one["reported"] for one in study) >= 0.95 * len(study)


@pytest.mark.full
def test_no_touch_of_the_study_presses_harder(study: list[studies.Machine]) -> None:
    hold_force(study)
