"""Faults of the rotary fast tool servo in the state `Commission`: rows of the matrix in `fts.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection

from ..matrix import Row

ARM, TORQUE = "controller.arm_angle", "plant.torque"

ASTRAY = "max(abs(plant.tip_depth - first(plant.tip_depth))[controller.drive_enable > 0.5])"
"""How far the tool is from where it began while the drive is on."""
MEASURING = 'controller.state == "Commission"'

SWING = "its travel of 1.75 mm, and `limits.retract` = 1 mm of the way out"
LEFT = "its travel of 1.75 mm, the following error of 1 mm, and 0.5 mm in the samples until it is told"
WEAK = (
    "WeakDrive", "FollowingError", "PositionFrozen", "CommissionRejected",
)  # fmt: skip
SLOW, MIDDLE, QUICK = 1.1, 4.0, 7.0
"""In the slow swings of more than a millimetre, in those below the flexure, in those about it, s."""


def commission(
    name: str, faults: tuple[str, ...], limit: float, why: str, after: float, to: str, **kind: object
) -> Row:
    """Row of what goes wrong so long after the beginning of a commission."""
    inject = (Injection(to, when=MEASURING, after=after, **kind),)  # type: ignore[arg-type]
    at_once = after == SLOW or "CommissionRejected" not in faults
    lasts = (f"loop.duration={after + TOLD}",) if at_once else LASTS
    return Row(name, faults, ASTRAY, limit, why, inject, (), lasts, "fts/commission", "m")


LASTS = ("loop.duration=10.9",)
"""What may be told only when it ends."""
TOLD = 2.9
"""What is told at once, s after it began: the arm has stopped by then."""

ROWS = (
    commission(
        "commission: arm encoder frozen in a slow swing",
        ("PositionFrozen",),
        3.25e-3,
        LEFT,
        SLOW,
        ARM,
        frozen=True,
    ),
    commission(
        "commission: arm encoder frozen about the flexure",
        ("PositionFrozen", "CommissionRejected"),
        3.25e-3,
        LEFT,
        QUICK,
        ARM,
        frozen=True,
    ),
    commission(
        "commission: arm encoder NaN", ("PositionLost",), 3.25e-3, LEFT, MIDDLE, ARM, value=float("nan")
    ),
    commission("commission: arm encoder 5 mrad off", ("PositionJump",), 3.25e-3, LEFT, SLOW, ARM, offset=5e-3),
    commission("commission: torque lost in a slow swing", WEAK, 3.25e-3, LEFT, SLOW, TORQUE, value=0.0),
    commission("commission: torque lost about the flexure", WEAK, 3.25e-3, LEFT, QUICK, TORQUE, value=0.0),
    commission(
        "commission: torque of the wrong sign in a slow swing",
        ("DriveSign", "FollowingError"),
        3.25e-3,
        LEFT,
        SLOW,
        TORQUE,
        scale=-1.0,
    ),
    commission(
        "commission: torque of the wrong sign about the flexure",
        ("DriveSign", "FollowingError", "WeakDrive"),
        3.25e-3,
        LEFT,
        QUICK,
        TORQUE,
        scale=-1.0,
    ),
    commission(
        "commission: a third of the torque from the middle on", WEAK, 3.25e-3, LEFT, MIDDLE, TORQUE, scale=0.3
    ),
    commission(
        "commission: commands four samples later from the middle on",
        ("CommissionRejected",),
        3.25e-3,
        SWING,
        MIDDLE,
        TORQUE,
        late=4,
    ),
    Row(
        "commission: the arm sticks",
        WEAK,
        ASTRAY,
        3.25e-3,
        LEFT,
        changes=("plant.coulomb_friction=1.0", f"loop.duration={SLOW + TOLD}"),
        scenario="fts/commission",
        unit="m",
    ),
    Row(
        "commission: a flexure of 2 kHz that is told as 1.2 kHz",
        ("CommissionRejected",),
        ASTRAY,
        3.25e-3,
        SWING,
        changes=("plant.flexure_frequency=2000", *LASTS),
        scenario="fts/commission",
        unit="m",
    ),
)
