"""Displaced parts: `studies/deburr-register.toml`, before and after the registration.

`pytest -m full -rP` runs the whole study and prints the table of `docs/results/deburr.md`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ..measured import store
from ..samples import studies
from ..samples.runs import run, trace, value

pytestmark = pytest.mark.acceptance

FEW = (3, 91_026)
"""Parts of the default run, and their seed; no study has it."""
MOST = 5e-5
"""Largest distance of the actual tip from the edge, m."""


def parts(few: tuple[int, int] | None = None) -> list[studies.Machine]:
    """Parts of the study, or a number of them that is sampled with another seed."""
    return studies.machines("deburr-register", few)


def largest(found: Sequence[studies.Machine], metric: str) -> tuple[float, float, float]:
    """Median, 95 % and maximum of a metric of those that ended without a fault."""
    values = np.array([one[metric] for one in found if not one["reported"]])
    return float(np.median(values)), float(np.percentile(values, 95)), float(values.max())


def turned(found: Sequence[studies.Machine]) -> tuple[float, float]:
    """Largest error of the angle (rad), and the rms of the errors over their standard deviations."""
    those = [one for one in found if not one["reported"]]
    off = np.array([one["angle"] - one.changes["plant.part_angle"] for one in those])
    sure = np.array([one["angle_std"] for one in those])
    return float(np.abs(off).max()), float(np.sqrt(np.mean((off / sure) ** 2)))


def hold(found: Sequence[studies.Machine], least: float) -> None:
    """Check the parts; none may miss the limit without a fault."""
    for metric in ("before", "tip", "cut"):
        median, high, most = largest(found, metric)
        print(f"{metric}: {1e3 * median:.3f}/{1e3 * high:.3f}/{1e3 * most:.3f} mm")
    off, scatter = turned(found)
    print(f"{len(found)} parts, angle {1e3 * off:.3f} mrad, {scatter:.2f} deviations")
    assert sum(one["good"] for one in found) >= least * len(found)
    assert not any(one["undetected"] for one in found)
    for one in found:
        if one["reported"]:
            continue
        assert one["tip"] <= MOST
        assert one["registered"] < 75.0
        assert 1e-5 < one["deflection"] < 1e-3
    assert off < 3e-4
    # without it they would be far off
    assert largest(found, "before")[2] > 10.0 * MOST


def keep(found: Sequence[studies.Machine]) -> None:
    """Store the results of the parts."""
    for name, metric in (("programmed", "before"), ("registered", "tip"), ("cut", "cut")):
        median, high, most = (1e3 * one for one in largest(found, metric))
        store.measured("deburr-register", name, median=median, high=high, most=most)
    off, scatter = turned(found)
    store.measured(
        "deburr-registered", "found", parts=len(found), off=1e3 * off, scatter=scatter,
        good=sum(one["good"] for one in found), reported=sum(one["reported"] for one in found),
        undetected=sum(one["undetected"] for one in found),
        seconds=largest(found, "registered")[2], deflection=1e3 * largest(found, "deflection")[2],
        residual=1e6 * largest(found, "residual")[2],
    )  # fmt: skip


def test_a_few_parts() -> None:
    hold(parts(FEW), 1.0)


@pytest.mark.full
def test_the_whole_study() -> None:
    found = parts()
    assert len(found) == 100
    hold(found, 0.95)
    keep(found)


def test_a_learned_bank_follows_the_part() -> None:
    # the bank of the nominal robot, without a commissioning run
    changes = (
        "controller.bank.import=bank.bin",
        "controller.commission.apply=false",
        "signal.controller.commission.values=[false, false]",
        "plant.drive_gain=1.0",
        "plant.drive_frequency=274.0",
    )
    result = run("deburr/register", *changes)
    rows = trace(result)
    assert value(result, "good") == 1.0
    assert value(result, "tip") <= MOST
    imported = result.items["controller.bank.status"]["Imported"]
    assert rows["controller.bank.status"][-1] == imported


def test_a_pretravel_that_is_not_configured_shifts_the_part_inwards() -> None:
    # both faces seem farther in, by the pretravel along both normals; the residual does not show it
    right, wrong = (
        run("deburr/register", f"controller.register.pretravel={travel}") for travel in (1e-5, 0.0)
    )
    x, y = (
        float(
            trace(wrong)[f"controller.registration.{c}"][-1]
            - trace(right)[f"controller.registration.{c}"][-1]
        )
        for c in "xy"
    )
    heading = np.radians(46.0)
    normals = np.array([[np.sin(heading), -np.cos(heading)], [np.cos(heading), np.sin(heading)]])
    assert normals @ np.array([x, y]) == pytest.approx([-1e-5, -1e-5], abs=1e-7)
    assert value(wrong, "residual") == pytest.approx(value(right, "residual"), abs=1e-7)
