"""Faults of the polishing robot: sensors, encoders, drives, parameters, the mold, and what a user does."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from .commission import polish as commission
from .matrix import DONE, Matrix, Row

# three times the feed of the scenario: the runs get shorter
QUICK = ("controller.feed.velocity=0.006", "loop.duration=2.1")
WHOLE = ("loop.duration=4.1",)
"""The complete cycle."""
ROUND = ("controller.stick_slip.mode='Circular'",)
SINKING = (0.0, *(0.8 + 0.05 * step for step in range(11)))
"""Times of steps of 10 um, s."""
MIDWAY = {"when": 'controller.state == "Follow"', "after": 0.5}
FORCE = "max(plant.contact_force)"
BESIDE = "max(hypot(plant.axis_x - controller.desired.x, plant.axis_y - controller.desired.y))"
HELD = "5 N and the ripple of the control law"
SEEN = (
    "0.25 s of `expert.limits.frozen_time` at the command for an error of 0.5 N: 45 um at 178 N/mm, and 5 N"
)
DEAD = "`limits.approach_depth` at 178 N/mm, and 2 N until it has reversed"
TOUCH = "0.25 s of `expert.limits.frozen_time` at `approach.velocity`, 50 um in the air: 75 um at 178 N/mm"
COAST = (
    "`expert.limits.following_error`, 50 um of stick-slip, 0.59 mm coasting: 31 kg, 10 mm/s, 2 N, 100 N.s/m"
)


def row(
    name: str, faults: str, *inject: Injection, most: float = 5.6, why: str = HELD, truth: str = FORCE,
    changes: tuple[str, ...] = (), signals: tuple[Signal, ...] = (), sequence: bool = False,
    undetectable: str = "",
) -> Row:  # fmt: skip
    """One row; the excursion is the largest true force by default."""
    unit = "m" if truth == BESIDE else "N"
    changed = (*QUICK, *changes)
    return Row(
        name, tuple(faults.split()), truth, most, why, inject, signals, changed, unit=unit,
        sequence=sequence, undetectable=undetectable,
    )  # fmt: skip


def midway(to: str, **kind: float) -> Injection:
    """Return a fault in the middle of the path."""
    return Injection(to, **MIDWAY, **kind)  # type: ignore[arg-type]


SENSOR = (
    row(
        "first sample of position and force wrong, 1 mm and 30 N",
        "None",
        Injection("controller.position.x", 0.0, duration=1e-3, offset=1e-3),
        Injection("controller.force.z", 0.0, duration=1e-3, offset=30.0),
        changes=WHOLE,
    ),
    row(
        "force frozen before the start",
        "ForceFrozen",
        Injection("controller.force.z", 0.0, frozen=True),
        most=0.0,
        why="nothing moves yet",
    ),
    row(
        "force frozen on the approach",
        "ForceFrozen",
        Injection("controller.force.z", when='controller.state == "Approach"', after=0.3, frozen=True),
        most=14.0,
        why=TOUCH,
    ),
    row(
        "force frozen for 0.2 s around the touch",
        "ForceJump",
        Injection(
            "controller.force.z", when='controller.state == "Approach"', after=0.35, duration=0.2, frozen=True
        ),
        most=15.0,
        why="0.2 s at `approach.velocity`, 20 um in the air, and 6 samples of detection: 83 um at 178 N/mm",
    ),
    row(
        "force flickers about its zero on the approach",
        "ApproachTimeout",
        Injection("controller.force.z", when='controller.state == "Approach"', value=0.0),
        Injection("controller.force.z", when='controller.state == "Approach"', noise=0.1),
        most=25.0,
        why=DEAD,
    ),
    row(
        "force frozen just after the touch",
        "ForceFrozen",
        Injection("controller.force.z", when='controller.state == "Settle"', frozen=True),
        most=6.0,
        why="`expert.limits.frozen` of travel without a response, and a band: 3.9 N at 178 N/mm",
    ),
    row(
        "force frozen on the path",
        "ForceFrozen",
        midway("controller.force.z", frozen=True),
        most=13.0,
        why=SEEN,
    ),
    row(
        "nine of ten force samples lost on the path",
        "",
        midway("controller.force.z", drop=0.9),
        most=8.3,
        why="5 N, and the response of the control law during the 10 ms between two samples",
        undetectable="a valid signal of this resolution is constant as long",
        changes=WHOLE,
    ),
    row(
        "force across the tip with the wrong sign",
        "NoSliding",
        Injection("controller.force.y", 0.0, scale=-1.0),
        changes=WHOLE,
    ),
    row("force frozen at 4.5 N", "ForceFrozen", midway("controller.force.z", value=4.5), most=13.0, why=SEEN),
    row(
        "force frozen at 4.5 N with noise",
        "ForceFrozen InvalidPath",
        midway("controller.force.z", value=4.5),
        midway("controller.force.z", noise=0.05),
        most=24.0,
        why="0.2 of 15.4 N are `expert.limits.force_angle` of 4.5 N, and 0.1 s of memory",
        changes=("controller.feed.velocity=0.002", "loop.duration=4.0"),
    ),
    row(
        "force frozen at 4.5 N with noise while the feed is stopped",
        "ForceFrozen",
        Injection("controller.feed_override", 1.2, value=0.0),
        midway("controller.force.z", value=4.5),
        midway("controller.force.z", noise=0.05),
        most=13.0,
        why="5 N, 3.6 N of `expert.limits.frozen` without a response, and the motion until standstill",
    ),
    row(
        "force is 0",
        "ContactLost",
        midway("controller.force.z", value=0.0),
        most=14.0,
        why="`expert.limits.lost_time` at `approach.velocity`: 50 um at 178 N/mm, and 5 N",
    ),
    row(
        "force is 2 N too large",
        "ForceFrozen UnloadTimeout",
        midway("controller.force.z", offset=2.0),
        changes=WHOLE,
    ),
    row(
        "force is 2 N too small",
        "ForceFrozen UnloadTimeout",
        midway("controller.force.z", offset=-2.0),
        most=7.6,
        why="5 N and the offset; only the unloaded tool shows it",
        changes=("loop.duration=5.2", "controller.expert.settle.time_max=1.0"),
    ),
    row(
        "force drifts by 1 N/s",
        "ForceFrozen UnloadTimeout",
        midway("controller.force.z", ramp=1.0),
        changes=WHOLE,
    ),
    row("one spike of 30 N", DONE, midway("controller.force.z", offset=30.0, duration=1e-3), changes=WHOLE),
    row(
        "one spike of -6 N on the approach",
        DONE,
        Injection("controller.force.z", when='controller.state == "Approach"', offset=-6.0, duration=1e-3),
        changes=WHOLE,
    ),
    row("20 times the noise", "NoisyForce", midway("controller.force.z", noise=1.0)),
    row("half of the force samples lost", DONE, midway("controller.force.z", drop=0.5), changes=WHOLE),
    row("force is not a number", "ForceLost", midway("controller.force.x", value=float("nan"))),
    row(
        "force at the end of its range",
        "Saturation ForceJump",
        midway("controller.force.x", value=100.0),
    ),
    row(
        "force shows a third",
        "WrongStiffness",
        Injection("controller.force.z", 0.0, scale=0.35),
        most=15.5,
        why="5 N over the measured ratio",
    ),
    row(
        "force shows half of itself from the path on",
        "",
        midway("controller.force.z", scale=0.5),
        most=11.2,
        why="5 N over the 0.45 that `expert.limits.stiffness_ratio` allows",
        undetectable="a softer tip and a slope of the mold have the same response",
        changes=WHOLE,
    ),
    row(
        "force with the wrong sign",
        "InvalidPath SettleTimeout",
        Injection("controller.force.z", 0.0, scale=-1.0),
    ),
    row(
        "force 20 ms late",
        DONE,
        midway("controller.force.z", late=20),
        most=6.5,
        why="5 N and the largest accepted oscillation",
        changes=WHOLE,
    ),
    row(
        "force 40 ms late",
        "Oscillation",
        midway("controller.force.z", late=40),
        most=9.0,
        why="5 N, and an oscillation that grows threefold in each half period",
        changes=WHOLE,
    ),
    row(
        "slow sensor in a fast loop, nominal drives",
        "Oscillation",
        changes=(
            "plant.force_bandwidth=4.0",
            "controller.impedance.bandwidth=100.0",
            "plant.drive_gain=1.0",
            *WHOLE,
        ),
        most=13.0,
        why="5 N, and an oscillation that grows threefold in each half period",
    ),
    row(
        "slow sensor in a fast loop",
        # a force that is 40 ms late oscillates and does not respond to 20 um within the same 50 ms; the noise
        # decides which fault is first: the oscillation in 17 of 20 runs with drives of 0.9 to 1.05, 12.6 N at
        # most
        "Oscillation ForceFrozen",
        changes=("plant.force_bandwidth=4.0", "controller.impedance.bandwidth=100.0", *WHOLE),
        most=13.0,
        why="5 N, and an oscillation that grows threefold in each half period",
    ),
    row(
        "force rotated by half a revolution",
        "InvalidPath",
        Injection("controller.force.x", 0.0, scale=-1.0),
        Injection("controller.force.y", 0.0, scale=-1.0),
        Injection("controller.force.z", 0.0, scale=-1.0),
    ),
)

ENCODERS = (
    row(
        "encoder z frozen on the approach",
        "PositionFrozen",
        Injection("controller.position.z", when='controller.state == "Approach"', frozen=True),
        most=0.0,
        why="0.2 mm above the mold",
    ),
    row(
        "encoder x frozen on the path",
        "PositionFrozen",
        midway("controller.position.x", frozen=True),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
    row(
        "encoder y frozen, its last bit flickers",
        "PositionFrozen",
        midway("controller.position.y", frozen=True),
        midway("controller.position.y", noise=0.4e-6),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
    row(
        "encoder x is 0.15 mm off",
        "FollowingError",
        midway("controller.position.x", offset=0.15e-3),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
    row(
        "encoder z is 50 um off",
        "ForceError",
        midway("controller.position.z", offset=50e-6),
        most=10.5,
        why="50 um at 178 N/mm are 9 N, minus the correction by the control law, and 5 N",
        changes=WHOLE,
    ),
    row("encoder z with 10 um of noise", DONE, midway("controller.position.z", noise=10e-6), changes=WHOLE),
    row(
        "encoder y drifts by 0.2 mm/s",
        "FollowingError",
        midway("controller.position.y", ramp=0.2e-3),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
    row(
        "one spike of 0.5 mm",
        DONE,
        midway("controller.position.x", offset=0.5e-3, duration=1e-3),
        truth=BESIDE,
        most=0.15e-3,
        why="50 um of stick-slip, and the lag of feed and reversal on both axes",
        changes=WHOLE,
    ),
    row(
        "encoder y 0.16 m off before the start",
        "Stroke",
        Injection("controller.position.y", 0.0, offset=0.16),
        most=0.0,
        why="detected in the first sample of the cycle: nothing moves",
    ),
    row(
        "encoder x 80 um off, 60 um allowed",
        "PositionError",
        midway("controller.position.x", offset=80e-6),
        truth=BESIDE,
        most=0.13e-3,
        why="80 um, and 50 um of stick-slip",
        changes=("controller.limits.position_error=60e-6",),
    ),
    row(
        "encoder x jumps by 10 mm",
        "PositionJump",
        midway("controller.position.x", offset=10e-3),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
    row("encoder z is not a number", "PositionLost", midway("controller.position.z", value=float("nan"))),
    row(
        "a fifth of the position samples lost", DONE, midway("controller.position.x", drop=0.2), changes=WHOLE
    ),
    row(
        "encoder x 20 ms late",
        "FollowingError",
        midway("controller.position.x", late=20),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
)

DRIVES = (
    row(
        "pulses z with the wrong sign",
        "DriveSign",
        Injection("plant.pulses_z", 0.0, scale=-1.0),
        most=0.0,
        why="away from the mold",
    ),
    row(
        "pulses y with the wrong sign",
        "DriveSign",
        Injection("plant.pulses_y", 0.0, scale=-1.0),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
    row(
        "drive z at 0.3",
        "WeakDrive",
        Injection("plant.pulses_z", 0.0, scale=0.3),
        most=0.0,
        why="still above the mold",
    ),
    row(
        "drive x at 0.3",
        "WeakDrive",
        midway("plant.pulses_x", scale=0.3),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
    row(
        "pulses z lost",
        "PositionFrozen",
        Injection("plant.pulses_z", 0.0, value=0.0),
        most=0.0,
        why="the axis is at rest",
    ),
    row(
        "pulses x lost on the path",
        "PositionFrozen FollowingError",
        midway("plant.pulses_x", value=0.0),
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
    ),
    row(
        "drive z moves down at 5 mm/s",
        "DriveSign",
        midway("plant.pulses_z", value=-5.0),
        most=32.0,
        why="`expert.limits.following_error` at 178 N/mm, 5 N, and 8 kg with 5 mm/s: 6 N",
    ),
    row(
        "drive x moves away at 20 mm/s",
        "DriveSign FollowingError",
        midway("plant.pulses_x", value=20.0),
        truth=BESIDE,
        most=2.05e-3,
        why="`expert.limits.following_error`, 50 um of stick-slip, and 1.9 mm that 31 kg coast from 20 mm/s",
    ),
    # during the retract the axis rests for 20 ms, like a weak drive
    row(
        "pulses of z 20 ms late",
        "Oscillation WeakDrive",
        midway("plant.pulses_z", late=20),
        most=7.5,
        why="5 N and an oscillation of twice `expert.limits.force_error`",
        changes=WHOLE,
        sequence=True,
    ),
)

REST = (
    row(
        "stiffness configured as a third",
        "WrongStiffness UnstableLoop",
        changes=("controller.stiffness.nominal=55e3",),
    ),
    row(
        "pulses configured twice as large",
        "WeakDrive",
        changes=("controller.pulses.size=2e-6",),
        most=0.0,
        why="still above the mold",
    ),
    row(
        "stiffness configured as half, damping for a loop three times as fast",
        "UnstableLoop",
        changes=(
            "controller.stiffness.nominal=90e3",
            "controller.expert.impedance.adaptive=false",
            "controller.impedance.damping=1e3",
        ),
    ),
    row(
        "mold sinks by 0.1 mm in half a second, 50 um allowed",
        "SurfaceError",
        signals=(Signal("plant.mold_lift", SINKING, tuple(-1e-5 * step for step in range(len(SINKING)))),),
        changes=("controller.limits.surface_error=5e-5",),
    ),
    row(
        "settling longer than its limit",
        "SettleTimeout",
        changes=("controller.expert.settle.time_max=0.05",),
    ),
    row(
        "sensor of 25.5 N with an offset of 1.5 N, and a step of the mold",
        "Saturation",
        Injection("controller.force.z", 0.0, offset=1.5),
        signals=(Signal("plant.mold_lift", (0.0, 1.5), (0.0, 1.5e-4)),),
        changes=("controller.sensor.range=25.5",),
        most=32.0,
        why="the step of 0.15 mm at 178 N/mm, and 5 N",
    ),
    row(
        "mold 0.6 mm off",
        "ForceError",
        changes=("plant.shift_x=6e-4",),
        most=9.0,
        why="5 N, and a ramp to 3.5 N that is a fifth of 5 N root mean square over 0.2 s",
    ),
    row(
        "another mold",
        "ForceError",
        changes=("plant.mold='saddle'", "controller.feed.velocity=0.002", "loop.duration=10.0"),
        most=9.0,
        why="5 N, and a ramp to 3.5 N that is a fifth of 5 N root mean square over 0.2 s",
    ),
    row(
        "mold suddenly 0.3 mm lower",
        "ContactLost",
        signals=(Signal("plant.mold_lift", (0.0, 1.5), (0.0, -3e-4)),),
    ),
    row(
        "restart in mid-run",
        "NotAtStart",
        signals=(Signal("controller.enable", (0.0, 0.01, 1.5, 2.2), (False, True, False, True)),),
        changes=("loop.duration=2.5",),
    ),
    row(
        "estop on the path", "EmergencyStop", signals=(Signal("controller.estop", (0.0, 1.5), (False, True)),)
    ),
    row(
        "feed stopped permanently",
        "NoProgress",
        Injection("controller.feed_override", 1.2, value=0.0),
        changes=("controller.limits.cycle_time=1.6",),
    ),
    row("override is not a number", "InvalidInput", midway("controller.feed_override", value=float("nan"))),
    row(
        "zero of the force sensor 5 N off",
        "TareRejected",
        Injection("controller.force.z", 0.0, offset=5.0),
        most=0.0,
        why="nothing moves yet",
    ),
    row(
        "communication step of two samples",
        "LongStep",
        changes=("loop.step=2e-3", "loop.substeps=20"),
        most=0.0,
        why="detected in the first sample of the cycle: nothing moves",
    ),
    row(
        "a tip that bends more than the sweep is long",
        "NoSliding",
        changes=(
            "plant.tip_lateral=0.08",
            "plant.friction=0.4",
            "controller.feed.velocity=0.002",
            "loop.duration=4.1",
        ),
    ),
    row(
        "a ball that sticks on a circle, so that only the tip bends",
        "NoSliding",
        changes=(
            *ROUND,
            "plant.tip_lateral=0.08",
            "plant.friction=0.4",
            "controller.feed.velocity=0.002",
            "loop.duration=4.1",
        ),
        most=6.0,
        why="5 N and the ripple of the control law at the largest K_v",
    ),
    row(
        "a circle, the force across the tip with the wrong sign",
        "NoSliding",
        Injection("controller.force.y", 0.0, scale=-1.0),
        Injection("controller.force.x", 0.0, scale=-1.0),
        changes=(*ROUND, *WHOLE),
        most=6.0,
        why="5 N and the ripple of the control law at the largest K_v",
    ),
    row(
        "drives of 20 N for a circle that needs 300 N",
        "WeakDrive",
        truth=BESIDE,
        most=0.74e-3,
        why=COAST,
        changes=(*ROUND, "plant.drive_force=20.0", "controller.stick_slip.velocity=0.02"),
    ),
    row(
        "emergency stop during the retract",
        "ForceLimit EmergencyStop",
        signals=(
            Signal("plant.mold_lift", (0.0, 1.5), (0.0, 1.5e-4)),
            Signal("controller.estop", (0.0, 1.52), (False, True)),
        ),
        most=32.0,
        why="the step of 0.15 mm at 178 N/mm, and 5 N",
        sequence=True,
    ),
    row(
        "encoder frozen during the retract",
        "ForceLimit PositionFrozen",
        Injection("controller.position.z", when='controller.state == "Fault"', frozen=True),
        signals=(Signal("plant.mold_lift", (0.0, 1.5), (0.0, 1.5e-4)),),
        most=32.0,
        why="the step of 0.15 mm at 178 N/mm, and 5 N",
        sequence=True,
    ),
    row(
        "override lost during the retract",
        "ContactLost",
        Injection("controller.feed_override", when='controller.state == "Fault"', value=float("nan")),
        signals=(Signal("plant.mold_lift", (0.0, 1.5), (0.0, -3e-4)),),
        sequence=True,
    ),
    row(
        "enable false and true again on the path",
        "NotAtStart",
        signals=(
            Signal(
                "controller.enable",
                (0.0, 0.01, 1.5, 1.52, 1.9, 1.95),
                (False, True, False, True, False, True),
            ),
        ),
        changes=("loop.duration=2.5",),
    ),
    row(
        "encoder lost during the retract",
        "ForceLimit PositionLost",
        Injection("controller.position.x", when='controller.state == "Fault"', value=float("nan")),
        signals=(Signal("plant.mold_lift", (0.0, 1.5), (0.0, 1.5e-4)),),
        most=32.0,
        why="the step of 0.15 mm at 178 N/mm, and 5 N",
        sequence=True,
    ),
)

MATRIX = Matrix(
    scenario="polish",
    seed=71_301,
    good="last(controller.done) & (max(plant.contact_force) < 6.5)",
    rest=(
        "max(hypot(hypot(diff(plant.axis_x), diff(plant.axis_y)), diff(plant.axis_z))"
        "[time > last(time) - 0.05]) < 1e-6"
    ),
    rows=(*SENSOR, *ENCODERS, *DRIVES, *REST, *commission.ROWS),
    stop="time > 1e3",
)
