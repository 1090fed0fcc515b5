"""Simulated faults of the deburring robot in the state `Register`: rows of the matrix in `deburr.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from .matrix import DONE, Row

CONTACT = "controller.contact"
DEFLECTION = "max(plant.probe_deflection)"
"""Largest deflection of the probe."""
INSIDE = 'max(-plant.deviation[controller.state == "Register"])'
"""Largest distance of the tip beyond the wall, or beyond its programmed position."""
TIP = 'max(abs(plant.deviation[controller.state == "Run"]))'
"""Distance of the tip from the edge on the path."""

SEEKS = "0.5 mm: lag, 4 samples and stop from 5 mm/s"
FOUND = "error with patterns and of the cut, and 10 um of the registration"
TOUCHED = "controller.path.file=touched.json"
ASIDE = ("plant.part_x=1.2e-3", "plant.part_y=-0.8e-3", "plant.part_angle=2e-3")
REGISTERING = 'controller.state == "Register"'

LATER = (0.0, 66.0)
"""Time of the task after a registration, s."""


def registration(
    name: str,
    faults: tuple[str, ...],
    truth: str,
    limit: float,
    why: str,
    inject: tuple[Injection, ...] = (),
    changes: tuple[str, ...] = (),
    *,
    end: float,
    signals: tuple[Signal, ...] = (),
) -> Row:
    """Row of the state `Register`, which starts at 0.5 s; until `end` (s) nothing may move automatically."""
    asked = Signal("controller.register", (0.0, 0.5), (False, True))
    idle = Signal("controller.mode", (0.0,), ("Idle",))
    stimuli = {signal.to: signal for signal in (asked, idle, *signals)}
    lasts = (f"loop.duration={end}", "loop.stop_when=''")
    file = () if any("path.file" in change for change in changes) else (TOUCHED,)
    changed = (*file, *changes, *lasts)
    return Row(f"registration: {name}", faults, truth, limit, why, inject, tuple(stimuli.values()), changed)


JOB = (Signal("controller.mode", LATER, ("Idle", "Deburr")),)

FALSE = tuple(
    Injection(CONTACT, when=REGISTERING, after=0.5 + 1.3 * k, duration=0.03, value=1.0) for k in range(4)
)
BESIDE = Injection(
    "controller.axis3.position",
    when="controller.registration.touches == 2",
    after=4.0,
    duration=6.0,
    offset=2e-4,
)

ROWS = (
    registration(
        "a displaced part is touched, then deburred",
        (DONE,),
        TIP,
        7.5e-5,
        FOUND,
        (),
        ASIDE,
        end=76.0,
        signals=JOB,
    ),
    registration(
        "three consecutive false contacts, repeatedly",
        (DONE,),
        TIP,
        7.5e-5,
        FOUND,
        FALSE,
        ASIDE,
        end=76.0,
        signals=JOB,
    ),
    registration(
        "contact late by 3 samples",
        (DONE,),
        TIP,
        1.2e-4,
        "the same, and 30 um of travel at 1 mm/s along both normals",
        (Injection(CONTACT, from_time=0.0, late=3),),
        ASIDE,
        end=76.0,
        signals=JOB,
    ),
    registration(
        "aborted before the part, then deburred as programmed",
        (DONE,),
        TIP,
        6.6e-5,
        "error with patterns and of the cut",
        end=20.0,
        signals=(
            Signal("controller.register", (0.0, 0.5, 4.5), (False, True, False)),
            Signal("controller.mode", (0.0, 8.0), ("Idle", "Deburr")),
        ),
    ),
    registration(
        "no part",
        ("NoPart",),
        INSIDE,
        7e-3,
        "5 mm to the end of the touch, and the stop",
        end=14.0,
        signals=(Signal("plant.workpiece", (0.0,), (0.0,)),),
    ),
    registration(
        "the contact of the probe is dead",
        ("NoPart",),
        DEFLECTION,
        7e-3,
        "5 mm to the end of the touch, and the stop; the probe allows 10 mm",
        (Injection(CONTACT, from_time=0.0, value=0.0),),
        end=14.0,
    ),
    registration(
        "the probe signals a contact immediately",
        ("UnexpectedContact",),
        DEFLECTION,
        1e-5,
        "nothing is touched",
        (Injection(CONTACT, from_time=0.0, value=1.0),),
        end=14.0,
    ),
    registration(
        "contact sticks from the first touch on",
        ("ContactFrozen",),
        DEFLECTION,
        6.5e-4,
        SEEKS,
        (Injection(CONTACT, when=CONTACT, frozen=True),),
        end=20.0,
    ),
    registration(
        "contact lost in the second touch of a face",
        ("NoPart",),
        DEFLECTION,
        1.5e-3,
        "1 mm beyond the first contact, and the stop",
        (Injection(CONTACT, when="plant.probe_deflection > 3e-4", after=0.2, value=0.0),),
        end=20.0,
    ),
    registration(
        "encoder 3 off by 0.2 mm, less than a jump, in the third touch",
        ("TouchMismatch",),
        DEFLECTION,
        6.5e-4,
        SEEKS,
        (BESIDE,),
        end=60.0,
    ),
    registration(
        "encoder 1 counts 2 % too little",
        ("TouchMismatch",),
        DEFLECTION,
        6e-4,
        SEEKS,
        (Injection("controller.axis1.position", from_time=0.0, scale=0.98),),
        end=60.0,
    ),
    registration(
        "encoder 3 frozen before the part",
        ("PositionFrozen",),
        DEFLECTION,
        1e-3,
        "1 mm without response along axis 3, then closed brakes",
        (Injection("controller.axis3.position", when=REGISTERING, after=3.3, frozen=True),),
        end=14.0,
    ),
    registration(
        "drive 1 does 0.3 of its command before the part",
        ("WeakDrive",),
        DEFLECTION,
        6.5e-4,
        "0.5 mm at 5 mm/s; detected in the next motion across",
        (Injection("plant.axis1_velocity", when=REGISTERING, after=3.3, scale=0.3),),
        end=14.0,
    ),
    registration(
        "the part is displaced by 4.4 mm",
        ("Misplaced",),
        DEFLECTION,
        6.5e-4,
        SEEKS,
        changes=("plant.part_x=3.1e-3", "plant.part_y=-3.1e-3"),
        end=60.0,
    ),
    registration(
        "the part is rotated by 15 mrad",
        ("Misplaced",),
        DEFLECTION,
        6.5e-4,
        SEEKS,
        changes=("plant.part_angle=0.015",),
        end=60.0,
    ),
    registration(
        "a path without touches",
        ("NoTouches",),
        "first(plant.tip_z) - min(plant.tip_z)",
        1e-5,
        "detected before any motion",
        changes=("controller.path.file=path.json",),
        end=3.0,
    ),
    registration(
        "insufficient time",
        ("NoProgress",),
        DEFLECTION,
        6.5e-4,
        SEEKS,
        changes=("controller.expert.register.time=6.0",),
        end=14.0,
    ),
)
