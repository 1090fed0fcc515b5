"""Faults of the deburring robot in the state `Commission`: rows of the matrix in `deburr.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from .matrix import Row

AXIS1, AXIS3 = ("controller.axis1.position", "controller.axis3.position")
DRIVE1, DRIVE3 = ("plant.axis1_velocity", "plant.axis3_velocity")
TOOL = "controller.spindle_speed"

ASTRAY1 = "max(abs(plant.axis1_position - controller.axis1.reference) * plant.axis3_position)"
"""Where axis 1 is against where it should be, at the tip; most of it is the lag of the bare servo."""
ASTRAY3 = "max(abs(plant.axis3_position - controller.axis3.reference))"
"""The same of axis 3."""

LAG = "the bare servo lags by V/Kp = 7.7 mm at the peak of a stroke"
FROZEN = f"{LAG}; at most 1 mm and 4 samples of 1 mm unanswered, then closed brakes"
WRONG = f"{LAG}; 1 mm, half of that lag and 4 samples of up to 2 mm, then closed brakes"
BRIDGED = f"{LAG}; at most 4 samples of 1 mm are bridged along the commands"

COMMISSION = Signal("controller.commission", (0.0, 0.5), (False, True))
MODE = Signal("controller.mode", (0.0,), ("Idle",))
MEASURING = 'controller.state == "Commission"'
FIRST, THIRD = 0.3, 8.9
"""Time from its beginning to the middle of the first stroke of axes 1 and 3, s."""


def commission(
    name: str, faults: tuple[str, ...], truth: str, limit: float, why: str, after: float, *to: str, **kind: object
) -> Row:
    """Row of the state `Commission`: what goes wrong so long after its beginning."""
    inject = tuple(Injection(one, when=MEASURING, after=after, **kind) for one in to)  # type: ignore[arg-type]
    return Row(name, faults, truth, limit, why, inject, (COMMISSION, MODE))


ROWS = (
    commission(
        "commission: encoder 1 frozen in its stroke",
        ("FrozenReading",),
        ASTRAY1,
        1e-2,
        FROZEN,
        FIRST,
        AXIS1,
        frozen=True,
    ),
    commission(
        "commission: encoder 3 frozen in its stroke",
        ("FrozenReading",),
        ASTRAY3,
        1e-2,
        FROZEN,
        THIRD,
        AXIS3,
        frozen=True,
    ),
    commission(
        "commission: encoder 3 off by 20 mm from then on",
        ("ReadingJump",),
        ASTRAY3,
        1e-2,
        BRIDGED,
        THIRD,
        AXIS3,
        offset=0.02,
    ),
    commission(
        "commission: encoder 3 is no number",
        ("LostReading",),
        ASTRAY3,
        1e-2,
        BRIDGED,
        THIRD,
        AXIS3,
        value=float("nan"),
    ),
    commission(
        "commission: encoder 3 stands while another axis moves, and its stroke comes",
        ("FrozenReading",),
        ASTRAY3,
        1e-2,
        FROZEN,
        FIRST,
        AXIS3,
        frozen=True,
    ),
    commission(
        "commission: drive 1 lost in its stroke",
        ("FrozenReading", "WeakDrive"),
        ASTRAY1,
        2e-2,
        WRONG,
        FIRST,
        DRIVE1,
        scale=0.0,
    ),
    commission(
        "commission: drive 3 of the wrong sign in its stroke",
        ("DriveSign",),
        ASTRAY3,
        2e-2,
        WRONG,
        THIRD,
        DRIVE3,
        scale=-1.0,
    ),
    commission(
        "commission: drive 3 does 0.3 of its command",
        ("WeakDrive",),
        ASTRAY3,
        2e-2,
        WRONG,
        THIRD,
        DRIVE3,
        scale=0.3,
    ),
    commission(
        "commission: brakes close in a stroke",
        ("FrozenReading", "WeakDrive", "FollowingError"),
        ASTRAY3,
        2e-2,
        WRONG,
        THIRD,
        "plant.enable",
        value=0.0,
    ),
    commission(
        "commission: commands of drive 3 come three samples later",
        ("CommissionRejected",),
        ASTRAY3,
        1e-2,
        LAG,
        0.0,
        DRIVE3,
        late=3,
    ),
    commission(
        "commission: all commands come three samples later",
        ("CommissionRejected",),
        ASTRAY3,
        1e-2,
        LAG,
        0.0,
        *(f"plant.axis{n}_velocity" for n in range(1, 7)),
        late=3,
    ),
    commission(
        "commission: the tool is off",
        ("CommissionRejected",),
        ASTRAY3,
        1e-2,
        LAG,
        0.0,
        TOOL,
        value=0.0,
    ),
    commission(
        "commission: the tool stops while it measures",
        ("CommissionRejected",),
        ASTRAY3,
        1e-2,
        LAG,
        20.0,
        TOOL,
        value=0.0,
    ),
    commission(
        "commission: tool speed is no number",
        ("LostSpindle",),
        ASTRAY3,
        1e-2,
        f"{LAG}; it stops on its way",
        THIRD,
        TOOL,
        value=float("nan"),
    ),
    commission(
        "commission: encoder 3 has 20 counts of noise while it measures",
        ("CommissionRejected",),
        ASTRAY3,
        1e-2,
        LAG,
        0.0,
        AXIS3,
        noise=1e-4,
    ),
)
