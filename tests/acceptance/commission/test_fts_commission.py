"""Fast tool servo on unmeasured machines: `studies/fts-commission*.toml`, before and after.

Half of the machines use the measured values, the other half the configured ones.
`pytest -m full -rP` runs the whole studies and prints the tables of `docs/results/fts.md`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ..measured import store
from ..samples import studies
from ..samples.runs import run, trace
from . import machine

pytestmark = pytest.mark.acceptance

FEW = (3, 93_017)
"""Machines of the default run, and their seed, which no study uses."""
FEW_AT_500_HZ = (2, 93_018)
TURN = 2.0 * np.pi
NEAR = {
    "inertia": 0.01, "dry_friction": 0.06, "viscous_friction": 0.15, "io_delay": 0.5,
    "tip_frequency": 0.025, "tip_damping": 0.005, "tip_inertia": 0.05,
}  # fmt: skip
"""Largest errors of the measured values: relative, except delay, damping and inertia ratio."""
PLAIN = ("io_delay", "tip_damping", "tip_inertia")


class Machine(machine.Machine):
    """A machine of the study and its result."""

    @property
    def truth(self) -> dict[str, float]:
        """Values to be measured; inertia and frictions relative to the commanded torque."""
        plant = {name.removeprefix("plant."): float(value) for name, value in self.changes.items()}
        inertia, gain = plant["hub_inertia"] + plant["arm_inertia"], plant["torque_gain"]
        return {
            "inertia": inertia / gain,
            "dry_friction": plant["coulomb_friction"] / gain,
            "viscous_friction": plant["viscous_friction"] / gain,
            "io_delay": plant["loop.compute_delay"] + plant["wire.plant.torque.delay"],
            "tip_frequency": plant["flexure_frequency"],
            "tip_damping": plant["flexure_damping"],
            "tip_inertia": plant["arm_inertia"] / inertia,
        }


def machines(name: str, few: tuple[int, int] | None = None) -> list[Machine]:
    """Machines of a study, or that many sampled with a seed."""
    return [Machine(one.changes, one.result) for one in studies.machines(name, few)]


def errors(found: Sequence[Machine]) -> dict[str, np.ndarray]:
    """Compare the measured values with the actual ones."""
    return {
        name: np.array(
            [(one[name] - one.truth[name]) / (1.0 if name in PLAIN else one.truth[name]) for one in found]
        )
        for name in NEAR
    }


def deviations(found: Sequence[Machine]) -> dict[str, np.ndarray]:
    """Compare the errors with the standard deviations that the controller claims."""
    return {
        name: np.array([(one[name] - one.truth[name]) / one[f"{name}_std"] for one in found]) for name in NEAR
    }


def ends(those: Sequence[Machine]) -> dict[str, float]:
    """Count the results of each kind; errors in um."""
    rms, tip = (np.array([one[name] for one in those]) * 1e6 for name in ("rms", "tip"))
    return {
        "machines": len(those),
        **{name: sum(one[name] > 0.0 for one in those) for name in ("good", "reported", "undetected")},
        "rms": float(np.median(rms)),
        "rms_most": rms.max(),
        "tip": float(np.median(tip)),
        "tip_most": tip.max(),
    }


def report(found: Sequence[Machine]) -> None:
    """Print the results with and without the measured values, and the measured values."""
    for applied in (False, True):
        print(f"applied {applied}:", ends([one for one in found if one.applied is applied]))
    for name, error in errors(found).items():
        sure = deviations(found)[name]
        spread = f"{np.sqrt(np.mean(sure**2)):.2f} standard deviations rms, at most {abs(sure).max():.2f}"
        print(f"{name}: {error.min():+.4f} to {error.max():+.4f}, {spread}")
    for name in ("commissioned", "travel", "oscillation_torque"):
        print(f"{name}: at most {max(one[name] for one in found):.4g}")
    print(f"bandwidth: at least {min(one['bandwidth'] for one in found if one.applied):.0f} Hz")


def keep(found: Sequence[Machine], rows: tuple[str, str]) -> None:
    """Store the results: a row with configured values, one with measured values."""
    for row, applied in zip(rows, (False, True), strict=True):
        store.measured("fts-commission", row, **ends([one for one in found if one.applied is applied]))


def keep_measured(found: Sequence[Machine]) -> None:
    """Store the errors of the measurements."""
    limits: dict[str, float] = {}
    for name, error in errors(found).items():
        scale, sure = 1.0 if name in PLAIN else 100.0, deviations(found)[name]
        limits |= {f"{name}_least": scale * error.min(), f"{name}_most": scale * error.max()}
        limits |= {f"{name}_rms": np.sqrt(np.mean(sure**2)), f"{name}_far": abs(sure).max()}
    store.measured(
        "fts-measured", "found", machines=len(found), seconds=max(one["commissioned"] for one in found),
        rounded=int(sum(abs(errors(found)["io_delay"]) < 0.5)),
        travel=1e3 * max(one["travel"] for one in found),
        torque=max(one["oscillation_torque"] for one in found),
        bandwidth=min(one["bandwidth"] for one in found if one.applied), **limits,
    )  # fmt: skip


def hold(found: Sequence[Machine], least: float) -> None:
    """Compare the machines that use the measured values with the demand, and all with the bounds."""
    report(found)
    applied = [one for one in found if one.applied]
    assert sum(one["good"] for one in applied) >= least * len(applied)
    for one in found:
        assert one["commissioned"] < 120.0
        assert one["travel"] < 1.75e-3
        assert one["oscillation_torque"] < 1.4
    for name, most in NEAR.items():
        assert abs(errors(found)[name]).max() < most, name
        assert abs(deviations(found)[name]).max() < 3.0, name


def test_a_few_machines() -> None:
    hold(machines("fts-commission", FEW), 1.0)


def test_a_few_machines_at_500_hz() -> None:
    hold(machines("fts-commission-500hz", FEW_AT_500_HZ), 1.0)


@pytest.mark.full
def test_the_whole_study() -> None:
    found = machines("fts-commission")
    assert len(found) == 200
    hold(found, 0.95)
    keep(found, ("nominal", "applied"))
    keep_measured(found)


@pytest.mark.full
def test_the_whole_study_at_500_hz() -> None:
    found = machines("fts-commission-500hz")
    hold(found, 0.95)
    keep(found, ("nominal at 500 Hz", "applied at 500 Hz"))


def test_the_measured_values_are_right_within_their_standard_deviations() -> None:
    rows = trace(run("fts/commission"))
    gain = 0.85
    truth = {
        "viscous_friction": 2.6e-3 / gain,
        "dry_friction": 0.013 / gain,
        "io_delay": 2.0,
        "tip_frequency": TURN * 930.0,
        "tip_inertia": 4.2 / 9.6,
        "tip_damping": 0.016,
    }
    for name, expected in truth.items():
        measured, deviation = (float(rows[f"controller.measured.{name}{kind}"][-1]) for kind in ("", "_std"))
        assert abs(measured - expected) < 2.0 * deviation, name
