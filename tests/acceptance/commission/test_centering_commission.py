"""Centering on unknown machines: `studies/centering-commission.toml`, with and without the measured values.

Half of the machines use the result of the commissioning run, the other half the configured values.
`pytest -m full -rP` runs the whole study and prints the table of `docs/results/centering.md`.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import tau

import numpy as np
import pytest

from ..measured import store
from ..samples import studies
from ..samples.runs import run, value
from . import machine

pytestmark = pytest.mark.acceptance

FEW = (5, 92_043)
"""Machines of the default run, and their seed, which no study has."""


class Machine(machine.Machine):
    """A machine of the study and how it ended."""

    @property
    def delay(self) -> int:
        """Samples between a setpoint and its action."""
        return int(self.changes["loop.compute_delay"]) + 1

    @property
    def bandwidth_error(self) -> float:
        """Measured bandwidth over the actual one, minus 1."""
        return self["bandwidth"] / (tau * float(self.changes["plant.servo_bandwidth"])) - 1.0

    @property
    def integral_error(self) -> float:
        """Measured integral action minus the actual one, 1/s."""
        return self["integral"] - 1.0 / float(self.changes["plant.servo_integral_time"])


def machines(few: tuple[int, int] | None = None) -> list[Machine]:
    """Machines of the study, or a given number of new ones with a seed."""
    return [Machine(one.changes, one.result) for one in studies.machines("centering-commission", few)]


def ended(found: Sequence[Machine], applied: bool) -> dict[str, float]:
    """Summarize the results of the machines that use the measured values, or of the others."""
    those = [one for one in found if one.applied is applied]
    times = np.array([one["time_to_center"] for one in those if one["centered"]])
    ends = {name: float(sum(one[name] > 0.0 for one in those)) for name in ("good", "reported", "undetected")}
    return {
        "machines": float(len(those)), **ends, "median": float(np.median(times)),
        "high": float(np.percentile(times, 95)), "most": float(times.max()),
        "overshoot": 1e6 * float(np.percentile([one["overshoot"] for one in those], 95)),
    }  # fmt: skip


def measured(found: Sequence[Machine]) -> dict[str, float]:
    """Summarize the measured values."""
    bandwidth = 100.0 * np.array([one.bandwidth_error for one in found])
    integral = np.array([one.integral_error for one in found])
    delay = np.array([one["io_delay"] - one.delay for one in found])
    return {
        "machines": float(len(found)), "seconds": max(one["commissioned"] for one in found),
        "bandwidth_least": float(bandwidth.min()), "bandwidth_most": float(bandwidth.max()),
        "integral": float(abs(integral).max()), "delay_least": float(delay.min()),
        "delay_most": float(delay.max()), "rounded": float(sum(abs(delay) < 0.5)),
    }  # fmt: skip


def hold(found: Sequence[Machine], least: float) -> None:
    """Check the results of the machines that use the measured values, and all measured values."""
    for applied in (False, True):
        print(f"applied {applied}:", ended(found, applied))
    print(measured(found))
    those = [one for one in found if one.applied]
    assert sum(one["good"] for one in those) >= least * len(those)
    for one in found:
        assert one["commissioned"] < 120.0
        assert one["ahead"] < 2.0e-3
        assert one["back"] < 2.5e-4
        assert one.bandwidth_error == pytest.approx(0.0, abs=0.02)
        assert one.integral_error == pytest.approx(0.0, abs=1.0)
        assert one["io_delay"] == pytest.approx(one.delay, abs=0.3)


def hold_stds(found: Sequence[Machine]) -> None:
    """Compare the reported standard deviations with the errors."""
    errors = {
        "bandwidth": [one.bandwidth_error * one["bandwidth"] / (1.0 + one.bandwidth_error) for one in found],
        "damping": [one["damping"] - one.changes["plant.servo_damping"] for one in found],
        "integral": [one.integral_error for one in found],
        "io_delay": [one["io_delay"] - one.delay for one in found],
    }
    studies.hold_stds(found, errors)


def test_a_few_machines() -> None:
    hold(machines(FEW), 1.0)


@pytest.mark.full
def test_the_whole_study() -> None:
    found = machines()
    assert len(found) == 200
    hold(found, 0.95)
    hold_stds(found)
    for name, applied in (("nominal", False), ("applied", True)):
        store.measured("centering-commission", name, **ended(found, applied))
    store.measured("centering-measured", "found", **measured(found))


@pytest.mark.parametrize(("at_pusher", "end"), [(0.022, "centered"), (0.018, "reported")])
def test_a_misplaced_pusher_is_learned_or_raises_a_fault(at_pusher: float, end: str) -> None:
    result = run("centering/commission", f"plant.probe_at_pusher={at_pusher}")
    assert value(result, end) == 1.0
    assert value(result, "overshoot") < (5e-5 if end == "centered" else 1.6e-3)
