"""Faults of contact detection in the state `Commission`: rows of the matrix in `dob.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from ..matrix import Row

POSITION, CURRENT = "controller.position", "plant.current"

ASTRAY = "max(abs(plant.position - controller.reference.position)[controller.drive_enable & (time > 0.01)])"
"""Where the slide is while the drive is on, against where it should be."""
LOST = ("WeakDrive", "FollowingError", "Overload")

FALL = "drive lost: the weight left over, 0.5 N, takes 10.4 kg to `limits.following_error` = 20 um"
WILD = "5 A, 97 N: 9.3 m/s2 for the time to `limits.following_error` = 20 um and the 4 samples after it"
LIES = "half a micrometre of the excitation, and 1 um of its motion until an encoder that lies is told"

COMMISSION = Signal("controller.commission", (0.0, 0.01), (False, True))
AT_REST = Signal("controller.enable", (0.0,), (False,))
MEASURING = 'controller.state == "Commission"'
EXCITED = (
    "20 um of following error, 15 um that a slide of half the mass may move besides, and the samples after it"
)


def commission(
    name: str, faults: tuple[str, ...], limit: float, why: str, after: float, to: str, **kind: object
) -> Row:
    """Row of the state `Commission`: what goes wrong so long after its beginning."""
    inject = (Injection(to, when=MEASURING, after=after, **kind),)  # type: ignore[arg-type]
    lasts = ("loop.duration=11", 'loop.stop_when=controller.state == "Fault"')
    return Row(name, faults, ASTRAY, limit, why, inject, (COMMISSION, AT_REST), lasts)


ROWS = (
    commission(
        "commission: encoder frozen on the way back",
        ("FrozenReading",),
        2e-6,
        LIES,
        0.01,
        POSITION,
        frozen=True,
    ),
    commission(
        "commission: encoder frozen while it excites",
        ("FrozenReading",),
        2e-6,
        LIES,
        3.0,
        POSITION,
        frozen=True,
    ),
    commission(
        "commission: encoder frozen in a stroke", ("FrozenReading",), 2e-6, LIES, 8.5, POSITION, frozen=True
    ),
    commission(
        "commission: encoder 1 um off while it excites",
        ("ReadingJump",),
        2e-6,
        LIES,
        3.0,
        POSITION,
        offset=1e-6,
    ),
    commission(
        "commission: encoder invalid while it excites",
        ("LostReading",),
        2e-6,
        LIES,
        3.0,
        "controller.position_valid",
        value=0.0,
    ),
    commission("commission: current lost while it excites", LOST, 5e-5, EXCITED, 3.0, CURRENT, value=0.0),
    commission("commission: current lost in a stroke", LOST, 3e-5, FALL, 8.5, CURRENT, value=0.0),
    commission(
        "commission: current of the wrong sign while it excites",
        ("DriveSign",),
        5e-5,
        EXCITED,
        3.0,
        CURRENT,
        scale=-1.0,
    ),
    commission(
        "commission: current of the wrong sign in a stroke",
        ("DriveSign",),
        3e-5,
        WILD,
        8.5,
        CURRENT,
        scale=-1.0,
    ),
    commission(
        "commission: drive at 0.3 while it excites",
        ("CommissionRejected", *LOST),
        5e-5,
        EXCITED,
        0.6,
        CURRENT,
        scale=0.3,
    ),
    commission(
        "commission: spindle signal lost while it excites",
        ("SpindleJump",),
        2e-6,
        LIES,
        2.9,
        "controller.spindle_speed",
        value=0.0,
    ),
    Row(
        "commission: encoder drifts by 20 um/s",
        (),
        ASTRAY,
        2.1e-4,
        "the drift for the 10 s of a commission, and half a micrometre of the excitation",
        (Injection(POSITION, when=MEASURING, after=3.0, ramp=2e-5),),
        (COMMISSION, AT_REST),
        ("loop.duration=11", 'loop.stop_when=controller.state == "Fault"'),
        untold="a steady motion needs no force: the servo moves the slide along with it",
    ),
    Row(
        "commission: the slide is held",
        ("WeakDrive", "FollowingError", "Overload", "FrozenReading", "CommissionRejected"),
        ASTRAY,
        1e-4,
        "it does not go where it should: no farther than the travel of 90 um",
        signals=(COMMISSION, AT_REST),
        changes=("loop.duration=11", 'loop.stop_when=controller.state == "Fault"', "plant.damping=1e4"),
    ),
    Row(
        "commission: the floor shakes with 0.1 N, and what is measured is to be used",
        ("CommissionRejected",),
        ASTRAY,
        2e-6,
        "no limit grows with it: 0.1 N at 18 Hz swing 10 kg by 0.8 um, and it is excited besides",
        signals=(COMMISSION, AT_REST),
        changes=(
            "loop.duration=11",
            'loop.stop_when=controller.state == "Fault"',
            "controller.commission.apply=true",
            "plant.floor_force=0.1",
        ),
    ),
)
