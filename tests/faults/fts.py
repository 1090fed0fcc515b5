"""Faults of the rotary fast tool servo: the 0x4 lens at 600 rpm, from the cut at 0.4 s on.

The excursion is the travel of the tool into the part beyond its path, whose speed is v = 0.22 m/s at most. An
arm with a working drive is braked before it is released: v over five samples and half the pulse of
J v / (l T_max), 0.14 mm, and 0.06 mm for an inertia 20 % off nominal; l = 80 mm. Without a working drive the
arm coasts against the 2 N of the cut: J v^2 / (2 l^2 F) = 1.5 mm.
"""

from __future__ import annotations

import math

import cosim
from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from .commission import fts as commission
from .matrix import DONE, Matrix, Row

BEGIN = 0.53
"""Start of the fault, while the tool moves into the part."""
STEP = 1e-4

INTO = "max(plant.tip_depth) - max(plant.tip_depth[time < 0.5])"
RAISED = 'first_time(controller.fault != "None")'
AFTER = f"max(plant.tip_depth[time >= {RAISED}]) - at(plant.tip_depth, {RAISED})"
"""Travel beyond the position of the tool when the fault is raised."""
EARLY = "max(plant.tip_depth) - max(controller.reference.depth)"
"""Travel beyond the deepest point of the path, for faults from the start."""
FORM = next(
    metric.value.removeprefix("std(").removesuffix("[time > last(time) - 0.5])")
    for metric in cosim.load("fts/machine").metric
    if metric.name == "form"
)
"""Depth of the tool below the requested lens at its actual position on the part, except a constant."""
REFERENCE = f"({FORM} - plant.tip_depth + controller.reference.depth)"
PLACED = f"({FORM} - mean({REFERENCE}[(time > {BEGIN} - 0.1) & (time < {BEGIN})]))"
"""Depth of the tool less the mean difference of the revolution before the faults."""
OFF = f'max(abs({PLACED}[(time > {BEGIN}) & (controller.state == "Track")]))'
FOLLOWED = "max(abs((plant.tip_depth - controller.reference.depth)[time > 0.5]))"
"""Deviation from the reference of the controller, also out of the part."""
BRAKED = "v (5 T_s + J v / (2 l T_max)), and 0.06 mm for an off-nominal inertia"
LEFT_BEHIND = "the following error of 1 mm, and v (2 T_s + (2 - g) J v / (2 l T_max)) with g of the torque"
COASTS = "J v^2 / (2 l^2 F): the arm coasts against 2 N of the cut"
CONTROLLED = "5 % of the path's 1.75 mm: under control"
GOOD = "as without the fault: 20 um"

ARM, SPINDLE, SLIDE, TORQUE = (
    "controller.arm_angle", "controller.spindle_angle", "controller.slide_position", "plant.torque",
)  # fmt: skip


def lasting(to: str, **kind: float | int | bool) -> tuple[Injection, ...]:
    """Fault from the middle of the cut to the end."""
    return (Injection(to, from_time=BEGIN, **kind),)  # type: ignore[arg-type]


def spike(to: str, offset: float) -> tuple[Injection, ...]:
    """One bad sample."""
    return (Injection(to, from_time=BEGIN, duration=STEP, offset=offset),)


SHORT = ("loop.duration=1.2",)
"""Duration of runs that end with a fault: the arm is at rest long before."""
FAST = ("plant.spindle_speed=251.327", "controller.surface.outer_radius=0.032")
"""2400 rpm, at which the lens is feasible: v = 0.88 m/s; with 3 cm at 870 rpm it is 2.75 m/s."""


def lost(
    name: str,
    fault: str | tuple[str, ...],
    *inject: Injection,
    changes: tuple[str, ...] = (),
    truth: str = INTO,
) -> Row:
    """Fault with the reaction `DriveOff`, after which the arm coasts."""
    faults = (fault,) if isinstance(fault, str) else fault
    return Row(name, faults, truth, 2e-3, COASTS, inject, changes=(*SHORT, *changes), unit="m")


