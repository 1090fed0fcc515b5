"""Polishing by unmeasured robots: `studies/polish-commission.toml`, before and after the run.

Half of the robots use the measured values, the other half the configured ones.
`pytest -m full -rP` runs the whole study and prints the tables of `docs/results/polish.md`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ..measured import store
from ..samples import studies
from ..samples.runs import run, value
from . import machine

pytestmark = pytest.mark.acceptance

FEW = (4, 91_023)
"""Robots of the default run, and their seed; no study has it."""
CONTACT = 1.2e6
"""Stiffness of ball and mold, which no study varies."""


class Machine(machine.Machine):
    """A robot of the study and its result."""

    def truth(self, name: str) -> float:
        """Ground truth of the plant for a metric."""
        change = self.changes
        tip = float(change["plant.tip_stiffness"])
        return {
            "stiffness": 1.0 / (1.0 / tip + 1.0 / CONTACT),
            "lateral_stiffness": tip * float(change["plant.tip_lateral"]),
            "friction": float(change["plant.friction"]),
            "drive_gain": float(change["plant.drive_gain"]),
            "feedforward": float(change["plant.feedforward"]),
            "io_delay": 1.0 + float(change["loop.compute_delay"]),
            "rotation": float(change["plant.sensor_turn"]),
        }[name]


def machines(few: tuple[int, int] | None = None) -> list[Machine]:
    """Robots of the study, or this number of robots that are sampled with another seed."""
    return [Machine(one.changes, one.result) for one in studies.machines("polish-commission", few)]


def relative(found: Sequence[Machine], name: str) -> np.ndarray:
    """Relative errors of the measured values of all robots."""
    return np.array([one[name] / one.truth(name) - 1.0 for one in found])


def absolute(found: Sequence[Machine], name: str) -> np.ndarray:
    """Absolute errors of the measured values of all robots."""
    return np.array([one[name] - one.truth(name) for one in found])


def ends(found: Sequence[Machine]) -> dict[str, dict[str, float]]:
    """Results of the robots, separated by the use of the measured values."""
    rows = {}
    for row, applied in (("nominal", False), ("applied", True)):
        those = [one for one in found if one.applied is applied]
        done = [one for one in those if one["done"] > 0.0]
        deviation = [one["force_std"] for one in done]
        gain = [one["gain"] for one in done]
        rows[row] = {
            "machines": len(those), "good": sum(one["good"] > 0.0 for one in those),
            "reported": sum(one["reported"] > 0.0 for one in those),
            "std": float(np.median(deviation)), "most": max(deviation),
            "gain": float(np.median(gain)), "least": min(gain),
        }  # fmt: skip
    return rows


def measures(found: Sequence[Machine]) -> dict[str, float]:
    """Errors of the measured values, on the robots that have them."""
    told = [one for one in found if one["stiffness"] > 0.0]
    rows: dict[str, float] = {"machines": len(told), "seconds": max(one["commissioned"] for one in found)}
    for name in ("stiffness", "lateral_stiffness", "friction", "drive_gain", "feedforward"):
        error = 100.0 * relative(told, name)
        rows |= {f"{name}_least": error.min(), f"{name}_most": error.max()}
    delay, rotation = absolute(told, "io_delay"), np.degrees(absolute(told, "rotation"))
    rows |= {"io_delay_least": delay.min(), "io_delay_most": delay.max()}
    rows |= {"rotation_least": rotation.min(), "rotation_most": rotation.max()}
    return rows | {"rounded": int(sum(abs(delay) < 0.5))}


def hold(found: Sequence[Machine], least: float) -> dict[str, dict[str, float]]:
    """Check the requirements for the robots; return their results."""
    rows = ends(found)
    print(rows, measures(found))
    assert rows["applied"]["good"] >= least * rows["applied"]["machines"]
    for one in found:
        assert one["commissioned"] < 120.0
        assert one["pressed"] < 5.5
        assert one["beside"] < 5.1e-4
        assert one["above"] < 7.2e-4
    told = [one for one in found if one["stiffness"] > 0.0]
    assert len(told) >= least * len(found)
    assert abs(relative(told, "stiffness")).max() < 0.06
    assert abs(relative(told, "lateral_stiffness")).max() < 0.12
    assert abs(relative(told, "friction")).max() < 0.04
    # the friction of the guides stiffens the loops
    assert abs(relative(told, "drive_gain") - 0.1).max() < 0.15
    assert abs(relative(told, "feedforward") + 0.1).max() < 0.15
    assert abs(absolute(told, "io_delay")).max() < 0.25
    assert abs(absolute(told, "rotation")).max() < 0.03
    return rows


def hold_stds(found: Sequence[Machine]) -> None:
    """Compare the reported standard deviations with the errors of the measured values."""
    names = (
        "stiffness",
        "lateral_stiffness",
        "friction",
        "drive_gain",
        "feedforward",
        "io_delay",
        "rotation",
    )
    studies.hold_stds(found, {name: absolute(found, name).tolist() for name in names})


def test_a_few_robots() -> None:
    hold(machines(FEW), 1.0)


@pytest.mark.full
def test_the_whole_study() -> None:
    found = machines()
    assert len(found) == 200
    rows = hold(found, 0.95)
    hold_stds([one for one in found if one["stiffness"] > 0.0])
    for row, values in rows.items():
        store.measured("polish-commission", row, **values)
    store.measured("polish-measured", "found", **measures(found))


def test_a_sensor_with_two_inverted_axes_is_identified_and_used() -> None:
    # y and z inverted: a robot with the nominal mounting presses in the wrong direction
    changes = (
        "wire.controller.force.y.scale=-1",
        "wire.controller.force.z.scale=-1",
    )
    result = run("polish/commission", *changes)
    assert value(result, "good") == 1.0
    assert value(result, "rotation") == pytest.approx(0.4, abs=0.03)
    told = run("polish", "wire.controller.force.z.scale=-1", "loop.duration=4", "plant.sensor_turn=0.4")
    assert value(told, "done") == 0.0
