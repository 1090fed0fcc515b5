"""Faults of contact detection in a teaching: rows of the matrix in `dob.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from .matrix import Row

POSITION, CURRENT = "controller.position", "plant.current"
DEEP = "max(maximum(plant.depth, 0.0)[controller.drive_enable])"
"""Travel beyond the first possible touch while the drive is on."""
ASTRAY = (
    "max(abs(plant.position - controller.reference.position)"
    '[controller.drive_enable & (controller.state == "Detect") & (controller.taught.touches == 1)])'
)
"""Where the slide is in the second touch while the drive is on, against where it should be."""

TEACH = Signal("controller.teach", (0.0, 0.01), (False, True))
AT_REST = Signal("controller.enable", (0.0,), (False,))
SECOND = 'controller.state == "Detect" and controller.taught.touches == 1'
FAST = (
    "controller.teach.velocity_min=6e-5", "controller.teach.velocity_max=2e-4", "controller.teach.touches=2",
    "controller.teach.touches_max=2",
    "plant.surface_distance=4e-5", "plant.surface_spread=0", "plant.start_spread=0",
    "controller.teach.place=4e-5",
    "controller.limits.touch_scatter=2e-7", "controller.teach.deviation_max=2e-7",
    "loop.duration=9", 'loop.stop_when=controller.state == "Fault"',
)  # fmt: skip
"""Ten touches in 7 s."""
TOUCH = "the touches at up to 200 um/s, 0.45 um"


def teaching(
    name: str, faults: tuple[str, ...], truth: str, limit: float, why: str, *changes: str, **kind: object
) -> Row:
    """Row of a teaching: what goes wrong in its second touch, or what it is told."""
    to = str(kind.pop("to", ""))
    inject = (Injection(to, when=SECOND, after=0.02, **kind),) if to else ()  # type: ignore[arg-type]
    return Row(name, faults, truth, limit, why, inject, (TEACH, AT_REST), (*FAST, *changes))


ROWS = (
    teaching(
        "teaching: encoder frozen in a touch",
        ("FrozenReading",),
        ASTRAY,
        1e-7,
        "an encoder that lies: 8 nm in each of the 6 samples until it is told, at 81 um/s",
        to=POSITION,
        frozen=True,
    ),
    teaching(
        "teaching: encoder 1 um off in a touch",
        ("ReadingJump",),
        ASTRAY,
        2e-6,
        "1 um, which the reference then has",
        to=POSITION,
        offset=1e-6,
    ),
    teaching(
        "teaching: encoder invalid in a touch",
        ("LostReading",),
        ASTRAY,
        1e-7,
        "8 nm in each of the 6 samples until it is told, at 81 um/s",
        to="controller.position_valid",
        value=0.0,
    ),
    teaching(
        "teaching: current lost in a touch",
        ("WeakDrive", "FollowingError", "Overload"),
        ASTRAY,
        3e-5,
        "drive lost: the weight left over, 0.5 N, takes 10.4 kg to `limits.following_error` = 20 um",
        to=CURRENT,
        value=0.0,
    ),
    teaching(
        "teaching: current of the wrong sign in a touch",
        ("DriveSign",),
        ASTRAY,
        3e-5,
        "5 A, 97 N: 9.3 m/s2 for the time to `limits.following_error` = 20 um and the 4 samples after it",
        to=CURRENT,
        scale=-1.0,
    ),
    teaching(
        "teaching: current 0.05 A off in a touch",
        ("ContactRejected",),
        DEEP,
        6e-7,
        TOUCH,
        to=CURRENT,
        offset=0.05,
    ),
    teaching(
        "teaching: spindle signal lost in a touch",
        ("SpindleJump",),
        DEEP,
        6e-7,
        TOUCH,
        to="controller.spindle_speed",
        value=0.0,
    ),
    teaching(
        "teaching: place told 1 um too far",
        ("TeachingRejected",),
        DEEP,
        6e-7,
        TOUCH,
        "controller.teach.place=4.1e-5",
    ),
    teaching(
        "teaching: place told 1 um too near",
        ("TeachingRejected",),
        DEEP,
        6e-7,
        TOUCH,
        "controller.teach.place=3.9e-5",
    ),
    teaching(
        "teaching: touches scatter more than allowed",
        ("TeachingRejected",),
        DEEP,
        6e-7,
        TOUCH,
        "controller.limits.touch_scatter=2e-9",
    ),
    teaching(
        "teaching: work so soft that the detector does not see it",
        ("LateContact",),
        DEEP,
        4.2e-5,
        "force guard: 0.4 N on two flutes of 5 N/mm, 40 um, and 1 um to stop",
        "plant.stiffness=5e3",
    ),
    teaching(
        "teaching: no work",
        ("TravelLimit",),
        DEEP,
        1e-9,
        "no work, no depth",
        "plant.workpiece=false",
        "controller.approach.travel_max=1.9e-4",
    ),
    teaching(
        "teaching: travel too short for the fastest touch",
        ("TeachingRejected",),
        DEEP,
        1e-9,
        "refused before the stage moves",
        "controller.approach.travel_max=8e-5",
    ),
    teaching(
        "teaching: work 5 um from the start",
        ("LateContact",),
        DEEP,
        3e-6,
        "force guard: 0.4 N on one flute, 2 um, and 1 um to stop",
        "plant.surface_distance=5e-6",
    ),
)
