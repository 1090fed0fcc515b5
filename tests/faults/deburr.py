"""Simulated faults of the deburring robot, on the test piece with a random burr."""

from dataclasses import replace

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from . import deburr_registration as registration
from .commission import deburr as commission
from .matrix import DONE, Matrix, Row

TIP = "max(abs(plant.deviation[controller.path.distance > 0]))"
"""Distance of the tip from the edge, from the first motion on the path until the end of the run."""
BEYOND = "max(plant.tip_z - controller.axis2.position) - min(plant.tip_z - controller.axis2.position)"
"""Motion of the tip in height that the position of axis 2 does not show, of the 20 mm of the retract."""
HEIGHT = "first(plant.tip_z) - min(plant.tip_z)"
"""Motion of the tip down towards the path, of 20 mm."""

FROM_REST = "max(hypot(plant.tip_x - first(plant.tip_x), plant.tip_y - first(plant.tip_y)))"
"""Horizontal distance of the tip from its first position."""

AXIS1, AXIS2, AXIS3 = ("controller.axis1.position", "controller.axis2.position", "controller.axis3.position")
AXIS5 = "controller.axis5.position"
DRIVE1, DRIVE3 = ("plant.axis1_velocity", "plant.axis3_velocity")
TOOL = "controller.spindle_speed"
FLICKERS = ("plant.spindle_noise=1.0",)
BURR = ("plant.burr_height_least=5e-3", "plant.burr_thickness_least=2e-3", "plant.burr_gaps=0.0")

# bound of the excursion; the limit itself is at most 1.5 times the measured value
FROZEN = "at most 1 mm and 4 samples of 1 mm without response, then closed brakes"
BRIDGED = "at most 3 samples of 1 mm are bridged along the commands"
BLIND = "at most 1 mm, half the lag of 3.8 mm at 50 mm/s, 4 samples of 0.5 mm, then closed brakes"
NARROW = "at most 0.5 mm with patterns, 4 samples that grow by 1 mm at most, then closed brakes"
EARLY = "at most 0.5 mm with patterns, 4 samples of 0.22 mm from rest, then closed brakes or the retract"
HELD = "error with patterns, and the stop along the path"


def at(time: float, to: str, **kind: float | bool) -> tuple[Injection, ...]:
    """Fault from a time (s) on."""
    return (Injection(to, from_time=time, **kind),)  # type: ignore[arg-type]


SECOND_REST = tuple(
    Injection(to, when='controller.state == "Settle" and time > 8', after=0.1, **kind)
    for to, kind in ((AXIS2, {"frozen": True}), ("plant.axis2_velocity", {"offset": -5e-3}))
)
"""Encoder 2 is frozen from 0.1 s after the start of that rest, while its drive creeps down."""

