"""Contact detection on unknown machines: `studies/dob-commission.toml`, before and after.

Half of the machines apply the result of the commissioning run, the other half keep the configured values.
`pytest -m full -rP` runs the whole study and prints the table of `docs/results/dob.md`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ..measured import store
from ..samples import studies
from ..samples.runs import run, trace, value
from . import machine

pytestmark = pytest.mark.acceptance

FEW = (5, 91_017)
"""Machines of the default run, and their seed; no study has it."""
NOMINAL_MASS = 10.0


class Machine(machine.Machine):
    """A machine of the study and its result."""

    @property
    def thrust(self) -> float:
        """Thrust constant for the nominal mass."""
        return float(self.changes["plant.force_constant"] * NOMINAL_MASS / self.changes["plant.mass"])

    @property
    def delay(self) -> int:
        """Samples between a command and its action."""
        late = self.changes["inject.plant.current.from_time"] == 0.0
        return int(self.changes["loop.compute_delay"]) + int(late)


def machines(few: tuple[int, int] | None = None) -> list[Machine]:
    """Machines of the study, or a few that are sampled again with a seed."""
    return [Machine(one.changes, one.result) for one in studies.machines("dob-commission", few)]


def show(found: Sequence[Machine]) -> None:
    """Print the results of the machines, grouped by whether they apply the result."""
    for applied in (False, True):
        those = [one for one in found if one.applied is applied]
        depth = np.array([one["depth"] for one in those if one["done"]]) * 1e6
        ends = {name: sum(one[name] > 0.0 for one in those) for name in ("good", "reported", "undetected")}
        ratio = [one["gain_ratio"] for one in those]
        print(
            f"applied {applied}: {len(those)} machines, {ends}, "
            f"depth {np.median(depth):.3f}/{depth.max():.3f} um, "
            f"drive gain ratio {min(ratio):.2f} to {max(ratio):.2f}"
        )
    measured = [one for one in found if one["io_delay"] != 0.0]
    thrust = np.array([one["force_constant"] / one.thrust - 1.0 for one in measured])
    delay = np.array([one["io_delay"] - one.delay for one in measured])
    longest = max(one["commissioned"] for one in found)
    print(
        f"measured {len(measured)} of {len(found)} in at most {longest:.1f} s: "
        f"thrust constant {thrust.min():+.2%} to {thrust.max():+.2%}, "
        f"delay {delay.min():+.2f} to {delay.max():+.2f} samples, {sum(abs(delay) < 0.5)} rounded right"
    )


def keep(found: Sequence[Machine]) -> None:
    """Keep the results of the machines, grouped by whether they apply the result."""
    for row, applied in (("nominal", False), ("applied", True)):
        those = [one for one in found if one.applied is applied]
        depth = np.array([one["depth"] for one in those if one["done"]]) * 1e6
        ends = {name: sum(one[name] > 0.0 for one in those) for name in ("good", "reported")}
        ratio = [one["gain_ratio"] for one in those]
        store.measured(
            "dob-commission", row, machines=len(those), **ends,
            depth=float(np.median(depth)), most=depth.max(),
            share_least=min(ratio), share_most=max(ratio),
        )  # fmt: skip
    thrust = 100.0 * np.array([one["force_constant"] / one.thrust - 1.0 for one in found])
    delay = np.array([one["io_delay"] - one.delay for one in found])
    store.measured(
        "dob-measured", "found", machines=len(found), seconds=max(one["commissioned"] for one in found),
        thrust_least=thrust.min(), thrust_most=thrust.max(), delay_least=delay.min(), delay_most=delay.max(),
        rounded=int(sum(abs(delay) < 0.5)),
    )  # fmt: skip


def hold(found: Sequence[Machine], least: float) -> None:
    """Check the machines that apply the result; none may miss the touch without a fault."""
    show(found)
    applied = [one for one in found if one.applied]
    assert sum(one["good"] for one in applied) >= least * len(applied)
    for one in applied:
        # one may be a little deeper than the figure: it has up to twice the noise
        touched = one["detected"] and not one["early"] and one["depth"] < 5e-7
        assert touched or one["reported"]
    for one in found:
        assert one["commissioned"] < 120.0
        assert one["back"] < 9.5e-5
        assert one["ahead"] < 1e-6
        # the ripple of the thrust is 1 %
        assert one["force_constant"] == pytest.approx(one.thrust, rel=0.015)
        assert abs(one["io_delay"] - one.delay) < 0.5


def hold_stds(found: Sequence[Machine]) -> None:
    """Compare the reported standard deviations with the errors of the measured values."""
    # friction of 10 N.s/m, and noise with the steps of 1 nm
    noise = [np.hypot(one.changes["plant.encoder_noise"], 1e-9 / np.sqrt(12.0)) for one in found]
    errors = {
        "force_constant": [one["force_constant"] - one.thrust for one in found],
        "io_delay": [one["io_delay"] - one.delay for one in found],
        "damping": [one["damping"] - 10.0 * NOMINAL_MASS / one.changes["plant.mass"] for one in found],
        "position_noise": [one["position_noise"] - true for one, true in zip(found, noise, strict=True)],
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
    keep(found)


def test_measured_values_are_correct() -> None:
    result = run("dob/commission")
    rows = trace(result)
    measured = {
        name: float(rows[f"controller.measured.{name}"][-1])
        for name in ("damping", "damping_std", "position_noise", "io_delay", "io_delay_std")
    }
    # 10 N.s/m on 12 kg that are configured as 10
    assert abs(measured["damping"] - 10.0 * 10.0 / 12.0) < 4.0 * measured["damping_std"]
    # 0.5 nm of noise and the steps of 1 nm
    assert measured["position_noise"] == pytest.approx(np.hypot(0.5e-9, 1e-9 / np.sqrt(12.0)), rel=0.05)
    assert measured["io_delay"] == pytest.approx(2.0, abs=0.5)
    assert value(result, "force_constant") == pytest.approx(16.0 * 10.0 / 12.0, rel=0.012)
