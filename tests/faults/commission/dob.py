"""Simulated faults of contact detection in the state `Commission`: rows of the matrix in `dob.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from ..matrix import Row

POSITION, CURRENT = "controller.position", "plant.current"

OFF_PATH = "max(abs(plant.position - controller.reference.position)[controller.drive_enable & (time > 0.01)])"
"""Largest distance of the slide from its reference while the drive is on."""
LOST = ("WeakDrive", "FollowingError", "Overload")

FALL = "drive lost: the residual weight of 0.5 N moves 10.4 kg to `expert.limits.following_error` = 20 um"
REVERSED = "5 A, 97 N: 9.3 m/s2 until `expert.limits.following_error` = 20 um, and 4 samples more"
UNSEEN = "half a micrometer of the excitation, and 1 um of its motion until the faulty encoder is detected"

COMMISSION = Signal("controller.commission", (0.0, 0.01), (False, True))
AT_REST = Signal("controller.enable", (0.0,), (False,))
MEASURING = 'controller.state == "Commission"'
EXCITED = "20 um of following error, 15 um more for a slide of half the mass, and the samples after it"


def commission(
    name: str, faults: tuple[str, ...], limit: float, why: str, after: float, to: str, **kind: object
) -> Row:
    """Row of the state `Commission` with a fault this time after its start."""
    inject = (Injection(to, when=MEASURING, after=after, **kind),)  # type: ignore[arg-type]
    lasts = ("loop.duration=11", 'loop.stop_when=controller.state == "Fault"')
    return Row(name, faults, OFF_PATH, limit, why, inject, (COMMISSION, AT_REST), lasts)


ROWS = (
    commission(
        "commissioning: encoder frozen during the return",
        ("PositionFrozen",),
        2e-6,
        UNSEEN,
        0.01,
        POSITION,
        frozen=True,
    ),
    commission(
        "commissioning: encoder frozen during the excitation",
        ("PositionFrozen",),
        2e-6,
        UNSEEN,
        3.0,
        POSITION,
        frozen=True,
    ),
    commission(
        "commissioning: encoder frozen in a stroke",
        ("PositionFrozen",),
        2e-6,
        UNSEEN,
        8.5,
        POSITION,
        frozen=True,
    ),
    commission(
        "commissioning: encoder 1 um off during the excitation",
        ("PositionJump",),
        2e-6,
        UNSEEN,
        3.0,
        POSITION,
        offset=1e-6,
    ),
    commission(
        "commissioning: encoder invalid during the excitation",
        ("PositionLost",),
        2e-6,
        UNSEEN,
        3.0,
        "controller.position_valid",
        value=0.0,
    ),
    commission(
        "commissioning: current lost during the excitation", LOST, 5e-5, EXCITED, 3.0, CURRENT, value=0.0
    ),
    commission("commissioning: current lost in a stroke", LOST, 3e-5, FALL, 8.5, CURRENT, value=0.0),
    commission(
        "commissioning: current reversed during the excitation",
        ("DriveSign",),
        5e-5,
        EXCITED,
        3.0,
        CURRENT,
        scale=-1.0,
    ),
    commission(
        "commissioning: current reversed in a stroke",
        ("DriveSign",),
        3e-5,
        REVERSED,
        8.5,
        CURRENT,
        scale=-1.0,
    ),
    commission(
        "commissioning: drive at 0.3 during the excitation",
        ("CommissionRejected", *LOST),
        5e-5,
        EXCITED,
        0.6,
        CURRENT,
        scale=0.3,
    ),
    commission(
        "commissioning: spindle signal lost during the excitation",
        ("SpindleJump",),
        2e-6,
        UNSEEN,
        2.9,
        "controller.spindle_speed",
        value=0.0,
    ),
    Row(
        "commissioning: encoder drifts by 20 um/s",
        (),
        OFF_PATH,
        2.1e-4,
        "the drift for the 10 s of the run, and half a micrometer of the excitation",
        (Injection(POSITION, when=MEASURING, after=3.0, ramp=2e-5),),
        (COMMISSION, AT_REST),
        ("loop.duration=11", 'loop.stop_when=controller.state == "Fault"'),
        undetectable="a steady motion needs no force: the servo moves the slide with the drift",
    ),
    Row(
        "commissioning: the slide is blocked",
        ("WeakDrive", "FollowingError", "Overload", "PositionFrozen", "CommissionRejected"),
        OFF_PATH,
        1e-4,
        "the slide does not follow: at most the travel of 90 um",
        signals=(COMMISSION, AT_REST),
        changes=("loop.duration=11", 'loop.stop_when=controller.state == "Fault"', "plant.damping=1e4"),
    ),
    Row(
        "commissioning: floor vibration of 0.1 N, with `commission.apply`",
        ("CommissionRejected",),
        OFF_PATH,
        2e-6,
        "limits do not grow with it: 0.1 N at 18 Hz move 10 kg by 0.8 um, plus the excitation",
        signals=(COMMISSION, AT_REST),
        changes=(
            "loop.duration=11",
            'loop.stop_when=controller.state == "Fault"',
            "controller.commission.apply=true",
            "plant.floor_force=0.1",
        ),
    ),
)
