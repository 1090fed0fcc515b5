"""Simulated faults of the polishing robot in the state `Commission`: rows of the matrix in `polish.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from ..matrix import Row

FORCE = "max(plant.contact_force)"
BESIDE = "max(hypot(plant.axis_x - first(plant.axis_x), plant.axis_y - first(plant.axis_y)))"
DOWN = "max(first(plant.axis_z) - plant.axis_z)"
ABOVE = "still above the mold"
TRAVEL = (
    "half of `commission.travel`, `expert.limits.following_error`, and 1.3 mm that 31 kg coast from 14 mm/s"
)
SEEN = "5 N, and 0.25 s of `expert.limits.frozen_time` at the command for a force that does not rise"
TOUCH = "0.25 s of `expert.limits.frozen_time` at `approach.velocity`, 50 um in the air: 75 um at 178 N/mm"
HELD = "5 N and the ripple of the control law"

MEASURING = 'controller.state == "Commission"'
SIGNALS = (
    Signal("controller.commission", (0.0, 0.01), (False, True)),
    Signal("controller.enable", (0.0,), (False,)),
)
# the retract takes 0.1 s more
LASTS = ("loop.duration=21", "loop.stop_when=time > 20.5")
REST = 3.0
"""Time after the fault, s: most faults are detected within half a second, and then the machine is at rest."""
UP, EXCITED, DOWNWARDS, PRESSED, ALONG, ACROSS = 0.15, 2.5, 5.6, 8.0, 14.0, 17.0
"""Times in the parts of the commissioning run, s."""


def commission(
    name: str,
    faults: str,
    after: float,
    to: str,
    *,
    most: float,
    why: str,
    truth: str = FORCE,
    **kind: object,
) -> Row:
    """Row of the state `Commission` with a fault this time after its start."""
    inject = (Injection(to, when=MEASURING, after=after, **kind),)  # type: ignore[arg-type]
    unit = "N" if truth == FORCE else "m"
    lasts = (f"loop.duration={after + REST}",)
    return Row(
        f"commission: {name}", tuple(faults.split()), truth, most, why, inject, SIGNALS, lasts, unit=unit
    )


def changed(name: str, faults: str, *changes: str, most: float = 5.6, why: str = HELD) -> Row:
    """Row of a robot that cannot be identified."""
    return Row(
        f"commission: {name}",
        tuple(faults.split()),
        FORCE,
        most,
        why,
        (),
        SIGNALS,
        (*LASTS, *changes),
        unit="N",
    )


READINGS = (
    commission(
        "encoder x frozen during the excitation", "PositionFrozen", EXCITED, "controller.position.x",
        truth=BESIDE, most=1.8e-3, why=TRAVEL, frozen=True,
    ),
    commission(
        "encoder z lost during the rise", "PositionLost", UP, "controller.position.z",
        most=0.0, why=ABOVE, value=float("nan"),
    ),
    commission(
        "encoder y jumps by 10 mm during the excitation", "PositionJump", EXCITED, "controller.position.y",
        truth=BESIDE, most=1.8e-3, why=TRAVEL, offset=10e-3,
    ),
    commission(
        "force frozen during the descent", "ForceFrozen", DOWNWARDS, "controller.force.z",
        most=14.0, why=TOUCH, frozen=True,
    ),
    commission(
        "force frozen while pressing", "ForceFrozen", PRESSED, "controller.force.z",
        most=13.0, why=SEEN, frozen=True,
    ),
    commission(
        "force frozen while rubbing", "ForceFrozen", ALONG, "controller.force.z",
        most=13.0, why=SEEN, frozen=True,
    ),
    commission(
        "force x lost while rubbing", "ForceLost", ACROSS, "controller.force.x",
        most=5.6, why=HELD, value=float("nan"),
    ),
    commission(
        "force ten times as noisy while rubbing", "NoisyForce", ALONG, "controller.force.z",
        most=6.6, why="5 N, and the response of the control law to the noise", noise=0.5,
    ),
)  # fmt: skip

DRIVES = (
    commission(
        "pulses x reversed during the excitation", "DriveSign", EXCITED, "plant.pulses_x",
        truth=BESIDE, most=1.8e-3, why=TRAVEL, scale=-1.0,
    ),
    commission(
        "pulses z reversed during the rise", "DriveSign", 0.11, "plant.pulses_z",
        truth=DOWN, most=0.2e-3, why="`expert.limits.following_error` below where it began", scale=-1.0,
    ),
    commission(
        "pulses y lost during the excitation", "PositionFrozen", EXCITED, "plant.pulses_y",
        truth=BESIDE, most=1.8e-3, why=TRAVEL, value=0.0,
    ),
    commission(
        "drive z at 0.3 during the excitation", "WeakDrive", EXCITED, "plant.pulses_z",
        truth=DOWN, most=0.2e-3, why=ABOVE, scale=0.3,
    ),
    commission(
        "pulses z lost while pressing", "ForceError PositionFrozen", PRESSED, "plant.pulses_z",
        most=5.6, why=HELD, value=0.0,
    ),
    commission(
        "drive z moves down at 5 mm/s while rubbing", "DriveSign", ALONG, "plant.pulses_z",
        most=32.0, why="`expert.limits.following_error` at 178 N/mm, 5 N, and 8 kg with 5 mm/s: 6 N",
        value=-5.0,
    ),
)  # fmt: skip

ROBOTS = (
    Row(
        "commission: no mold",
        ("ApproachTimeout",),
        FORCE,
        0.0,
        "there is none",
        (),
        (*SIGNALS, Signal("plant.mold_lift", (0.0, 0.0), (0.0, -3e-3))),
        LASTS,
        unit="N",
    ),
    changed(
        "a tip and a mold a third as stiff as configured",
        "CommissionRejected",
        "controller.stiffness.nominal=500e3",
        "controller.impedance.damping=28e3",
    ),
    changed("a mold without friction", "CommissionRejected", "plant.friction=0.01"),
    changed(
        "drives a third as fast as configured",
        "CommissionRejected",
        "plant.drive_gain=0.3",
    ),
)

ROWS = (*READINGS, *DRIVES, *ROBOTS)
