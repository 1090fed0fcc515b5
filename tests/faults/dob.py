"""Faults of the contact detection: encoder, spindle signal, drive and machine on the way to the touch."""

from dataclasses import replace

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from . import dob_teaching as teaching
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
TWICE = ("controller.touch.confirm=true", "controller.touch.suspicion=2.0", "loop.duration=1.5")
"""So much is suspected that a second touch begins in the air."""

FEEBLE = ("controller.stage.current_max=0.3", "plant.current_limit=0.3")

DEEP = "max(maximum(plant.depth, 0.0)[controller.drive_enable])"
"""Travel beyond the first possible touch while the drive is on; a drift without it is not counted."""
ASTRAY = "max(abs(plant.position - controller.reference.position)[controller.drive_enable])"
"""Where the slide is while the drive is on, against where it should be."""
CRUISING = ASTRAY.replace("drive_enable", "drive_enable & (time > 0.0995)")
"""The same without the start, for a fault that comes after it."""


def wrong(to: str, when: str = DETECT, after: float = 0.02, **kind: object) -> Injection:
    return Injection(to, when=when, after=after, **kind)  # type: ignore[arg-type]


def at(time: float, to: str = POSITION, **kind: object) -> Injection:
    return Injection(to, from_time=time, **kind)  # type: ignore[arg-type]


OFF = "an encoder that lies: what is commanded in the 4 samples until it is told, 10 nm each at 100 um/s"
LATE = "an encoder that lies: `limits.frozen`, the 2 samples that the slide may be late, and 4, 10 nm each"
SLOW = (
    "an encoder that lies: `limits.frozen`, a quarter turn of the spindle, 4 samples of 1 nm, 5 nm of noise"
)
TOLD = "the reading is bridged or told: the servo follows within 10 nm, 5 sigma of its noise"
GUARD = "force guard: 0.4 N on one flute, 2 um, and 1 um to stop"
TOUCH = "a touch as in the nominal run, 0.42 um in 99 of 100"
FALL = "drive lost: the weight left over, 0.5 N, takes 10.4 kg to `limits.following_error` = 20 um"
WILD = "5 A, 97 N: 9.3 m/s2 for the time to `limits.following_error` = 20 um and the 4 samples after it"

LIKE_A_TOUCH = "it stops before the surface, for a contact that is none"
SAME_FORCE = "the servo moves the slide along with it, with the force of a touch"

