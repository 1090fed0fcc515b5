"""Faults of the contact detection: encoder, spindle signal, drive and machine before the touch."""

from dataclasses import replace

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from . import dob_calibration as calibration
from .commission import dob as commission
from .matrix import DONE, Matrix, Row

POSITION = "controller.position"
CURRENT = "plant.current"
DETECT = 'controller.state == "Detect"'
LEARN = 'controller.state == "Learn"'
CONFIRM = 'controller.state == "Confirm"'
SHORT = (
    "controller.learn.settle_time=0.23", "controller.learn.time=0.15", "loop.duration=0.75",
    "plant.surface_distance=4.3e-5", "plant.surface_spread=5e-6",
)  # fmt: skip
"""Armed after 0.4 s and 38 um, the surface 5 to 10 um later."""
TWICE = ("controller.touch.confirm=true", "controller.expert.touch.suspicion=2.0", "loop.duration=1.5")
"""The low suspicion level causes a second touch in air."""

FEEBLE = ("controller.stage.current_max=0.3", "plant.current_limit=0.3")

DEEP = "max(maximum(plant.depth, 0.0)[controller.drive_enable])"
"""Travel beyond the first possible touch while the drive is on; a drift without it is not counted."""
EXCURSION = "max(abs(plant.position - controller.reference.position)[controller.drive_enable])"
"""Distance of the slide from its reference while the drive is on."""
CRUISING = EXCURSION.replace("drive_enable", "drive_enable & (time > 0.0995)")
"""The same without the start, for a fault after it."""


def wrong(to: str, when: str = DETECT, after: float = 0.02, **kind: object) -> Injection:
    return Injection(to, when=when, after=after, **kind)  # type: ignore[arg-type]


def at(time: float, to: str = POSITION, **kind: object) -> Injection:
    return Injection(to, from_time=time, **kind)  # type: ignore[arg-type]


OFF = "commanded motion in the 4 samples until the fault is detected, 10 nm each at 100 um/s"
LATE = "`limits.frozen`, 2 samples of delay and 4 samples until the fault is detected, 10 nm each"
SLOW = "`limits.frozen`, a quarter revolution of the spindle, 4 samples of 1 nm, 5 nm of noise"
BRIDGED = "bridged or detected: the servo follows within 10 nm, 5 sigma of its noise"
GUARD = "force guard: 0.4 N on one flute, 2 um, and 1 um to stop"
TOUCH = "depth as in the nominal run, 0.42 um in 99 of 100"
FALL = "drive lost: the residual weight of 0.5 N moves 10.4 kg to `expert.limits.following_error` = 20 um"
WILD = "5 A, 97 N: 9.3 m/s2 until `expert.limits.following_error` = 20 um, and 4 samples more"

LIKE_A_TOUCH = "stops before the surface because of a spurious contact"
SAME_FORCE = "the servo moves the slide with the drift, by the force of a touch"

