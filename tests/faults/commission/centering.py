"""Simulated faults of centering in the state `Commission`: rows of the matrix in `centering.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from ..matrix import DONE, Row

PROBE, SLIDE, SPINDLE = (
    f"controller.{name}" for name in ("probe_position", "slide_position", "spindle_angle")
)
POSITION, VELOCITY = "plant.slide_position_setpoint", "plant.slide_velocity_setpoint"
# 45 rpm and the largest plant step: short runs
FAST = ("plant.spindle_speed=4.71238898038469", "plant.timestep=2e-4", "loop.substeps=5")
REACH = "max(plant.slide_position - first(plant.slide_position))"
"""Largest distance of the slide from its start."""
RING = "max(plant.eccentricity - cummin(plant.eccentricity))"
MEASURING = 'controller.state == "Commission"'
COMMISSION = Signal("controller.commission", (0.0, 0.01), (False, True))
THEN = Signal("controller.enable", (0.0, 10.0), (False, True))
LATER = Signal("controller.enable", (0.0, 13.0), (False, True))

KEPT = 1.8e-3, "1.6 mm of travel, and the overshoot of the slide beyond its setpoint"
LOST = 4e-3, "1.6 mm of travel, 1 mm of following error, and 65 mm/s for the 20 ms of the brake"
PRESSED = 5e-6, "force of the probe: a ring without contact is not moved"
APPLIED = ("controller.commission.apply=true",)


def row(name: str, faults: str, *inject: Injection, within: tuple[float, str] = KEPT, **more: object) -> Row:
    """Row of the state `Commission` alone; `faults` by spaces."""
    limit, why = within
    signals = (COMMISSION, Signal("controller.enable", (0.0,), (False,)))
    changes = (*FAST, "loop.duration=17.5", *more.pop("changes", ()))  # type: ignore[misc]
    name = f"commission: {name}"
    return Row(name, tuple(faults.split()), REACH, limit, why, inject, signals, changes, **more)  # type: ignore[arg-type]


def done(
    name: str,
    *inject: Injection,
    then: Signal = THEN,
    within: tuple[float, str] = PRESSED,
    changes: tuple[str, ...] = (),
) -> Row:
    """Row of a good commissioning run, and of a centering cycle with its result."""
    limit, why = within
    name, all_changes = f"commission: {name}", (*FAST, *APPLIED, *changes)
    return Row(name, (DONE,), RING, limit, why, inject, (COMMISSION, then), all_changes)


def measuring(to: str, after: float = 1.0, **kind: object) -> Injection:
    """Injection this time after the start of the commissioning run."""
    return Injection(to, when=MEASURING, after=after, **kind)  # type: ignore[arg-type]


def both(after: float = 1.0, **kind: object) -> tuple[Injection, Injection]:
    """Injection into position and velocity of the drive."""
    return measuring(POSITION, after, **kind), measuring(VELOCITY, after, **kind)


NAN = float("nan")
ROWS = (
    done("none"),
    done("one spike of the slide encoder", measuring(SLIDE, offset=0.01, duration=1e-3), then=LATER),
    done("slide is NaN for two samples", measuring(SLIDE, value=NAN, duration=2e-3), then=LATER),
    done("slide noise x 20", measuring(SLIDE, after=0.0, noise=4e-7)),
    done("servo of 28 Hz with an integral, 2 samples late", *both(after=0.0, late=1),
         changes=("plant.servo_bandwidth=28", "plant.servo_integral_time=0.05"),
         within=(5.5e-5, "a push beyond the axis, as the first one of a nominal machine")),
    row("slide encoder frozen", "PositionFrozen", measuring(SLIDE, frozen=True), within=LOST),
    row("slide encoder jumps by 10 mm", "PositionJump", measuring(SLIDE, offset=0.01), within=LOST),
    row("slide is NaN", "PositionLost", measuring(SLIDE, value=NAN), within=LOST),
    row("slide noise x 2000", "CommissionRejected", measuring(SLIDE, after=0.0, noise=4e-5)),
    row("probe is NaN", "ProbeLost", measuring(PROBE, value=NAN)),
    row("probe rises by 0.5 mm", "CommissionRejected", measuring(PROBE, ramp=1e-2)),
    row("spindle is NaN", "SpindleLost", measuring(SPINDLE, value=NAN)),
    row("drive lost", "FollowingError WeakDrive PositionFrozen", measuring("plant.enable", value=0.0),
        within=LOST),
    row("drive lost from the start", "FollowingError WeakDrive PositionFrozen",
        Injection("plant.enable", from_time=0.0, value=0.0), within=LOST),
    row("sign of the drive reversed from the start", "DriveSign", *both(after=0.0, scale=-1.0), within=LOST),
    row("drive gain of a third", "WeakDrive", *both(after=0.0, scale=0.3), within=LOST),
    row("servo of 15 Hz configured as 40 Hz", "CommissionRejected", changes=("plant.servo_bandwidth=15",),
        within=(2.4e-3, "1.6 mm of travel, and the overshoot of a slide of 15 Hz beyond its setpoint")),
    row("servo of 90 Hz configured as 40 Hz", "CommissionRejected", changes=("plant.servo_bandwidth=90",)),
)  # fmt: skip