ROWS = (
    # the encoder
    Row(
        "encoder frozen at rest, before the start",
        ("FrozenReading",),
        ASTRAY,
        1e-6,
        "the force of 10 mN that noise leaves moves it 0.5 um in the 30 ms of `limits.rest_time`",
        (at(0.3, frozen=True),),
        (Signal("controller.enable", (0.0, 0.5), (False, True)),),
    ),
    Row(
        "encoder frozen just before the start",
        ("FrozenReading",),
        ASTRAY,
        1e-6,
        "as before, for the 20 ms of the force at rest",
        (at(0.3, frozen=True),),
        (Signal("controller.enable", (0.0, 0.3), (False, True)),),
    ),
    Row(
        "encoder frozen while settling", ("FrozenReading",), CRUISING, 6.75e-8, LATE, (at(0.1, frozen=True),)
    ),
    Row(
        "encoder frozen while learning",
        ("FrozenReading",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, LEARN, frozen=True),),
    ),
    Row(
        "encoder frozen while watching",
        ("FrozenReading",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, frozen=True),),
    ),
    Row(
        "encoder frozen while watching, 10 um/s",
        ("FrozenReading",),
        CRUISING,
        2.2e-8,
        SLOW,
        (wrong(POSITION, frozen=True),),
        changes=("controller.approach.velocity=1e-5",),
    ),
    Row(
        "encoder frozen while watching, paper's law",
        ("FrozenReading",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, frozen=True),),
        changes=("controller.law=Paper",),
    ),
    Row(
        "encoder frozen on the way back",
        ("FrozenReading",),
        ASTRAY,
        1e-6,
        "1 mm/s for the 4 samples until it is told, and the 0.2 um that it is late",
        (wrong(POSITION, 'controller.state == "Retract"', frozen=True),),
    ),
    Row(
        "encoder frozen as the retract brakes",
        ("FrozenReading",),
        ASTRAY,
        1e-6,
        "1 mm/s for the 4 samples until it is told, and the 0.2 um that it is late",
        (wrong(POSITION, 'controller.state == "Retract"', 0.0903, frozen=True),),
        changes=("loop.stop_when=",),
    ),
    Row(
        "encoder frozen 10 ms after the retract stands",
        ("FrozenReading",),
        ASTRAY,
        40e-6,
        "what is left of the motion for the 30 ms of `limits.rest_time` in which nothing holds the stage",
        (wrong(POSITION, 'controller.state == "Retract"', 0.1007, frozen=True),),
        changes=("loop.stop_when=",),
    ),
    Row(
        "encoder frozen as it is `Done`",
        ("FrozenReading",),
        ASTRAY,
        40e-6,
        "what is left of the motion for the 30 ms of `limits.rest_time` in which nothing holds the stage",
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
        "encoder 1 um off from now on",
        ("ReadingJump",),
        CRUISING,
        2e-6,
        "1 um, which the reference then has",
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
        "encoder 20 nm off from now on",
        ("ReadingJump",),
        CRUISING,
        5e-8,
        "20 nm, and " + OFF.split(": ")[1],
        (wrong(POSITION, offset=2e-8),),
    ),
    Row(
        "encoder 12 nm off from now on",
        (DONE, "ReadingJump"),
        DEEP,
        4.4e-7,
        "a touch, and the 12 nm",
        (wrong(POSITION, offset=1.2e-8),),
    ),
    Row(
        "encoder spike of 8 nm, CUSUM",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, duration=1e-4, offset=8e-9),),
        changes=("controller.detector=Cusum",),
    ),
    Row(
        "encoder spike of 8 nm, slopes",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, duration=1e-4, offset=8e-9),),
        changes=("controller.detector=MultiSlope",),
    ),
    Row(
        "encoder spike of 8 nm on the way to a second touch",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, CONFIRM, duration=1e-4, offset=8e-9),),
        changes=TWICE,
    ),
    Row(
        "encoder frozen on the way to a second touch",
        ("FrozenReading",),
        CRUISING,
        1e-7,
        "an encoder that lies: 10 nm in each of the 6 samples until it is told, and the turn",
        (wrong(POSITION, CONFIRM, frozen=True),),
        changes=TWICE,
    ),
    Row(
        "drive off on the way to a second touch",
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
        untold=SAME_FORCE,
    ),
    Row(
        "encoder 5 nm off from now on",
        (),
        DEEP,
        1e-9,
        LIKE_A_TOUCH,
        (wrong(POSITION, offset=5e-9),),
        untold=SAME_FORCE,
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
        ("ReadingJump", "LearnRejected"),
        DEEP,
        1e-9,
        "found before the surface",
        (at(0.0, noise=1e-8),),
    ),
    Row(
        "encoder loses a tenth of the samples",
        (DONE, "FrozenReading"),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong(POSITION, LEARN, drop=0.1),),
    ),
    Row(
        "encoder invalid for a tenth of the samples",
        (DONE, "LostReading"),
        DEEP,
        4.2e-7,
        TOUCH,
        (wrong("controller.position_valid", LEARN, drop=0.1),),
    ),
    Row(
        "encoder invalid from now on",
        ("LostReading",),
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
        "encoder NaN from now on",
        ("LostReading",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, value=float("nan")),),
    ),
    Row(
        "encoder 3 samples late", (DONE,), DEEP, 4.5e-7, "a touch, and 3 samples of 10 nm", (at(0.0, late=3),)
    ),
    Row(
        "encoder 10 samples late from now on",
        ("LateReading",),
        CRUISING,
        5e-8,
        OFF,
        (wrong(POSITION, late=10),),
    ),
    Row(
        "encoder 10 samples late on the way back",
        ("LateReading",),
        ASTRAY,
        1e-6,
        "1 mm/s for the 4 samples until it is told, and the 0.2 um that it is late",
        (wrong(POSITION, 'controller.state == "Retract"', 0.002, late=10),),
    ),
    Row(
        "encoder in mm",
        ("ReadingJump",),
        "max(abs(plant.position - first(plant.position))[controller.drive_enable])",
        5e-6,
        "5 A, 97 N: 9.3 m/s2 for the 1 ms until it is told",
        (at(0.0, scale=1e3),),
    ),
    # the spindle
    Row(
        "spindle signal lost",
        ("SpindleJump",),
        DEEP,
        1e-9,
        "found before the surface",
        (wrong("controller.spindle_speed", value=0.0),),
    ),
    Row(
        "spindle signal NaN from now on",
        ("LostSpindle",),
        DEEP,
        1e-9,
        "found before the surface",
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
        "spindle signal with 0.3 % of noise, CUSUM",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        (at(0.0, "controller.spindle_speed", noise=9.4),),
        changes=("controller.detector=Cusum",),
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
        "the floor shakes with 0.1 N while it learns",
        ("LearnRejected",),
        DEEP,
        1e-9,
        "found before the surface",
        changes=("plant.floor_force=0.1",),
    ),
    Row(
        "spindle still runs up while it learns",
        ("LearnTimeout",),
        DEEP,
        1e-9,
        "found before the surface",
        (wrong("controller.spindle_speed", LEARN, after=0.0, ramp=3000.0),),
        changes=("controller.limits.learn_time=0.2",),
    ),
    # the drive
    Row("current of the wrong sign", ("DriveSign",), ASTRAY, 3e-5, WILD, (at(0.0, CURRENT, scale=-1.0),)),
    Row(
        "current of the wrong sign while watching",
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
        "found before the surface",
        (at(0.0, CURRENT, scale=0.3),),
    ),
    Row(
        "drive at 0.3 of its strength, 10 um/s",
        ("WeakDrive",),
        DEEP,
        4.2e-7,
        "too slow a start to tell: a touch, and told behind the retract",
        (at(0.0, CURRENT, scale=0.3),),
        changes=(
            "controller.approach.velocity=1e-5",
            "plant.surface_distance=3e-6",
            "plant.surface_spread=1e-6",
        ),
    ),
    Row("drive at 0.3 from now on", (DONE, "WeakDrive"), CRUISING, 2e-5, FALL, (wrong(CURRENT, scale=0.3),)),
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
        ASTRAY,
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
        "a touch, and 3 samples of 10 nm",
        (at(0.0, CURRENT, late=3),),
    ),
    Row(
        "current 8 samples late from the settling on",
        ("Oscillation",),
        DEEP,
        6e-7,
        "a touch, and 8 samples of 10 nm and of the swing",
        (at(0.1, CURRENT, late=8),),
    ),
    Row(
        "current 8 samples late from the settling on, of 0.3 A",
        ("Oscillation",),
        DEEP,
        6e-7,
        "a touch, and 8 samples of 10 nm and of the swing",
        (at(0.1, CURRENT, late=8),),
        changes=FEEBLE,
    ),
    Row(
        "current 6 samples late from the settling on, of 0.3 A",
        (DONE,),
        DEEP,
        5e-7,
        "a touch, and 6 samples of 10 nm; the stage swings, and `Done` waits until it stands",
        (at(0.1, CURRENT, late=6),),
        changes=FEEBLE,
    ),
    Row(
        "current 0.05 A off from now on",
        ("ContactRejected",),
        DEEP,
        1e-9,
        "found before the surface",
        (wrong(CURRENT, offset=0.05),),
    ),
    Row(
        "current 0.25 A off from now on, of 0.3 A",
        ("Saturation",),
        CRUISING,
        2e-5,
        FALL,
        (wrong(CURRENT, offset=-0.25),),
        changes=FEEBLE,
    ),
    Row(
        "drive of 0.3 A five times as strong as told from now on",
        ("Oscillation",),
        CRUISING,
        5e-6,
        "five times 0.3 A, 2.8 m/s2 to and fro, for 6 turns of 1.4 ms",
        (wrong(CURRENT, scale=5.0),),
        changes=("controller.stage.current_max=0.3",),
    ),
    Row(
        "current 0.05 A off while settling, 0.5 N allowed",
        ("Overload",),
        DEEP,
        1e-9,
        "found before the surface",
        (at(0.1, CURRENT, offset=0.05),),
        changes=("controller.limits.disturbance=0.5",),
    ),
    Row(
        "current 0.09 A off from now on, 0.6 um of distance allowed",
        ("FollowingError",),
        CRUISING,
        1e-6,
        "the distance allowed, and 4 samples at 0.1 mm/s",
        (wrong(CURRENT, offset=-0.09),),
        changes=("controller.limits.following_error=6e-7",),
    ),
    Row(
        "current with 20 mA of noise from now on",
        (),
        DEEP,
        1e-9,
        LIKE_A_TOUCH,
        (wrong(CURRENT, noise=0.02),),
        untold="0.4 N of noise pass the level of a touch, and are no lasting force",
    ),
    # what the controller is told
    Row(
        "a job of more time than it may take",
        ("NoProgress",),
        DEEP,
        1e-9,
        "found before the surface",
        changes=("controller.limits.job_time=0.3",),
    ),
    Row("mass told 30 % too small", (DONE,), DEEP, 4.2e-7, TOUCH, changes=("controller.stage.mass=7.3",)),
    Row(
        "thrust told twice too large",
        (DONE, "WeakDrive"),
        DEEP,
        4.2e-7,
        TOUCH,
        changes=("controller.stage.force_constant=39",),
    ),
    Row("delay told one sample too short", (DONE,), DEEP, 4.2e-7, TOUCH, changes=("controller.io_delay=0",)),
    Row(
        "communication step of two samples",
        ("LongStep",),
        "max(maximum(plant.depth, 0.0))",
        1e-9,
        "told in the first sample, 38 um before the surface",
        changes=("loop.step=2e-4", "loop.substeps=4", "loop.duration=0.02"),
    ),
    # the machine and its operator
    Row(
        "work so soft that the detector does not see it",
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
        "the slide is held",
        ("WeakDrive", "Saturation", "FollowingError"),
        DEEP,
        1e-9,
        "it never gets there",
        changes=("plant.damping=1e4", *FEEBLE),
    ),
    Row(
        "restart behind the retract",
        (DONE,),
        DEEP,
        4.2e-7,
        TOUCH,
        changes=("loop.duration=1.1", "loop.stop_when="),
        signals=(Signal("controller.enable", (0.0, 0.01, 0.5, 0.51), (False, True, False, True)),),
    ),
    Row(
        "enable goes off and on on the way",
        (DONE,),
        DEEP,
        1e-9,
        "it goes back before the surface",
        signals=(Signal("controller.enable", (0.0, 0.01, 0.2, 0.201), (False, True, False, True)),),
    ),
    Row(
        "second fault: travel limit, then the encoder",
        ("TravelLimit", "LostReading"),
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
        replace(row, changes=(*SHORT, *row.changes)) for row in (*ROWS, *commission.ROWS, *teaching.ROWS)
    ),
)