ROWS = (
    Row(
        "encoder 1 frozen before it moves",
        ("PositionFrozen",),
        TIP,
        1.8e-4,
        "1 mm without response from rest, 4 samples of 0.32 mm, then closed brakes",
        at(0.0, AXIS1, frozen=True),
    ),
    Row(
        "encoder 1 frozen in the burr", ("PositionFrozen",), TIP, 6.7e-4, FROZEN, at(4.0, AXIS1, frozen=True)
    ),
    Row(
        "encoder 2 frozen above the part",
        ("PositionFrozen",),
        HEIGHT,
        2.6e-3,
        "1 mm and 4 samples of 0.3 mm without response, then closed brakes",
        at(0.3, AXIS2, frozen=True),
    ),
    Row(
        "encoder 3 frozen in the burr", ("PositionFrozen",), TIP, 8.9e-4, FROZEN, at(4.0, AXIS3, frozen=True)
    ),
    Row(
        "encoder 5 frozen at rest in the burr, its drive creeps by 10 mm/s at the tip",
        ("PositionFrozen",),
        TIP,
        1.4e-2,
        "10 mm/s for the time that its noise may be constant, then closed brakes",
        (*at(4.0, AXIS5, frozen=True), *at(4.0, "plant.axis5_velocity", offset=0.05)),
    ),
    Row(
        "encoder 2 frozen at rest in the burr, after a rest of 2 s, its drive creeps by 5 mm/s",
        ("PositionFrozen",),
        BEYOND,
        1.4e-2,
        "5 mm/s for the time that its noise may be constant, then closed brakes",
        (*at(5.2, AXIS2, frozen=True), *at(5.2, "plant.axis2_velocity", offset=-5e-3)),
        changes=("controller.expert.transfer.settle_time=2.0",),
    ),
    Row(
        "encoder 2 frozen early in the rest before a second task, its drive creeps by 5 mm/s",
        ("PositionFrozen",),
        BEYOND,
        9e-3,
        "5 mm/s for the time that the noise of earlier rests may be constant, then closed brakes",
        SECOND_REST,
        (Signal("controller.mode", (0.0, 6.6, 10.4), ("Deburr", "Idle", "Deburr")),),
        changes=("controller.limits.spindle_change=0",),  # the burr is removed
    ),
    Row(
        "the same, and the task is ended in that rest",
        ("PositionFrozen",),
        BEYOND,
        9e-3,
        "5 mm/s for the time that the noise of earlier rests may be constant, then closed brakes",
        SECOND_REST,
        (Signal("controller.mode", (0.0, 6.6, 10.4, 15.3), ("Deburr", "Idle", "Deburr", "Idle")),),
        changes=("controller.limits.spindle_change=0",),
    ),
    Row(
        "encoder 5 without noise frozen at rest in the burr, its drive creeps by 10 mm/s at the tip",
        (),
        TIP,
        2.1e-2,
        "10 mm/s until the drive stops creeping",
        (
            Injection(AXIS5, from_time=4.0, frozen=True),
            Injection("plant.axis5_velocity", from_time=4.0, duration=1.8, offset=0.05),
        ),
        changes=("plant.encoder_noise=0",),
        undetectable="without noise a valid position is constant at rest, too; only a motion shows it",
    ),
    Row(
        "encoder 3 off by 20 mm for one sample",
        (DONE,),
        TIP,
        4.4e-5,
        HELD,
        (Injection(AXIS3, from_time=4.0, duration=0.01, offset=0.02),),
    ),
    Row("encoder 3 off by 20 mm", ("PositionJump",), TIP, 1.1e-4, BRIDGED, at(4.0, AXIS3, offset=0.02)),
    Row(
        "encoder 3 off by 0.3 mm, less than a jump",
        (DONE,),
        TIP,
        3.4e-4,
        "the offset, twice with its recovery",
        at(4.0, AXIS3, offset=3e-4),
    ),
    Row(
        "encoder 3 loses 0.2 mm every 0.1 s",
        ("PositionJump",),
        TIP,
        1.8e-3,
        "1 mm lost, of axes across a path at 46 degrees, and 2 steps until it is detected",
        tuple(Injection(AXIS3, from_time=3.5 + 0.1 * k, offset=-2e-4) for k in range(20)),
    ),
    Row(
        "encoder 1 loses 0.1 mrad every 50 ms",
        ("PositionJump",),
        TIP,
        1.8e-3,
        "1.5 mrad lost at 0.75 m, and 2 steps until it is detected",
        tuple(Injection(AXIS1, from_time=3.5 + 0.05 * k, offset=1e-4) for k in range(45)),
    ),
    Row(
        "encoder 3 reports inches instead of millimeters",
        ("WeakDrive",),
        FROM_REST,
        1.8e-2,
        "half of the commanded motion without response",
        at(0.0, AXIS3, scale=1.0 / 25.4),
    ),
    Row(
        "encoder 1 counts a tenth too little",
        ("PatternMismatch",),
        TIP,
        9e-3,
        "a tenth of the angle from where it reads 0, until the path is fast",
        at(0.0, AXIS1, scale=0.9),
    ),
    Row(
        "encoder 1 counts 3 % too little",
        (),
        TIP,
        2.6e-3,
        "3 % of the angle from where it reads 0, 0.1 rad at 0.7 m",
        at(0.0, AXIS1, scale=0.97),
        undetectable="a drive of 0.97 of its gain responds alike; touches at two positions show it",
    ),
    Row(
        "part displaced by 1 mm, not registered",
        (),
        TIP,
        1.4e-3,
        "the displacement, and the error with patterns",
        changes=("plant.part_x=1e-3",),
        undetectable="a burr of 1 to 2 mm varies by as much, and so does the load",
    ),
    Row(
        "part displaced by 5 mm, longest gap of the burr configured",
        ("NoCut",),
        TIP,
        5.5e-3,
        "the 5 mm across the path, for the configured distance",
        changes=("plant.part_y=-5e-3", "controller.limits.idle_travel=0.03"),
    ),
    Row(
        "encoder 3 drifts by 20 mm/s",
        ("PatternMismatch", "FollowingError"),
        TIP,
        4.1e-3,
        "0.5 mm of error are 6.5 mm/s over Kp; the drift until then and during the retract",
        at(4.0, AXIS3, ramp=0.02),
    ),
    Row(
        "encoder 3 drifts by 2 mm/s",
        ("FollowingError",),
        TIP,
        3.9e-3,
        "3 s until the rest after the path",
        at(4.0, AXIS3, ramp=2e-3),
    ),
    Row(
        "drive 2 with an offset of 1 mm/s, a thousandth, from 1 s before the task",
        ("FollowingError",),
        TIP,
        1.3e-4,
        "the offset over Kp, 77 um, and the error with patterns",
        at(0.0, "plant.axis2_velocity", offset=1e-3),
        (Signal("controller.mode", (0.0, 1.0), ("Idle", "Deburr")),),
    ),
    Row(
        "the same, 0.1 mm allowed in the rest",
        (DONE,),
        TIP,
        1.3e-4,
        "the offset over Kp, 77 um, and the error with patterns",
        at(0.0, "plant.axis2_velocity", offset=1e-3),
        (Signal("controller.mode", (0.0, 1.0), ("Idle", "Deburr")),),
        changes=("controller.expert.limits.axis2.rest_error=1e-4",),
    ),
    Row(
        "drive 3 with an offset of 5 mm/s",
        ("FollowingError",),
        TIP,
        5.8e-4,
        "the offset over Kp, 0.38 mm, and the error with patterns",
        at(0.0, DRIVE3, offset=5e-3),
    ),
    Row(
        "drive 3 with an offset of 5 mm/s from the burr on",
        ("FollowingError",),
        TIP,
        5.8e-4,
        "the offset over Kp, 0.38 mm, and the error with patterns",
        at(4.0, DRIVE3, offset=5e-3),
    ),
    Row(
        "drive 3 with an offset of -10 mm/s from the burr on",
        ("PatternMismatch", "FollowingError"),
        TIP,
        8.4e-4,
        "the offset over Kp, 0.77 mm, and the error with patterns",
        at(4.0, DRIVE3, offset=-1e-2),
    ),
    Row(
        "drive 3 with an offset of 20 mm/s from the first sample on",
        ("FollowingError",),
        FROM_REST,
        1.9e-3,
        "1 mm and 4 samples of 0.2 mm, then closed brakes",
        at(0.0, DRIVE3, offset=2e-2),
    ),
    Row(
        "drive 2 with an offset of -5 mm/s from the first sample on",
        ("FollowingError",),
        BEYOND,
        1.3e-5,
        "the encoder shows all of it, except half a count and its noise",
        at(0.0, "plant.axis2_velocity", offset=-5e-3),
    ),
    Row(
        "first sample of encoder 3 off by 20 mm and of the tool speed 0",
        (DONE,),
        TIP,
        4.4e-5,
        HELD,
        (
            Injection(AXIS3, from_time=0.0, duration=0.01, offset=0.02),
            Injection(TOOL, from_time=0.0, duration=0.01, value=0.0),
        ),
    ),
    Row(
        "first sample of encoder 1 is NaN",
        (DONE,),
        TIP,
        4.4e-5,
        HELD,
        (Injection(AXIS1, from_time=0.0, duration=0.01, value=float("nan")),),
    ),
    Row(
        "noise of 0.1 mm on encoder 3, twenty counts",
        (DONE,),
        TIP,
        1.1e-4,
        "three times the noise",
        at(0.0, AXIS3, noise=1e-4),
    ),
    Row(
        "a third of the samples of encoder 1 lost",
        (DONE, "PositionFrozen"),
        TIP,
        7.8e-4,
        FROZEN,
        at(3.0, AXIS1, drop=0.33),
    ),
    Row(
        "encoder 3 late by 5 samples",
        ("WrongDelay", "WeakDrive"),
        TIP,
        2.2e-3,
        NARROW,
        at(3.0, AXIS3, late=5),
    ),
    Row(
        "encoder 1 late by 1 sample",
        ("WrongDelay",),
        TIP,
        7.1e-4,
        "at most 0.5 mm of axes 1 and 3 with patterns, until it is detected at the end of the run",
        at(0.0, AXIS1, late=1),
    ),
    Row(
        "encoder 3 is NaN",
        ("PositionLost",),
        TIP,
        1.1e-4,
        "3 samples are bridged along the commands, then closed brakes",
        at(4.0, AXIS3, value=float("nan")),
    ),
    Row(
        "encoder 3 is NaN for one sample",
        (DONE,),
        TIP,
        4.4e-5,
        HELD,
        (Injection(AXIS3, from_time=4.0, duration=0.01, value=float("nan")),),
    ),
    Row(
        "encoder 3 infinite for one sample",
        (DONE,),
        TIP,
        4.4e-5,
        HELD,
        (Injection(AXIS3, from_time=4.0, duration=0.01, value=float("inf")),),
    ),
    Row(
        "override is NaN",
        ("InvalidInput",),
        TIP,
        4.4e-5,
        HELD,
        at(4.0, "controller.speed_override", value=float("nan")),
    ),
    Row(
        "override is NaN for one sample",
        (DONE,),
        TIP,
        4.4e-5,
        HELD,
        (Injection("controller.speed_override", from_time=4.0, duration=0.01, value=float("nan")),),
    ),
    Row(
        "tool speed stuck at idle",
        ("NoCut",),
        TIP,
        3.8e-5,
        "the programmed speed on the random burr",
        at(0.0, TOOL, frozen=True),
    ),
    Row(
        "tool speed freezes at idle in the middle of the path",
        ("NoCut",),
        TIP,
        3.8e-5,
        "the programmed speed on the random burr",
        at(3.4, TOOL, value=1883.73),
        changes=("controller.limits.idle_travel=0.1",),
    ),
    Row(
        "noisy tool speed freezes at idle in the middle of the path",
        ("SpindleFrozen",),
        TIP,
        4.2e-5,
        "0.7 s at the programmed speed on the random burr, then the stop along the path",
        at(3.4, TOOL, value=1883.73),
        changes=FLICKERS,
    ),
    Row(
        "noisy tool speed frozen in the burr",
        ("SpindleFrozen",),
        TIP,
        4.4e-5,
        HELD,
        at(4.0, TOOL, frozen=True),
        changes=FLICKERS,
    ),
    Row(
        "tool speed 0 for one sample",
        (DONE,),
        TIP,
        4.4e-5,
        HELD,
        (Injection(TOOL, from_time=4.0, duration=0.01, value=0.0),),
    ),
    Row(
        "tool speed 0",
        ("SpindleJump",),
        TIP,
        4.4e-5,
        HELD,
        at(4.0, TOOL, value=0.0),
    ),
    Row("tool speed is NaN", ("SpindleLost",), TIP, 4.4e-5, HELD, at(4.0, TOOL, value=float("nan"))),
    Row("noise of 300 rpm on the tool speed", (DONE,), TIP, 4.2e-5, HELD, at(0.0, TOOL, noise=31.4)),
    Row(
        "tool speed frozen in the burr",
        ("SpindleFrozen",),  # a noisy speed that is no longer noisy is detected
        TIP,
        4.4e-5,
        HELD,
        at(4.0, TOOL, frozen=True),
    ),
    Row("drive 1 with the wrong sign", ("DriveSign",), FROM_REST, 4e-3, BLIND, at(0.0, DRIVE1, scale=-1.0)),
    Row("drive 3 does 0.3 of its command", ("WeakDrive",), TIP, 3.2e-3, NARROW, at(3.5, DRIVE3, scale=0.3)),
    # the position continues to flicker
    Row("command of drive 3 lost", ("WeakDrive",), TIP, 5e-3, FROZEN, at(4.0, DRIVE3, value=0.0)),
    Row(
        "command of drive 3 stuck",
        ("FollowingError", "PatternMismatch", "WeakDrive", "DriveSign"),
        TIP,
        5e-3,
        NARROW,
        at(4.2, DRIVE3, frozen=True),
    ),
    Row(
        "drive 1 limited to 0.05 rad/s",
        ("WeakDrive", "FollowingError"),
        TIP,
        1.9e-3,
        NARROW,
        changes=("plant.axis1_speed=0.05",),
    ),
    Row(
        "drives with 0.7 of their gain, foreign bank",
        ("PatternMismatch", "WeakDrive"),
        TIP,
        6.8e-5,
        EARLY,
        changes=("plant.drive_gain=0.7",),
    ),
    Row(
        "drives with 1.3 of their gain, foreign bank",
        ("PatternMismatch",),
        TIP,
        1e-5,
        EARLY,
        changes=("plant.drive_gain=1.3",),
    ),
    Row(
        "commands act immediately, configured 1 sample late",
        ("WrongDelay",),
        TIP,
        5e-4,
        "the paper's accuracy",
        changes=("loop.compute_delay=0",),
    ),
    Row(
        "commands of drives 1 and 3 late by 3 samples more",
        ("WrongDelay", "PatternMismatch", "WeakDrive"),
        TIP,
        5.7e-5,
        EARLY,
        (*at(0.0, DRIVE1, late=3), *at(0.0, DRIVE3, late=3)),
    ),
    Row(
        "burr six times as hard, feed not regulated",
        ("SpindleSlow",),
        TIP,
        1.1e-4,
        "4 samples at the programmed speed, retract",
        changes=("plant.cutting_pressure=5.4e9", "controller.expert.load.enable=false", *BURR),
    ),
    Row(
        "stalled tool, then encoder 2 frozen in the retract",
        ("SpindleSlow", "PositionFrozen"),
        BEYOND,
        1.6e-3,
        "1 mm and 4 samples of 0.3 mm without response, then closed brakes",
        (Injection(AXIS2, when='controller.state == "Retract"', after=0.1, frozen=True),),
        changes=("plant.cutting_pressure=5.4e9", "controller.expert.load.enable=false", *BURR),
        sequence=True,
    ),
    Row(
        "tool speed 0, then encoder 3 frozen in the retract, drives with 1.05 of their gain",
        ("SpindleJump", "PositionFrozen"),
        TIP,
        1.6e-3,
        "1 mm without response in the pose that is held, then closed brakes",
        (
            Injection(TOOL, from_time=4.0, value=0.0),
            Injection(AXIS3, when='controller.state == "Retract"', frozen=True),
        ),
        changes=("plant.drive_gain=1.05",),
        sequence=True,
    ),
    Row(
        "communication step of two samples",
        ("LongStep",),
        HEIGHT,
        1e-5,
        "the first sample, before any motion",
        changes=("loop.step=0.02", "loop.substeps=20"),
    ),
    Row(
        "gain of axis 3 seven times as high, without patterns and noise, nominal drives",
        ("Oscillation",),
        TIP,
        8.5e-3,
        "1 mm, half the lag of 0.55 mm, and an oscillation that grows threefold until its third reversal",
        changes=("controller.expert.servo.gain[3]=90", "plant.encoder_noise=0", "plant.drive_frequency=280"),
        scenario="deburr/learn",
    ),
    Row(
        "gain of axis 3 seven times as high, without patterns, oscillates by its noise before any motion",
        ("Oscillation",),
        FROM_REST,
        3.4e-3,
        "1 mm from standstill, and an oscillation that grows threefold until its third reversal",
        changes=("controller.expert.servo.gain[3]=90",),
        scenario="deburr/learn",
    ),
    Row(
        "encoder 1 frozen while it learns",
        ("PositionFrozen",),
        TIP,
        1.2e-3,
        FROZEN,
        at(4.0, AXIS1, frozen=True),
        scenario="deburr/learn",
    ),
    Row(
        "drive 3 does 0.3 of its command while it learns",
        ("WeakDrive",),
        TIP,
        5.5e-3,
        "1 mm, half the lag of 5.4 mm and 4 samples of 1 mm of axis 3, across a path at 46 degrees",
        at(3.5, DRIVE3, scale=0.3),
        scenario="deburr/learn",
    ),
    Row(
        "a task that exceeds its time",
        ("NoProgress",),
        TIP,
        1.1e-5,
        HELD,
        changes=("controller.expert.limits.cycle_time=3.0",),
    ),
    Row(
        "patterns limited to 50 counts",
        ("PatternTooLarge",),
        TIP,
        1.4e-3,
        "the servo without patterns, one recorded run",
        changes=("controller.expert.limits.pulses_max=50",),
        scenario="deburr/learn",
    ),
    Row(
        "no patterns",
        ("BankEmpty",),
        HEIGHT,
        1e-5,
        "detected before any motion",
        scenario="deburr/no-bank",
    ),
    Row(
        "enable lost for 0.5 s",
        (DONE,),
        TIP,
        4.4e-5,
        HELD,
        signals=(Signal("controller.enable", (0.0, 4.0, 4.5), (True, False, True)),),
    ),
    Row(
        "deburred twice, the same part without a burr",
        ("NoCut",),
        TIP,
        4.4e-5,
        HELD,
        signals=(Signal("controller.mode", (0.0, 7.0, 7.5), ("Deburr", "Idle", "Deburr")),),
    ),
)


def still(axis: str) -> str:
    """Condition: the tip stays within 0.2 mm in the last 0.3 s, twice the largest noise of a position."""
    tip = f"plant.tip_{axis}[time > last(time) - 0.3]"
    return f"max({tip}) - min({tip}) < 2e-4"


def lasting(row: Row) -> Row:
    """Row that continues after the fault or the end of the task: nothing may move automatically."""
    again = any(signal.to in ("controller.enable", "controller.mode") for signal in row.signals)
    commissions = row in commission.ROWS
    end = 32.0 if commissions else 18.8 if again else 8.4
    return replace(row, changes=(*row.changes, f"loop.duration={end}", "loop.stop_when=''"))


MATRIX = Matrix(
    scenario="deburr",
    seed=81_311,
    good=(
        '(last(controller.state) == "Done") and (last(plant.finish_low) > -5e-4)'
        " and (last(plant.finish_high) < 1e-3)"
    ),
    rest=" and ".join(f"({still(axis)})" for axis in "xyz"),
    rows=(*(lasting(row) for row in (*ROWS, *commission.ROWS)), *registration.ROWS),
)
