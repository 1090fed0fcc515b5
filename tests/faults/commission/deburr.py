"""Faults of the deburring robot in the state `Commission`: rows of the matrix in `deburr.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from ..matrix import Row

AXIS1, AXIS3 = ("controller.axis1.position", "controller.axis3.position")
DRIVE1, DRIVE3 = ("plant.axis1_velocity", "plant.axis3_velocity")
TOOL = "controller.spindle_speed"

STROKE = "the strokes of 33 mm at the tip"
FROZEN = "at most 1 mm and 4 samples of 1 mm unanswered, then closed brakes"
WRONG = "1 mm, half of the lag of 7.7 mm and 4 samples of up to 2 mm, then closed brakes"
BRIDGED = "at most 4 samples of 1 mm are bridged along the commands, then closed brakes"
RUNS_OUT = "no command reaches it: it runs out of 0.1 m/s"
STOPS = "0.1 m/s at 0.5 m/s2, and the lag of 7.7 mm"

COMMISSION = Signal("controller.commission", (0.0, 0.5), (False, True))
MODE = Signal("controller.mode", (0.0,), ("Idle",))
MEASURING = 'controller.state == "Commission"'
FIRST, THIRD = 0.3, 8.9
"""Time from its beginning to the middle of the first stroke of axes 1 and 3, s."""


def way(after: float) -> str:
    """Farthest way of the true tip from where it was so long after the beginning."""
    moment = f"first_time({MEASURING}) + {after}"
    x, y, z = (f"(plant.tip_{axis} - at(plant.tip_{axis}, {moment}))" for axis in "xyz")
    return f"max(hypot(hypot({x}, {y}), {z})[time >= {moment}])"


def commission(
    name: str, faults: tuple[str, ...], limit: float, why: str, after: float, *to: str, **kind: object
) -> Row:
    """Row of the state `Commission`: what goes wrong so long after its beginning."""
    inject = tuple(Injection(one, when=MEASURING, after=after, **kind) for one in to)  # type: ignore[arg-type]
    return Row(name, faults, way(after), limit, why, inject, (COMMISSION, MODE))


ROWS = (
    commission(
        "commission: encoder 1 frozen in its stroke",
        ("FrozenReading",),
        9e-3,
        FROZEN,
        FIRST,
        AXIS1,
        frozen=True,
    ),
    commission(
        "commission: encoder 3 frozen in its stroke",
        ("FrozenReading",),
        8e-3,
        FROZEN,
        THIRD,
        AXIS3,
        frozen=True,
    ),
    commission(
        "commission: encoder 3 off by 20 mm from then on",
        ("ReadingJump",),
        5.5e-3,
        BRIDGED,
        THIRD,
        AXIS3,
        offset=0.02,
    ),
    commission(
        "commission: encoder 3 is no number",
        ("LostReading",),
        5.5e-3,
        BRIDGED,
        THIRD,
        AXIS3,
        value=float("nan"),
    ),
    commission(
        "commission: encoder 3 stands while another axis moves, and its stroke comes",
        ("FrozenReading",),
        3.8e-2,
        f"{STROKE} of the axes before; {FROZEN}",
        FIRST,
        AXIS3,
        frozen=True,
    ),
    commission(
        "commission: drive 1 lost in its stroke",
        ("FrozenReading", "WeakDrive"),
        7.5e-4,
        RUNS_OUT,
        FIRST,
        DRIVE1,
        scale=0.0,
    ),
    commission(
        "commission: drive 3 of the wrong sign in its stroke",
        ("DriveSign",),
        1.9e-2,
        WRONG,
        THIRD,
        DRIVE3,
        scale=-1.0,
    ),
    commission(
        "commission: drive 3 does 0.3 of its command",
        ("WeakDrive",),
        8e-3,
        WRONG,
        THIRD,
        DRIVE3,
        scale=0.3,
    ),
    commission(
        "commission: brakes close in a stroke",
        ("FrozenReading", "WeakDrive", "FollowingError"),
        6e-4,
        RUNS_OUT,
        THIRD,
        "plant.enable",
        value=0.0,
    ),
    commission(
        "commission: commands of drive 3 come three samples later",
        ("CommissionRejected",),
        3.5e-2,
        STROKE,
        0.0,
        DRIVE3,
        late=3,
    ),
    commission(
        "commission: all commands come three samples later",
        ("CommissionRejected",),
        3.5e-2,
        STROKE,
        0.0,
        *(f"plant.axis{n}_velocity" for n in range(1, 7)),
        late=3,
    ),
    commission(
        "commission: the tool is off",
        ("CommissionRejected",),
        3.5e-2,
        STROKE,
        0.0,
        TOOL,
        value=0.0,
    ),
    commission(
        "commission: the tool stops while it measures",
        ("CommissionRejected",),
        3.5e-2,
        STROKE,
        20.0,
        TOOL,
        value=0.0,
    ),
    commission(
        "commission: tool speed is no number",
        ("LostSpindle",),
        2.4e-2,
        STOPS,
        THIRD,
        TOOL,
        value=float("nan"),
    ),
    commission(
        "commission: encoder 3 has 90 counts of noise while it measures",
        ("CommissionRejected",),
        3.5e-2,
        STROKE,
        0.0,
        AXIS3,
        noise=4.5e-4,
        duration=26.0,
    ),
)
