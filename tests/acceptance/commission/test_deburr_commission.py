"""Unmeasured robots: `studies/deburr-commission.toml`, before and after the commissioning run.

Half of the robots use the measured values, the other half the patterns of the nominal drives.
`pytest -m full -rP` runs the whole study and prints the table of `docs/results/deburr.md`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from plants.cylindrical_robot import CylindricalRobot
from plants.cylindrical_robot_parameters import CylindricalRobotParameters

from ..measured import store
from ..samples import studies
from ..samples.runs import run, trace
from . import machine

pytestmark = pytest.mark.acceptance

Array = NDArray[np.float64]

FEW = (6, 91_018)
"""Robots of the default run, and their seed; no study has it."""
PERIOD = 0.01


class Robot(machine.Machine):
    """A robot of the study and how it ended."""

    @property
    def gain(self) -> float:
        """Velocity over commanded velocity of its drives."""
        return float(self.changes["plant.drive_gain"])

    @property
    def delay(self) -> int:
        """Samples between a command and its action."""
        return int(self.changes["loop.compute_delay"])

    @property
    def late(self) -> float:
        """Delay and lag of its drives together, s."""
        lag = 2.0 * self.changes["plant.drive_damping"] / self.changes["plant.drive_frequency"]
        return float(PERIOD * self.delay + lag)

    def held(self, axis: int) -> float:
        """Displacement by which friction holds a drive back, force over its stiffness, rad or m."""
        force = getattr(CylindricalRobotParameters, f"axis{axis}_force")
        stiffness = stiffnesses(self.changes["plant.drive_frequency"], self.changes["plant.drive_damping"])
        return float(self.changes["plant.coulomb_friction"] * force / stiffness[axis])

    @property
    def error(self) -> float:
        """Larger of the largest errors of the axes 1 and 3 at the tip, m."""
        return max(self["error_1"], self["error_3"])


@cache
def stiffnesses(frequency: float, damping: float) -> dict[int, float]:
    """Stiffness of the drives 1 and 3, N.m/rad or N/m."""
    plant = CylindricalRobot(CylindricalRobotParameters(drive_frequency=frequency, drive_damping=damping))
    return {axis: float(plant.model.actuator(f"axis_{axis}").gainprm[0]) for axis in (1, 3)}


def robots(few: tuple[int, int] | None = None) -> list[Robot]:
    """Robots of the study, or a number of them that is sampled with another seed."""
    return [Robot(one.changes, one.result) for one in studies.machines("deburr-commission", few)]


def ends(found: Sequence[Robot]) -> dict[str, int]:
    """Numbers of robots that ended well, with a fault, and badly without one."""
    return {name: sum(one[name] > 0.0 for one in found) for name in ("good", "reported", "undetected")}


def off(found: Sequence[Robot]) -> tuple[Array, Array]:
    """Errors of the measured gains, and of delay with lag (s), of the axes 1 and 3."""
    gain = np.array([one[f"gain_{axis}"] / one.gain - 1.0 for one in found for axis in (1, 3)])
    late = np.array([one[f"late_{axis}"] - one.late for one in found for axis in (1, 3)])
    return gain, late


def held_off(found: Sequence[Robot]) -> Array:
    """Errors of the measured friction, at the tip, of the axes 1 and 3, m."""
    reach = CylindricalRobotParameters.tuned_radius
    return np.array(
        [
            lever * (one[f"friction_{axis}"] - one.held(axis))
            for one in found
            for axis, lever in ((1, reach), (3, 1.0))
        ]
    )


def show(found: Sequence[Robot]) -> None:
    """Print the results of the robots, with and without the measured values."""
    for applied in (False, True):
        those = [one for one in found if one.applied is applied]
        error = 1e3 * np.array([one.error for one in those if not one["reported"]])
        tip = 1e3 * np.array([one["tip"] for one in those if not one["reported"]])
        most = "none ran"
        if len(error):
            high = np.percentile(error, 95)
            most = f"error {np.median(error):.3f}/{high:.3f}/{error.max():.3f} mm, tip {tip.max():.3f} mm"
        print(f"applied {applied}: {len(those)} robots, {ends(those)}, {most}")
    gain, late = off(found)
    longest = max(one["commissioned"] for one in found)
    rounded = sum(round(one["io_delay"]) == one.delay for one in found)
    print(
        f"measured {len(found)} in at most {longest:.1f} s: gain {gain.min():+.2%} to {gain.max():+.2%}, "
        f"late {1e3 * late.min():+.2f} to {1e3 * late.max():+.2f} ms, delay rounded right on {rounded}, "
        f"idle speed {min(one['idle'] for one in found):+.3%} to {max(one['idle'] for one in found):+.3%}"
    )


def keep(found: Sequence[Robot]) -> None:
    """Store the results of the robots, with and without the measured values."""
    nominal, applied = ([one for one in found if one.applied is applied] for applied in (False, True))
    counts = ends(nominal)
    store.measured(
        "deburr-commission", "nominal", robots=len(nominal), good=counts["good"], reported=counts["reported"]
    )  # fmt: skip
    counts, ran = ends(applied), [one for one in applied if not one["reported"]]
    error = 1e3 * np.array([one.error for one in ran])
    store.measured(
        "deburr-commission", "applied", robots=len(applied), good=counts["good"], reported=counts["reported"],
        median=float(np.median(error)), high=float(np.percentile(error, 95)), most=error.max(),
        tip=1e3 * max(one["tip"] for one in ran),
    )  # fmt: skip
    gain, late = off(found)
    idle = [100.0 * one["idle"] for one in found]
    store.measured(
        "deburr-measured", "found", robots=len(found), seconds=max(one["commissioned"] for one in found),
        gain_least=100.0 * gain.min(), gain_most=100.0 * gain.max(),
        late_least=1e3 * late.min(), late_most=1e3 * late.max(),
        rounded=sum(round(one["io_delay"]) == one.delay for one in found),
        idle_least=min(idle), idle_most=max(idle), travel=1e3 * max(one["travel"] for one in found),
    )  # fmt: skip


def hold(found: Sequence[Robot], least: float) -> None:
    """Check the robots that use the measured values; none may miss the limit by far without a fault."""
    show(found)
    applied = [one for one in found if one.applied]
    assert sum(one["good"] for one in applied) >= least * len(applied)
    assert all(one["reported"] or one.error < 5e-5 for one in applied)
    # the others need it
    assert sum(one["good"] for one in found if not one.applied) < 0.2 * (len(found) - len(applied))
    for one in found:
        assert one["commissioned"] < 120.0
        assert one["travel"] < 3.35e-2
        assert one["down"] < 3e-4
        assert round(one["io_delay"]) == one.delay
        assert abs(one["idle"]) < 1e-3
    gain, late = off(found)
    assert np.abs(held_off(found)).max() < 6e-6
    # friction lets a reversal be late, and is no noise
    assert np.abs(gain).max() < 5e-3
    assert np.abs(late).max() < 1e-3


def hold_stds(found: Sequence[Robot]) -> None:
    """Compare the claimed standard deviations with the errors of the measured values."""
    errors = {
        "io_delay": [one["io_delay"] - one.delay for one in found],
        "idle": [one["idle"] for one in found],
    }
    for axis in (1, 3):
        errors[f"gain_{axis}"] = [one[f"gain_{axis}"] - one.gain for one in found]
        errors[f"late_{axis}"] = [one[f"late_{axis}"] - one.late for one in found]
        errors[f"frequency_{axis}"] = [
            one[f"frequency_{axis}"] - one.changes["plant.drive_frequency"] for one in found
        ]
        errors[f"friction_{axis}"] = [one[f"friction_{axis}"] - one.held(axis) for one in found]
    studies.hold_stds(found, errors)


def test_a_few_robots() -> None:
    hold(robots(FEW), 1.0)


@pytest.mark.full
def test_the_whole_study() -> None:
    found = robots()
    assert len(found) == 200
    hold(found, 0.95)
    hold_stds(found)
    keep(found)


def test_the_measured_values_are_correct() -> None:
    result = run("deburr/commission")
    rows = trace(result)
    measured = {name: float(rows[name][-1]) for name in rows.dtype.names if "measured" in name}
    for axis in range(1, 7):
        one = f"controller.measured.axis{axis}"
        assert measured[f"{one}.gain"] == pytest.approx(0.8, rel=3e-3)
        lag = 2.0 * 0.6 / 230.0
        assert measured[f"{one}.lag"] == pytest.approx(lag, abs=6e-4)
        assert 0.0 < measured[f"{one}.gain_std"] < 1e-3
    assert round(measured["controller.measured.io_delay"]) == 2
    # 0.5 rad/s, and the steps of 20,000 rpm over 4096
    noise = np.hypot(0.5, 20_000.0 * np.pi / 30.0 / 4096 / np.sqrt(12.0))
    assert measured["controller.measured.spindle_noise"] == pytest.approx(noise, rel=0.06)


def test_a_tool_that_idles_slower_cuts_at_its_own_speed() -> None:
    # the burr is cut after the commissioning run, with target and limit in the same ratio to the idle speed
    slow = ("plant.synchronous_speed=1440.0", "plant.rated_speed=1400.0")
    cut = (
        "signal.controller.mode.times=[0.0, 34.0]",
        "signal.controller.mode.values=['Idle', 'Deburr']",
        "signal.plant.workpiece.times=[0.0, 33.0]",
        "signal.plant.workpiece.values=[0.0, 1.0]",
        'loop.stop_when=\'(controller.state == "Done" and time > 34.5) or controller.state == "Fault"\'',
    )
    ended = {}
    for apply in (False, True):
        bare = ("controller.bank.compute=true", "controller.expert.lookup.enable=false")
        applied = f"controller.commission.apply={str(apply).lower()}"
        result = run("deburr/commission", *slow, *cut, *bare, applied)
        rows = trace(result)
        ended[apply] = (result.items["controller.fault"], rows["controller.fault"][-1], rows)
    names, fault, _ = ended[False]
    assert fault == names["SpindleSlow"]
    names, fault, rows = ended[True]
    assert fault == names["None"]
    assert rows["plant.burr_left"][-1] < 0.05 * rows["plant.burr_left"][0]
