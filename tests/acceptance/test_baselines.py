"""The controllers compared with the simplest ones that could do the task.

Part by part for polishing, computed patterns for deburring.
"""

import math
from pathlib import Path

import pytest

from .measured.store import measured
from .samples.runs import run, value

pytestmark = [pytest.mark.acceptance, pytest.mark.full]

PARTS = {
    "integral": ("expert.force.integral_time=0",),
    "damping": ("expert.impedance.adaptive=false",),
    "misalignment": ("expert.misalignment.enable=false",),
    "ripple": ("expert.ripple.gain=0", "stick_slip.sliding=0"),
    "turns": ("expert.repetitive.gain=0",),
}
"""Parts of the default polishing controller beyond the plain force loop, and the values that disable them."""
STILL = ("controller.stick_slip.mode='Off'",)


def laws() -> dict[str, tuple[str, ...]]:
    """Name the changes from the default controller to the plain one, and all combinations between them."""
    found: dict[str, tuple[str, ...]] = {}
    for count, name in enumerate(("plain", *PARTS)):
        off = [change for part in list(PARTS.values())[count:] for change in part]
        found[name] = tuple(f"controller.{change}" for change in off)
    return {"plain, still": (*found["plain"], *STILL), **found, "turns, still": STILL}


def deviation(name: str, *changes: str) -> float:
    """Return the standard deviation of the force on the whole path, N; infinite after a fault."""
    done = run(name, *changes)
    return value(done, "force_std") if value(done, "done") else math.inf


def test_what_each_part_of_the_polishing_controller_is_worth() -> None:
    tilted = {}
    for name, changes in laws().items():
        tilted[name] = deviation("polish/misaligned", *changes)
        measured(
            "polish-parts", name, nominal=deviation("polish", *changes), tilted=tilted[name],
            fast=deviation("polish/20-mm-s", *changes), gain=value(run("polish", *changes), "gain"),
        )  # fmt: skip
    assert tilted["turns"] < 0.5 * tilted["plain"]


ROBOTS = {
    "nominal": (),
    "friction": ("plant.coulomb_friction=0.1",),
    "slow": ("plant.drive_frequency=224",),
    "quick": ("plant.drive_frequency=336",),
    "weak": ("plant.drive_gain=0.9",),
    "strong": ("plant.drive_gain=1.1",),
}
WIDE = tuple(f"controller.expert.limits.axis{axis}.pattern_error=0.1" for axis in range(1, 7))
"""Wide fault limits: the effect of a wrong pattern is measured and does not raise `PatternMismatch`."""


def test_patterns_that_are_computed_need_the_gain_and_identified_ones_do_not(tmp_path: Path) -> None:
    left: dict[str, dict[str, float]] = {"computed": {}, "identified": {}}
    for name, robot in ROBOTS.items():
        bank = tmp_path / f"{name}.bin"
        reported = run(
            "deburr/new-robot", *robot, "controller.learn.repetitions=0", f"controller.bank.export='{bank}'"
        )
        assert value(reported, "good") == 1.0
        patterns = {
            "computed": ("controller.bank.import=''", "controller.bank.compute=true"),
            "identified": (f"controller.bank.import='{bank}'",),
        }
        for law, changes in patterns.items():
            done = run("deburr/constant", *robot, *changes, *WIDE)
            left[law] |= {f"{name}_{axis}": 1e3 * value(done, f"error_{axis}") for axis in (1, 3)}
    for law, errors in left.items():
        measured("deburr-computed", law, **errors)
    assert left["computed"]["weak_1"] > 10.0 * left["identified"]["weak_1"]