def braked(name: str, fault: str, *inject: Injection) -> Row:
    """Fault with the reaction `DriveOff`, before which the arm is braked."""
    return Row(name, (fault,), AFTER, 0.2e-3, BRAKED, inject, changes=SHORT, unit="m")


def left(name: str, fault: str, *inject: Injection, changes: tuple[str, ...] = ()) -> Row:
    """Fault with the reaction `Retract`."""
    return Row(name, (fault,), INTO, 90e-6, CONTROLLED, inject, changes=(*SHORT, *changes), unit="m")


def tolerated(
    name: str, *inject: Injection, changes: tuple[str, ...] = (), signals: tuple[Signal, ...] = ()
) -> Row:
    """Fault that the controller tolerates."""
    return Row(name, (DONE,), OFF, 20e-6, GOOD, inject, signals, changes, unit="m")


OUT = ("plant.feed=5e-4", "controller.surface.inner_radius=0.0275")
DEPTH = "controller.probe_depth"
LENS = (
    f'max(maximum(abs({PLACED}), controller.form.corrected)[(time > 9.45) & (controller.state == "Track")])'
)
"""Error of the second lens, which the probe of the first must not affect; 1 m if it is corrected at all."""


def at_the_lens(to: str, begin: float = 4.3, **kind: float | int | bool) -> Injection:
    """Fault while the first lens is probed."""
    return Injection(to, from_time=begin, duration=7.0 - begin, **kind)  # type: ignore[arg-type]


def probed(name: str, inject: Injection) -> Row:
    """Fault of the probe on a lens: no correction, and the next lens is like the first."""
    return Row(
        name,
        (DONE,),
        LENS,
        12e-6,
        "uncorrected, 5 um rms at n = 2 are 7.1 um at the crest, more at the outer end and by tracking",
        (inject,),
        changes=("loop.duration=11.2",),
        scenario="fts/form",
        unit="m",
    )


TURNS = "abs(sin(2 * plant.spindle_angle))"
"""0 where the arm reverses on the lens, 1 where it moves fastest."""
LATE, LATER = ((f"wire.controller.arm_angle.delay={samples}",) for samples in (1, 2))


def undetectable(name: str, most: float, why: str, *inject: Injection, changes: tuple[str, ...] = ()) -> Row:
    """Fault that no signal shows, with its effect."""
    reason = "every signal is that of a good machine at another position or time"
    return Row(name, (), OFF, most, why, inject, changes=changes, unit="m", undetectable=reason)


