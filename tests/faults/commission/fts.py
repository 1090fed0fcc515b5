"""Simulated faults of the fast tool servo in the state `Commission`: rows of the matrix in `fts.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection

from ..matrix import Row

ARM, TORQUE = "controller.arm_angle", "plant.torque"

OFF_START = "max(abs(plant.tip_depth - first(plant.tip_depth))[controller.drive_enable > 0.5])"
"""Largest distance of the tool from its start while the drive is on."""
MEASURING = 'controller.state == "Commission"'

RETRACTED = "its travel of 1.75 mm, and `limits.retract` = 1 mm of the retract"
LEFT = "its travel of 1.75 mm, the following error of 1 mm, and 0.5 mm in the samples until detection"
WEAK = (
    "WeakDrive", "FollowingError", "PositionFrozen", "CommissionRejected",
)  # fmt: skip
SLOW, MIDDLE, QUICK = 1.1, 4.0, 7.0
"""Times, s: in slow oscillations of more than a millimeter, below the flexure frequency, about it."""


def commission(
    name: str, faults: tuple[str, ...], limit: float, why: str, after: float, to: str, **kind: object
) -> Row:
    """Row of a fault this time after the start of the commissioning run."""
    inject = (Injection(to, when=MEASURING, after=after, **kind),)  # type: ignore[arg-type]
    immediate = after == SLOW or "CommissionRejected" not in faults
    lasts = (f"loop.duration={after + SEEN}",) if immediate else LASTS
    return Row(name, faults, OFF_START, limit, why, inject, (), lasts, "fts/commission", "m")


LASTS = ("loop.duration=10.9",)
"""Duration for faults that may be detected only at the end of the run."""
SEEN = 2.9
"""Time after an immediately detected fault, s: the arm has stopped by then."""

ROWS = (
    commission(
        "commission: arm encoder frozen in a slow oscillation",
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
    commission(
        "commission: arm encoder 5 mrad off", ("PositionJump",), 3.25e-3, LEFT, SLOW, ARM, offset=5e-3
    ),
    commission("commission: torque lost in a slow oscillation", WEAK, 3.25e-3, LEFT, SLOW, TORQUE, value=0.0),
    commission("commission: torque lost about the flexure", WEAK, 3.25e-3, LEFT, QUICK, TORQUE, value=0.0),
    commission(
        "commission: torque reversed in a slow oscillation",
        ("DriveSign", "FollowingError"),
        3.25e-3,
        LEFT,
        SLOW,
        TORQUE,
        scale=-1.0,
    ),
    commission(
        "commission: torque reversed about the flexure",
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
        "commission: commands four samples late from the middle on",
        ("CommissionRejected",),
        3.25e-3,
        RETRACTED,
        MIDDLE,
        TORQUE,
        late=4,
    ),
    Row(
        "commission: the arm sticks",
        WEAK,
        OFF_START,
        3.25e-3,
        LEFT,
        changes=("plant.coulomb_friction=1.0", f"loop.duration={SLOW + SEEN}"),
        scenario="fts/commission",
        unit="m",
    ),
    Row(
        "commission: a flexure of 2 kHz configured as 1.2 kHz",
        ("CommissionRejected",),
        OFF_START,
        3.25e-3,
        RETRACTED,
        changes=("plant.flexure_frequency=2000", *LASTS),
        scenario="fts/commission",
        unit="m",
    ),
)