ROWS = (
    # the encoder
    Row(
        "encoder frozen at rest, before the start",
        ("PositionFrozen",),
        EXCURSION,
        1e-6,
        "residual force of 10 mN by noise: 0.5 um in the 30 ms of `expert.limits.rest_time`",
        (at(0.3, frozen=True),),
        (Signal("controller.enable", (0.0, 0.5), (False, True)),),
    ),
    Row(
        "encoder frozen just before the start",
        ("PositionFrozen",),
        EXCURSION,
        1e-6,
        "as above, in the 20 ms in which the force at rest is measured",
        (at(0.3, frozen=True),),
        (Signal("controller.enable", (0.0, 0.3), (False, True)),),
    ),
    Row(
        "encoder frozen while settling", ("PositionFrozen",), CRUISING, 6.75e-8, LATE, (at(0.1, frozen=True),)
    ),
    Row(
        "encoder frozen in `Learn`",
        ("PositionFrozen",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, LEARN, frozen=True),),
    ),
    Row(
        "encoder frozen in `Detect`",
        ("PositionFrozen",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, frozen=True),),
    ),
    Row(
        "encoder frozen in `Detect`, 10 um/s",
        ("PositionFrozen",),
        CRUISING,
        2.2e-8,
        SLOW,
        (wrong(POSITION, frozen=True),),
        changes=("controller.approach.velocity=1e-5",),
    ),
    Row(
        "encoder frozen in `Detect`, published law",
        ("PositionFrozen",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, frozen=True),),
        changes=("controller.law=Paper",),
    ),
    Row(
        "encoder frozen in the retract",
        ("PositionFrozen",),
        EXCURSION,
        1e-6,
        "1 mm/s for the 4 samples until the fault is detected, and a lag of 0.2 um",
        (wrong(POSITION, 'controller.state == "Retract"', frozen=True),),
    ),
    Row(
        "encoder frozen as the retract decelerates",
        ("PositionFrozen",),
        EXCURSION,
        1e-6,
        "1 mm/s for the 4 samples until the fault is detected, and a lag of 0.2 um",
        (wrong(POSITION, 'controller.state == "Retract"', 0.0903, frozen=True),),
        changes=("loop.stop_when=",),
    ),
    Row(
        "encoder frozen 10 ms after the end of the retract",
        ("PositionFrozen",),
        EXCURSION,
        40e-6,
        "residual motion in the 30 ms of `expert.limits.rest_time`, in which nothing holds the stage",
        (wrong(POSITION, 'controller.state == "Retract"', 0.1007, frozen=True),),
        changes=("loop.stop_when=",),
    ),
    Row(
        "encoder frozen at the start of `Done`",
        ("PositionFrozen",),
        EXCURSION,
        40e-6,
        "residual motion in the 30 ms of `expert.limits.rest_time`, in which nothing holds the stage",
        (wrong(POSITION, 'controller.state == "Done"', 0.0, frozen=True),),
        changes=("loop.stop_when=",),
    ),
    Row(
        "encoder frozen for 2 samples",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, duration=2e-4, frozen=True),),
    ),
    Row(
        "encoder jumps by 1 um",
        ("PositionJump",),
        CRUISING,
        2e-6,
        "1 um, the error of the encoder",
        (wrong(POSITION, offset=1e-6),),
    ),
    Row(
        "encoder spike of 1 um", (DONE,), DEEP, 4.2e-7, TOUCH, (wrong(POSITION, duration=1e-4, offset=1e-6),)
    ),
    Row(
        "encoder spike of 20 nm", (DONE,), DEEP, 4.2e-7, TOUCH, (wrong(POSITION, duration=1e-4, offset=2e-8),)
    ),
    Row(
        "encoder spike of -8 nm",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, duration=1e-4, offset=-8e-9),),
    ),
    Row(
        "encoder jumps by 20 nm",
        ("PositionJump",),
        CRUISING,
        5e-8,
        "20 nm, and " + OFF,
        (wrong(POSITION, offset=2e-8),),
    ),
    Row(
        "encoder jumps by 12 nm",
        (DONE, "PositionJump"),
        DEEP,
        4.4e-7,
        "depth of a touch, and 12 nm",
        (wrong(POSITION, offset=1.2e-8),),
    ),
    Row(
        "encoder spike of 8 nm before a second touch",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, CONFIRM, duration=1e-4, offset=8e-9),),
        changes=TWICE,
    ),
    Row(
        "encoder frozen before a second touch",
        ("PositionFrozen",),
        CRUISING,
        1e-7,
        "10 nm in each of the 6 samples until the fault is detected, and the reversal",
        (wrong(POSITION, CONFIRM, frozen=True),),
        changes=TWICE,
    ),
    Row(
        "drive off before a second touch",
        ("WeakDrive", "FollowingError"),
        CRUISING,
        2e-5,
        FALL,
        (wrong(CURRENT, CONFIRM, scale=0.0),),
        changes=TWICE,
    ),
    Row("encoder drifts by 2 um/s", (DONE,), DEEP, 4.2e-7, TOUCH, (wrong(POSITION, ramp=2e-6),)),
    Row(
        "encoder drifts by -4 um/s",
        (),
        DEEP,
        1e-9,
        LIKE_A_TOUCH,
        (wrong(POSITION, ramp=-4e-6),),
        undetectable=SAME_FORCE,
    ),
    Row(
        "encoder jumps by 5 nm",
        (),
        DEEP,
        1e-9,
        LIKE_A_TOUCH,
        (wrong(POSITION, offset=5e-9),),
        undetectable=SAME_FORCE,
    ),
    Row(
        "first sample of encoder and spindle signal wrong, 1 um and 0",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (
            at(0.0, duration=1e-4, offset=1e-6),
            at(0.0, "controller.spindle_speed", duration=1e-4, value=0.0),
        ),
    ),
    Row(
        "encoder noise of 10 nm, twenty times",
        ("PositionJump", "LearnRejected"),
        DEEP,
        1e-9,
        "detected before the surface",
        (at(0.0, noise=1e-8),),
    ),
    Row(
        "encoder loses a tenth of the samples",
        (DONE, "PositionFrozen"),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, LEARN, drop=0.1),),
    ),
    Row(
        "encoder invalid for a tenth of the samples",
        (DONE, "PositionLost"),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong("controller.position_valid", LEARN, drop=0.1),),
    ),
    Row(
        "encoder invalid permanently",
        ("PositionLost",),
        CRUISING,
        5e-8,
        OFF,
        (wrong("controller.position_valid", value=0.0),),
    ),
    Row(
        "encoder NaN for one sample",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, duration=1e-4, value=float("nan")),),
    ),
    Row(
        "encoder NaN permanently",
        ("PositionLost",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, value=float("nan")),),
    ),
    Row(
        "encoder 3 samples late",
        (DONE,),
        DEEP,
        4.5e-7,
        "depth of a touch, and 3 samples of 10 nm",
        (at(0.0, late=3),),
    ),
    Row(
        "encoder 10 samples late permanently",
        ("PositionDelayed",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, late=10),),
    ),
    Row(
        "encoder 10 samples late in the retract",
        ("PositionDelayed",),
        EXCURSION,
        1e-6,
        "1 mm/s for the 4 samples until the fault is detected, and a lag of 0.2 um",
        (wrong(POSITION, 'controller.state == "Retract"', 0.002, late=10),),
    ),
    Row(
        "encoder in mm",
        ("PositionJump",),
        "max(abs(plant.position - first(plant.position))[controller.drive_enable])",
        5e-6,
        "5 A, 97 N: 9.3 m/s2 for the 1 ms until the fault is detected",
        (at(0.0, scale=1e3),),
    ),
    # the spindle
    Row(
        "spindle signal lost",
        ("SpindleJump",),
        DEEP,
        1e-9,
        "detected before the surface",
        (wrong("controller.spindle_speed", value=0.0),),
    ),
    Row(
        "spindle signal NaN permanently",
        ("SpindleLost",),
        DEEP,
        1e-9,
        "detected before the surface",
        (wrong("controller.spindle_speed", value=float("nan")),),
    ),
    Row(
        "spindle signal NaN for 2 samples",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong("controller.spindle_speed", duration=2e-4, value=float("nan")),),
    ),
    Row(
        "spindle signal with 0.3 % of noise",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (at(0.0, "controller.spindle_speed", noise=9.4),),
    ),
    Row(
        "floor vibration of 0.1 N in `Learn`",
        ("LearnRejected",),
        DEEP,
        1e-9,
        "detected before the surface",
        changes=("plant.floor_force=0.1",),
    ),
    Row(
        "spindle still accelerates in `Learn`",
        ("LearnTimeout",),
        DEEP,
        1e-9,
        "detected before the surface",
        (wrong("controller.spindle_speed", LEARN, after=0.0, ramp=3000.0),),
        changes=("controller.expert.limits.learn_time=0.2",),
    ),
    # the drive
    Row("current of the wrong sign", ("DriveSign",), EXCURSION, 3e-5, WILD, (at(0.0, CURRENT, scale=-1.0),)),
    Row(
        "current of the wrong sign in `Detect`",
        ("DriveSign",),
        CRUISING,
        3e-5,
        WILD,
        (wrong(CURRENT, scale=-1.0),),
    ),
    Row(
        "drive at 0.3 of its strength",
        ("WeakDrive",),
        DEEP,
        1e-9,
        "detected before the surface",
        (at(0.0, CURRENT, scale=0.3),),
    ),
    Row(
        "drive at 0.3 of its strength, 10 um/s",
        ("WeakDrive",),
        DEEP,
        4.2e-7,
        "acceleration too small to detect it: a touch, and a fault after the retract",
        (at(0.0, CURRENT, scale=0.3),),
        changes=(
            "controller.approach.velocity=1e-5",
            "plant.surface_distance=3e-6",
            "plant.surface_spread=1e-6",
        ),
    ),
    Row(
        "drive at 0.3 of its strength in `Detect`",
        (DONE, "WeakDrive"),
        CRUISING,
        2e-5,
        FALL,
        (wrong(CURRENT, scale=0.3),),
    ),
    Row(
        "current lost",
        ("WeakDrive", "FollowingError", "Overload"),
        CRUISING,
        3e-5,
        FALL,
        (wrong(CURRENT, value=0.0),),
    ),
    Row(
        "current stuck",
        ("WeakDrive", "FollowingError", "Overload", "DriveSign"),
        CRUISING,
        3e-5,
        FALL,
        (wrong(CURRENT, frozen=True),),
    ),
    Row(
        "current limited to 0.02 A",
        (DONE, "WeakDrive", "FollowingError", "Overload"),
        EXCURSION,
        3e-5,
        FALL,
        (),
        changes=("plant.current_limit=0.02",),
    ),
    Row(
        "current 3 samples late",
        (DONE,),
        DEEP,
        4.5e-7,
        "depth of a touch, and 3 samples of 10 nm",
        (at(0.0, CURRENT, late=3),),
    ),
    Row(
        "current 8 samples late from settling on",
        ("Oscillation",),
        DEEP,
        6e-7,
        "depth of a touch, 8 samples of 10 nm, and the oscillation",
        (at(0.1, CURRENT, late=8),),
    ),
    Row(
        "current 8 samples late from settling on, maximum 0.3 A",
        ("Oscillation",),
        DEEP,
        6e-7,
        "depth of a touch, 8 samples of 10 nm, and the oscillation",
        (at(0.1, CURRENT, late=8),),
        changes=FEEBLE,
    ),
    Row(
        "current 6 samples late from settling on, maximum 0.3 A",
        (DONE,),
        DEEP,
        5e-7,
        "depth of a touch, 6 samples of 10 nm; `Done` waits until the oscillation has ended",
        (at(0.1, CURRENT, late=6),),
        changes=FEEBLE,
    ),
    Row(
        "current offset of 0.05 A",
        ("ContactRejected",),
        DEEP,
        1e-9,
        "detected before the surface",
        (wrong(CURRENT, offset=0.05),),
    ),
    Row(
        "current offset of 0.25 A, maximum 0.3 A",
        ("Saturation",),
        CRUISING,
        2e-5,
        FALL,
        (wrong(CURRENT, offset=-0.25),),
        changes=FEEBLE,
    ),
    Row(
        "drive of 0.3 A, five times the configured strength",
        ("Oscillation",),
        CRUISING,
        5e-6,
        "five times 0.3 A, 2.8 m/s2 in both directions, for 6 reversals of 1.4 ms",
        (wrong(CURRENT, scale=5.0),),
        changes=("controller.stage.current_max=0.3",),
    ),
    Row(
        "current offset of 0.05 A while settling, 0.5 N allowed",
        ("Overload",),
        DEEP,
        1e-9,
        "detected before the surface",
        (at(0.1, CURRENT, offset=0.05),),
        changes=("controller.expert.limits.disturbance=0.5",),
    ),
    Row(
        "current offset of 0.09 A, 0.6 um of following error allowed",
        ("FollowingError",),
        CRUISING,
        1e-6,
        "allowed following error, and 4 samples at 0.1 mm/s",
        (wrong(CURRENT, offset=-0.09),),
        changes=("controller.expert.limits.following_error=6e-7",),
    ),
    Row(
        "current with 20 mA of noise",
        (),
        DEEP,
        1e-9,
        LIKE_A_TOUCH,
        (wrong(CURRENT, noise=0.02),),
        undetectable="0.4 N of noise exceed the level of a touch and leave no lasting force",
    ),
    # configuration
    Row(
        "cycle longer than its limit",
        ("NoProgress",),
        DEEP,
        1e-9,
        "detected before the surface",
        changes=("controller.limits.cycle_time=0.3",),
    ),
    Row(
        "mass configured 30 % too small", (DONE,), DEEP, 4.2e-7, TOUCH, changes=("controller.stage.mass=7.3",)
    ),
    Row(
        "thrust configured twice too large",
        (DONE, "WeakDrive"),
        DEEP,
        4.2e-7,
        TOUCH,
        changes=("controller.stage.force_constant=39",),
    ),
    Row(
        "delay configured one sample too short",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        changes=("controller.io_delay=0",),
    ),
    Row(
        "communication step of two samples",
        ("LongStep",),
        "max(maximum(plant.depth, 0.0))",
        1e-9,
        "detected in the first sample, 38 um before the surface",
        changes=("loop.step=2e-4", "loop.substeps=4", "loop.duration=0.02"),
    ),
    # machine and operator
    Row(
        "workpiece too soft for the detector",
        ("LateContact",),
        DEEP,
        4.2e-5,
        "force guard: 0.4 N on two flutes of 5 N/mm, 40 um, and 1 um to stop",
        changes=("plant.stiffness=5e3", "loop.duration=1.4"),
    ),
    Row(
        "surface 1 um from the start",
        ("LateContact",),
        DEEP,
        3e-6,
        GUARD,
        changes=("plant.surface_distance=1e-6", "plant.surface_spread=0"),
    ),
    Row(
        "slide blocked",
        ("WeakDrive", "Saturation", "FollowingError"),
        DEEP,
        1e-9,
        "the slide never reaches the surface",
        changes=("plant.damping=1e4", *FEEBLE),
    ),
    Row(
        "restart after the retract",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        changes=("loop.duration=1.1", "loop.stop_when="),
        signals=(Signal("controller.enable", (0.0, 0.01, 0.5, 0.51), (False, True, False, True)),),
    ),
    Row(
        "enable false and true during the approach",
        (DONE,),
        DEEP,
        1e-9,
        "retracts before the surface",
        signals=(Signal("controller.enable", (0.0, 0.01, 0.2, 0.201), (False, True, False, True)),),
    ),
    Row(
        "second fault: travel limit, then the encoder",
        ("TravelLimit", "PositionLost"),
        DEEP,
        1e-9,
        "the travel ends before the surface",
        (Injection("controller.position_valid", when='controller.state == "Fault"', after=0.005, value=0.0),),
        changes=("controller.approach.travel_max=4.1e-5",),
        sequence=True,
    ),
)

MATRIX = Matrix(
    scenario="dob",
    seed=77_013,
    good=(
        '(last(controller.state) == "Done") & (last(controller.contact) == (last(plant.touched) > 0))'
        " & ~any(controller.contact & (plant.touched == 0))"
    ),
    rest="max(abs(plant.velocity[time > last(time) - 0.002])) < 1e-4",
    rows=tuple(
        replace(row, changes=(*SHORT, *row.changes)) for row in (*ROWS, *commission.ROWS, *calibration.ROWS)
    ),
)
