"""Simulated faults of the deburring robot in the state `Commission`: rows of the matrix in `deburr.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from ..matrix import Row

AXIS1, AXIS3 = ("controller.axis1.position", "controller.axis3.position")
DRIVE1, DRIVE3 = ("plant.axis1_velocity", "plant.axis3_velocity")
TOOL = "controller.spindle_speed"

STROKE = "the strokes of 33 mm at the tip"
FROZEN = "at most 1 mm and 4 samples of 1 mm without response, then closed brakes"
WRONG = "1 mm, half of the lag of 7.7 mm and 4 samples of up to 2 mm, then closed brakes"
BRIDGED = "at most 4 samples of 1 mm are bridged along the commands, then closed brakes"
RUNS_OUT = "no command reaches it: it stops from 0.1 m/s"
STOPS = "0.1 m/s at 0.5 m/s2, and the lag of 7.7 mm"

COMMISSION = Signal("controller.commission", (0.0, 0.5), (False, True))
MODE = Signal("controller.mode", (0.0,), ("Idle",))
MEASURING = 'controller.state == "Commission"'
FIRST, THIRD = 0.3, 8.9
"""Time from the start to the middle of the first stroke of axes 1 and 3, s."""


def excursion(after: float) -> str:
    """Largest distance of the tip from its position this time after the start."""
    moment = f"first_time({MEASURING}) + {after}"
    x, y, z = (f"(plant.tip_{axis} - at(plant.tip_{axis}, {moment}))" for axis in "xyz")
    return f"max(hypot(hypot({x}, {y}), {z})[time >= {moment}])"


def commission(
    name: str, faults: tuple[str, ...], limit: float, why: str, after: float, *to: str, **kind: object
) -> Row:
    """Row of the state `Commission` with a fault this time after its start."""
    inject = tuple(Injection(one, when=MEASURING, after=after, **kind) for one in to)  # type: ignore[arg-type]
    return Row(name, faults, excursion(after), limit, why, inject, (COMMISSION, MODE))


ROWS = (
    commission(
        "commission: encoder 1 frozen in its stroke",
        ("PositionFrozen",),
        9e-3,
        FROZEN,
        FIRST,
        AXIS1,
        frozen=True,
    ),
    commission(
        "commission: encoder 3 frozen in its stroke",
        ("PositionFrozen",),
        8e-3,
        FROZEN,
        THIRD,
        AXIS3,
        frozen=True,
    ),
    commission(
        "commission: encoder 3 off by 20 mm permanently",
        ("PositionJump",),
        5.5e-3,
        BRIDGED,
        THIRD,
        AXIS3,
        offset=0.02,
    ),
    commission(
        "commission: encoder 3 is NaN",
        ("PositionLost",),
        5.5e-3,
        BRIDGED,
        THIRD,
        AXIS3,
        value=float("nan"),
    ),
    commission(
        "commission: encoder 3 frozen during the strokes of other axes and its own",
        ("PositionFrozen",),
        3.8e-2,
        f"{STROKE} of the axes before; {FROZEN}",
        FIRST,
        AXIS3,
        frozen=True,
    ),
    commission(
        "commission: drive 1 lost in its stroke",
        ("PositionFrozen", "WeakDrive"),
        7.5e-4,
        RUNS_OUT,
        FIRST,
        DRIVE1,
        scale=0.0,
    ),
    commission(
        "commission: drive 3 reversed in its stroke",
        ("DriveSign",),
        1.9e-2,
        WRONG,
        THIRD,
        DRIVE3,
        scale=-1.0,
    ),
    commission(
        "commission: drive 3 gain of 0.3",
        ("WeakDrive",),
        8e-3,
        WRONG,
        THIRD,
        DRIVE3,
        scale=0.3,
    ),
    commission(
        "commission: brakes close in a stroke",
        ("PositionFrozen", "WeakDrive", "FollowingError"),
        6e-4,
        RUNS_OUT,
        THIRD,
        "plant.enable",
        value=0.0,
    ),
    commission(
        "commission: commands of drive 3 three samples late",
        ("CommissionRejected",),
        3.5e-2,
        STROKE,
        0.0,
        DRIVE3,
        late=3,
    ),
    commission(
        "commission: all commands three samples late",
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
        "commission: the tool stops during the run",
        ("CommissionRejected",),
        3.5e-2,
        STROKE,
        20.0,
        TOOL,
        value=0.0,
    ),
    commission(
        "commission: tool speed is NaN",
        ("SpindleLost",),
        2.4e-2,
        STOPS,
        THIRD,
        TOOL,
        value=float("nan"),
    ),
    commission(
        "commission: encoder 3 has 90 counts of noise during the run",
        ("CommissionRejected",),
        3.5e-2,
        STROKE,
        0.0,
        AXIS3,
        noise=4.5e-4,
        duration=26.0,
    ),
)