MATRIX = Matrix(
    scenario="fts",
    seed=71_301,
    good=(
        '(last(controller.fault) == "None")'
        f' & ((last(controller.state) == "Done") | (max(abs({PLACED}[time > last(time) - 0.1])) < 20e-6))'
    ),
    rest=(
        '(last(controller.state) == "Track")'
        " | (abs(last(plant.tip_depth) - at(plant.tip_depth, last(time) - 0.02)) < 20e-6)"
    ),
    rows=(
        braked("arm encoder frozen in motion", "PositionFrozen", *lasting(ARM, frozen=True)),
        Row(
            "arm encoder frozen, its last bit flickers",
            ("PositionFrozen",),
            AFTER,
            0.4e-3,
            "frozen at the reversal until 52 um have no response: coasts from 27.6 m/s2 in 3.4 ms",
            (*lasting(ARM, frozen=True), *lasting(ARM, noise=7.5e-7)),
            changes=SHORT,
            unit="m",
        ),
        lost(
            "arm encoder frozen on a nearly flat lens",
            ("PositionFrozen", "WeakDrive"),
            *lasting(ARM, frozen=True),
            changes=("controller.surface.cross_curvature=0.94", "plant.slide_start=0.05"),
        ),
        braked("arm encoder 0.01 rad off", "PositionJump", *lasting(ARM, offset=0.01)),
        braked("arm encoder delivers no number", "PositionLost", *lasting(ARM, value=math.nan)),
        braked("arm encoder with noise of 1 mrad", "PositionJump", *lasting(ARM, noise=1e-3)),
        Row(
            "arm encoder range ends in the path",
            ("PositionFrozen", "PositionJump"),
            EARLY,
            80e-3,
            "a full circle of the arm: in air nothing stops it",
            changes=("wire.controller.arm_angle.maximum=-0.055",),
            unit="m",
        ),
        braked("every second sample of the arm lost", "PositionFrozen", *lasting(ARM, drop=0.5)),
        braked(
            "arm encoder 3 samples late where the arm moves",
            "PositionJump",
            Injection(ARM, when=f"(time > {BEGIN}) & ({TURNS} > 0.9)", late=3),
        ),
        undetectable(
            "arm encoder 3 samples late where the arm reverses",
            100e-6,
            "v of 0.22 m/s for three samples: 66 um",
            Injection(ARM, when=f"(time > {BEGIN}) & ({TURNS} < 0.05)", late=3),
        ),
        tolerated(
            "first sample of all three encoders wrong: 0.1 rad, 1 rad, 20 mm",
            Injection(ARM, from_time=0.0, duration=STEP, offset=0.1),
            Injection(SPINDLE, from_time=0.0, duration=STEP, offset=-1.0),
            Injection(SLIDE, from_time=0.0, duration=STEP, offset=0.02),
        ),
        undetectable(
            "spindle angle 1 sample late, its first sample twice",
            40e-6,
            "v of 0.22 m/s for a sample: 22 um",
            changes=("wire.controller.spindle_angle.delay=1",),
        ),
        tolerated("one spike of the arm encoder, 0.1 rad", *spike(ARM, 0.1)),
        tolerated(
            "one sample of the arm encoder is no number",
            Injection(ARM, from_time=BEGIN, duration=STEP, value=math.nan),
        ),
        tolerated("arm encoder with noise of 5 urad, x20", *lasting(ARM, noise=5e-6)),
        tolerated("one of fifty samples of the arm lost", *lasting(ARM, drop=0.02)),
        left("spindle encoder frozen", "SpindleFrozen", *lasting(SPINDLE, frozen=True)),
        left("spindle encoder 1 rad off", "SpindleJump", *lasting(SPINDLE, offset=1.0)),
        left("spindle encoder delivers no number", "SpindleLost", *lasting(SPINDLE, value=math.nan)),
        tolerated("one spike of the spindle encoder, 1 rad", *spike(SPINDLE, 1.0)),
        left("slide encoder 20 mm off", "SlideJump", *lasting(SLIDE, offset=0.02)),
        left("slide encoder delivers no number", "SlideLost", *lasting(SLIDE, value=math.nan)),
        left(
            "slide encoder frozen, with `limits.feed`",
            "SlideFrozen",
            *lasting(SLIDE, frozen=True),
            changes=("controller.limits.feed=1e-5",),
        ),
        left(
            "slide encoder drifts by a feed per revolution, with `limits.feed`",
            "SlideFrozen",
            *lasting(SLIDE, ramp=1e-4),
            changes=("controller.limits.feed=1e-5",),
        ),
        tolerated("one spike of the slide encoder, 20 mm", *spike(SLIDE, 0.02)),
        undetectable(
            "slide encoder drifts by 0.1 mm/s",
            70e-6,
            "dz/dx = x / R = 0.23 of the 0.15 mm until the end, twice",
            *lasting(SLIDE, ramp=1e-4),
        ),
        undetectable(
            "arm encoder drifts by 0.1 rad/s",
            13e-3,
            "l times 0.147 rad until the end; without a stiffness no torque shows the position of the arm",
            *lasting(ARM, ramp=0.1),
        ),
        undetectable(
            "spindle encoder drifts by 0.1 rad/s",
            0.7e-3,
            "twice the angle of 0.15 rad until the end, of 1.75 mm",
            *lasting(SPINDLE, ramp=0.1),
        ),
        tolerated("arm angle 1 sample late, configured", changes=(*LATE, "controller.arm_delay=1")),
        tolerated("arm angle 2 samples late, configured", changes=(*LATER, "controller.arm_delay=2")),
        undetectable(
            "arm angle 1 sample late, not configured",
            40e-6,
            "v of 0.22 m/s for a sample: 22 um",
            changes=LATE,
        ),
        undetectable(
            "arm angle 2 samples late, not configured",
            70e-6,
            "the same for two samples: 44 um",
            changes=LATER,
        ),
        left("hold angle is no number", "InvalidInput", *lasting("controller.hold_angle", value=math.nan)),
        lost("torque with the wrong sign", "DriveSign", *lasting(TORQUE, scale=-1.0)),
        lost(
            "torque with the wrong sign from the start",
            "DriveSign",
            Injection(TORQUE, from_time=0.0, scale=-1.0),
            truth=AFTER,
        ),
        lost("drive delivers 0.3 of the torque", "WeakDrive", *lasting(TORQUE, scale=0.3)),
        Row(
            "drive delivers 0.6 of the torque at 2400 rpm",
            ("FollowingError",),
            INTO,
            2e-3,
            LEFT_BEHIND,
            lasting(TORQUE, scale=0.6),
            changes=(*SHORT, *FAST),
            unit="m",
        ),
        Row(
            "drive delivers 0.8 of the torque where the arm moves fastest",
            ("FollowingError",),
            INTO,
            8e-3,
            LEFT_BEHIND,
            (Injection(TORQUE, when=f"(time > {BEGIN}) & (sin(2 * plant.spindle_angle) > 0.95)", scale=0.8),),
            scenario="fts/3cm",
            unit="m",
        ),
        Row(
            "drive delivers 0.75 of the torque",
            ("FollowingError",),
            INTO,
            8e-3,
            LEFT_BEHIND,
            lasting(TORQUE, scale=0.75),
            scenario="fts/3cm",
            unit="m",
        ),
        Row(
            "torque with the wrong sign at 2400 rpm",
            ("DriveSign",),
            INTO,
            6e-3,
            "1 mm of following error, v (5 T_s + J v / (2 l T_max)) at 2.2 m/s: the opposite pulse brakes it",
            lasting(TORQUE, scale=-1.0),
            changes=(*SHORT, *FAST),
            unit="m",
        ),
        lost("no torque", "WeakDrive", *lasting(TORQUE, value=0.0)),
        Row(
            "torque stuck",
            ("WeakDrive", "DriveSign"),
            INTO,
            4.5e-3,
            "J v^2 / (2 l^2 F) of v and l (T - l F) / J in half of the 10 ms of the drive monitor: 0.37 m/s",
            lasting(TORQUE, frozen=True),
            changes=SHORT,
            unit="m",
        ),
        Row(
            "torque stuck at 2400 rpm",
            ("WeakDrive", "DriveSign", "FollowingError"),
            INTO,
            80e-3,
            "a full circle of the arm: it has 1.8 m/s when 1 mm detects it, and no drive brakes it",
            lasting(TORQUE, frozen=True),
            changes=(*SHORT, *FAST),
            unit="m",
        ),
        lost("amplifier trips", "WeakDrive", *lasting("plant.enable", value=0.0)),
        lost(
            "flexure without damping, at 840 Hz",
            ("Oscillation", "PositionJump"),
            changes=("plant.flexure_damping=0.0005", "plant.flexure_frequency=840.0"),
            truth=AFTER,
        ),
        Row(
            "half of the torque for 3 cm at 870 rpm, 10 mm of following error allowed",
            ("Saturation",),
            EARLY,
            15e-3,
            "3 cm of path, and the 10 mm",
            changes=(
                "controller.surface.kind='Wave'",
                "controller.surface.wave_harmonic=2",
                "controller.surface.wave_amplitude=0.015",
                "controller.limits.following_error=0.01",
                "plant.spindle_speed=91.1",
                "plant.torque_gain=0.5",
            ),
            unit="m",
        ),
        Row(
            "inertia configured 7 times too large, 1 mrad of spread allowed",
            ("Oscillation",),
            AFTER,
            7e-3,
            "J v^2 / (2 l^2 F) of v = l T_max / (4 f J): an oscillation at full torque, of 370 Hz or more",
            changes=(*SHORT, "controller.servo.inertia=5.6e-3", "controller.limits.arm_spread=1e-3"),
            unit="m",
        ),
        lost(
            "inertia configured 5.5 times too large",
            "PositionJump",
            changes=("controller.servo.inertia=4.4e-3",),
            truth=AFTER,
        ),
        lost(
            "drive delivers 0.40 of the 0.45 N.m of the path",
            "WeakDrive",
            changes=("plant.torque_limit=0.40",),
            truth=EARLY,
        ),
        Row(
            "noise of the cut above `expert.limits.tracking_error`",
            ("NoProgress",),
            EARLY,
            90e-6,
            CONTROLLED,
            changes=("controller.expert.limits.tracking_error=1e-7", "loop.duration=4.0"),
            unit="m",
        ),
        Row(
            "eq. 3 as printed at 1200 rpm",
            ("Divergence",),
            EARLY,
            90e-6,
            CONTROLLED,
            changes=("controller.law='Paper'", "plant.spindle_speed=125.66", "loop.duration=5.0"),
            unit="m",
        ),
        lost("thrust of 70 N in the cut", "PositionJump", changes=("plant.cutting_force=70.0",)),
        lost(
            "thrust of 60 N, 5 N.m of it allowed",
            "FollowingError",
            changes=("plant.cutting_force=60.0", "controller.limits.disturbance=5.0"),
        ),
        Row(
            "slide outside of the table at the start",
            ("OutsideTable",),
            AFTER,
            10e-6,
            "detected before anything moves",
            changes=("controller.surface.outer_radius=0.029",),
            unit="m",
        ),
        Row(
            "spindle faster than the torque for the path",
            ("Infeasible",),
            AFTER,
            10e-6,
            "detected before anything moves",
            changes=("plant.spindle_speed=420.0",),
            unit="m",
        ),
        Row(
            "communication in steps of two samples",
            ("LongStep",),
            AFTER,
            10e-6,
            "detected in the first sample: only bearing play moves",
            changes=("loop.step=2e-4", "loop.substeps=10"),
            unit="m",
        ),
        Row(
            "inertia configured 1.3 times too large",
            (DONE,),
            OFF,
            30e-6,
            "1.3 times the 20 um, which are not learned yet",
            changes=("controller.servo.inertia=1.04e-3",),
            unit="m",
        ),
        tolerated(
            "delay of two samples, configured as 0",
            changes=("controller.io_delay=0", "wire.plant.torque.delay=1"),
        ),
        Row(
            "spindle encoder frozen, then also the arm encoder",
            ("SpindleFrozen", "PositionFrozen"),
            INTO,
            2e-3,
            COASTS,
            (*lasting(SPINDLE, frozen=True), Injection(ARM, from_time=BEGIN + 0.05, frozen=True)),
            unit="m",
            sequence=True,
        ),
        Row(
            "switched off for 50 ms in the cut",
            (DONE,),
            INTO,
            90e-6,
            CONTROLLED,
            signals=(Signal("controller.enable", (0.0, BEGIN, BEGIN + 0.05), (True, False, True)),),
            unit="m",
        ),
        Row(
            "slide runs out of the table, nominal drive",
            (DONE,),
            FOLLOWED,
            25e-6,
            "20 um; the cut started at 0.4 s and is not fully learned at 0.5 s",
            changes=(*OUT, "plant.torque_gain=1.0"),
            unit="m",
        ),
        Row(
            "slide runs out of the table",
            (DONE,),
            FOLLOWED,
            25e-6,
            "20 um, and 0.28 % of 1.75 mm of a drive 3 % weaker, which is learned after 0.5 s",
            changes=OUT,
            unit="m",
        ),
        probed("probe delivers no number on a lens", at_the_lens(DEPTH, value=math.nan)),
        probed("probe of a lens 0.2 mm off from the middle on", at_the_lens(DEPTH, 5.5, offset=2e-4)),
        probed("angle of a lens frozen under the probe", at_the_lens("controller.probe_angle", frozen=True)),
        *commission.ROWS,
    ),
)
