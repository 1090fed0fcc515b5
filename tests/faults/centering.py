"""Simulated faults of `centering`: encoders, drive, machine and operator, and the response to each.

The excursion is that of the ring: its largest distance from the axis beyond the smallest one so far. A push
moves towards the axis, so the excursion is small as long as nothing is pushed by mistake.
"""

from __future__ import annotations

from dataclasses import replace

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from .commission import centering as commission
from .matrix import DONE, Matrix, Row

# 45 rpm and the largest plant step: short runs
FAST = ("plant.spindle_speed=4.71238898038469", "plant.timestep=2e-4", "loop.substeps=5")
OUTWARDS = "max(plant.eccentricity - cummin(plant.eccentricity))"
PROBE, SLIDE, SPINDLE = (
    f"controller.{name}" for name in ("probe_position", "slide_position", "spindle_angle")
)
POSITION, VELOCITY = "plant.slide_position_setpoint", "plant.slide_velocity_setpoint"
IN_COLLECT, IN_PUSH = "controller.state == 'Collect'", "controller.state == 'Push'"
AFTER_A_PUSH = f"controller.push.count > 0 and {IN_COLLECT}"
SPEED, AT_REST = "plant.spindle_speed_setpoint", ("plant.spindle_speed=0.0",)
TOUCHED = "controller.probe_position > 1.1e-3"
PAPER = ('controller.law="Paper"',)
KEPT = 5e-6, "force of the probe: no fault drives the ring outwards"

FED_BACK = 3.6e-4, "feedback of the surface: 3 mm/s for the 0.12 s of the contact"


def row(name: str, faults: str, *inject: Injection, within: tuple[float, str] = KEPT, **more: object) -> Row:
    """Row of the fast machine; `faults` by spaces."""
    limit, why = within
    changes = (*FAST, *more.pop("changes", ()))  # type: ignore[misc]
    return Row(name, tuple(faults.split()), OUTWARDS, limit, why, inject, changes=changes, **more)  # type: ignore[arg-type]


def turned(name: str, faults: str, *inject: Injection, **more: object) -> Row:
    """Row of a machine whose table the controller turns, from rest."""
    return row(name, faults, *inject, scenario="centering/spindle", **{"changes": AT_REST, **more})  # type: ignore[arg-type]


def collecting(to: str, **kind: object) -> Injection:
    """Injection from 0.2 s after the first collection on."""
    return Injection(to, when=IN_COLLECT, **{"after": 0.2, **kind})  # type: ignore[arg-type]


def pushing(to: str, **kind: object) -> Injection:
    """Injection from the first push on."""
    return Injection(to, when=IN_PUSH, **{"after": 0.05, **kind})  # type: ignore[arg-type]


def both(**kind: object) -> tuple[Injection, Injection]:
    """Injection into position and velocity of the drive, from the approach on."""
    at = Injection(POSITION, from_time=0.0, **kind)  # type: ignore[arg-type]
    return at, replace(at, to=VELOCITY)


MATRIX = Matrix(
    scenario="centering",
    seed=90_417,
    good="last(controller.centered) & (last(plant.eccentricity) < 3e-6)",
    rest="abs(last(plant.slide_velocity)) < 1e-3",
    stop=(
        "(controller.centered and time > controller.time_to_center + 0.05) or "
        "(controller.state == 'Fault' and abs(plant.slide_velocity) < 5e-4 and "
        "(not controller.drive_enable or controller.slide.position_setpoint < 1e-4))"
    ),
    rows=(
        row("probe frozen at rest", "ProbeFrozen", collecting(PROBE, frozen=True)),
        row(
            "probe frozen with a flickering last bit", "ProbeFrozen",
            collecting(PROBE, frozen=True), collecting(PROBE, noise=2e-8),
        ),
        row("dead probe in the approach", "NoPart", Injection(PROBE, from_time=0.0, value=0.0)),
        row("probe frozen in a push", "ProbeFrozen", pushing(PROBE, frozen=True)),
        row("coarse probe frozen", "ProbeFrozen", collecting(PROBE, frozen=True),
            changes=("plant.probe_resolution=1e-6",)),
        row("probe jumps by 5 mm permanently", "ProbeJump", collecting(PROBE, offset=5e-3)),
        row("coarse probe frozen as it touches the ring", "ProbeFrozen",
            Injection(PROBE, when=TOUCHED, frozen=True), changes=("plant.probe_resolution=5e-6",)),
        row("probe frozen with a tolerance of 0.1 mm", "ProbeFrozen", collecting(PROBE, frozen=True),
            changes=("controller.tolerance=1e-4",)),
        row("probe off by -0.2 mm before there is a model", DONE,
            Injection(PROBE, when=TOUCHED, offset=-2e-4),
            within=(2e-4, "a push beyond the axis by the error of the probe")),
        row("probe off by 0.2 mm while waiting for the first push", DONE,
            Injection(PROBE, when="controller.state == 'Wait'", after=0.02, offset=2e-4),
            within=(2e-4, "a push beyond the axis by the error of the probe")),
        row("probe jumps by 1 mm in a push", "ProbeJump", pushing(PROBE, offset=1e-3), within=FED_BACK),
        row("probe jumps by -1 mm in a push", "ProbeJump", pushing(PROBE, offset=-1e-3), within=FED_BACK),
        row("probe off by -0.8 mm after a push", "ProbeJump",
            Injection(PROBE, when=AFTER_A_PUSH, after=0.1, offset=-8e-4)),
        row("first sample of probe, slide and spindle wrong by 5 mm, 10 mm and 1 rad", DONE,
            *(Injection(to, from_time=0.0, offset=off, duration=1e-3)
              for to, off in ((PROBE, 5e-3), (SLIDE, 0.01), (SPINDLE, 1.0)))),
        row("noise of 50 mrad on the spindle encoder", "SpindleUneven",
            Injection(SPINDLE, from_time=0.0, noise=0.05)),
        row("a cycle longer than allowed", "NoProgress",
            changes=("controller.limits.cycle_time=2.0",)),
        row("a tolerance of 10 nm", "Unresolved", changes=("controller.tolerance=1e-8",)),
        row("one push allowed", "PushBudget", changes=("controller.limits.pushes=1",)),
        row("servo of 12 Hz, measured", "SlowServo",
            changes=("plant.servo_bandwidth=12", "controller.learn.servo=true")),
        row("communication step of two samples", "LongStep", changes=("loop.step=2e-3", "loop.substeps=10")),
        row("one spike of 5 mm", DONE, collecting(PROBE, offset=5e-3, duration=1e-3)),
        row("one spike of 0.5 mm", DONE, collecting(PROBE, offset=5e-4, duration=1e-3)),
        row("one spike of 5 mm in the approach", DONE,
            Injection(PROBE, from_time=0.1, offset=5e-3, duration=1e-3)),
        row("spikes of 20 um on a fifth of the samples", DONE,
            changes=("plant.spike_height=2e-5", "plant.spike_fraction=0.2")),
        row("probe drifts by 1 um/s", DONE, collecting(PROBE, ramp=1e-6)),
        row("probe noise x 20", DONE, collecting(PROBE, noise=6e-7)),
        row("a fifth of the probe's samples is lost", DONE, collecting(PROBE, drop=0.2)),
        row("probe free for 50 ms", DONE, collecting(PROBE, value=0.0, duration=0.05)),
        row("probe free permanently", "NoPart", collecting(PROBE, value=0.0)),
        row("probe free permanently in a push", "NoPart", pushing(PROBE, value=0.0)),
        row("probe saturated", "ProbeJump", collecting(PROBE, value=0.0249)),
        row("probe scaled by 0.7", "ProbeFrozen",
            Injection(PROBE, from_time=0.0, scale=0.7)),
        row("probe 5 steps late", DONE, collecting(PROBE, late=5)),
        row("probe a step late from the start", "ProbeDelayed", Injection(PROBE, from_time=0.0, late=1)),
        row("probe 5 steps late from the start", "ProbeDelayed", Injection(PROBE, from_time=0.0, late=5)),
        row("probe 10 steps late from the start", "ProbeDelayed Divergence",
            Injection(PROBE, from_time=0.0, late=10)),
        row("probe 20 steps late from the start", "ProbeDelayed", Injection(PROBE, from_time=0.0, late=20)),
        row("slide 3 steps late from the start", "PositionDelayed", Injection(SLIDE, from_time=0.0, late=3)),
        row("slide 5 steps late from the start", "PositionDelayed", Injection(SLIDE, from_time=0.0, late=5)),
        row("pusher 1 mm longer than configured", "EarlyContact", changes=("plant.probe_at_pusher=0.019",),
            within=(1.7e-3, "hit at 1.6 times 41 mm/s and braked by 1 m/s2, minus the initial 0.5 mm")),
        row("pusher 3 mm longer than configured", "EarlyContact", changes=("plant.probe_at_pusher=0.017",),
            within=(1.9e-2, "hit at 1.6 times the 0.12 m/s of the slide and braked by 1 m/s2")),
        row("probe free for 50 ms in a push", DONE, pushing(PROBE, value=0.0, duration=0.05)),
        row("probe is NaN for one sample", DONE,
            collecting(PROBE, value=float("nan"), duration=1e-3)),
        row("probe is NaN for 0.3 s", "ProbeLost",
            collecting(PROBE, value=float("nan"), duration=0.3)),
        row("probe is NaN", "ProbeLost", collecting(PROBE, value=float("nan"))),
        row("slide encoder frozen in the approach", "PositionFrozen",
            Injection(SLIDE, from_time=0.1, frozen=True)),
        row("slide encoder frozen at rest", "PositionFrozen", collecting(SLIDE, frozen=True)),
        row("slide encoder frozen in a push", "PositionFrozen", pushing(SLIDE, frozen=True)),
        row("slide encoder jumps by 10 mm permanently", "PositionJump", collecting(SLIDE, offset=0.01)),
        row("one spike of the slide encoder", DONE, collecting(SLIDE, offset=0.01, duration=1e-3)),
        row("slide noise x 20", DONE, collecting(SLIDE, noise=4e-7)),
        row("slide is NaN for one sample in a push", DONE,
            pushing(SLIDE, value=float("nan"), duration=1e-3)),
        row("slide is NaN in a push", "PositionLost", pushing(SLIDE, value=float("nan"))),
        row("spindle encoder frozen", "SpindleFrozen", collecting(SPINDLE, frozen=True)),
        row("spindle is NaN", "SpindleLost", collecting(SPINDLE, value=float("nan"))),
        row("spindle jumps by 1 rad permanently", "SpindleJump", collecting(SPINDLE, offset=1.0)),
        row("one spike of the spindle", DONE, collecting(SPINDLE, offset=1.0, duration=1e-3)),
        row("a fifth of the spindle's samples is lost", DONE, collecting(SPINDLE, drop=0.2)),
        row("spindle 5 steps late", DONE, collecting(SPINDLE, late=5)),
        row("spindle at rest", "SpindleFrozen", changes=("plant.spindle_speed=0.0",)),
        turned("commanded table follows", DONE),
        turned("commanded table is at rest", "SpindleFrozen", Injection(SPEED, from_time=0.0, value=0.0)),
        turned("commanded table at half its speed", "SpindleSpeed",
            Injection(SPEED, from_time=0.0, scale=0.5)),
        turned("sign of the spindle drive reversed", "SpindleSpeed",
            Injection(SPEED, from_time=0.0, scale=-1.0)),
        turned("commanded table reaches its speed in 5 s", "SpindleSpeed",
            changes=(*AT_REST, "plant.spindle_acceleration=2.0")),
        turned("commanded table slows down by a third", "SpindleSpeed",
            Injection(SPEED, when=AFTER_A_PUSH, after=0.1, scale=0.67)),
        turned("commanded table oscillates by 2 %", DONE, changes=(*AT_REST, "plant.spindle_ripple=0.02")),
        row("sign of the drive reversed", "DriveSign", *both(scale=-1.0)),
        row("drive gain of a third", "WeakDrive", *both(scale=0.3)),
        row("drive gain of nine tenths", "FollowingError", *both(scale=0.9)),
        row("drive lost in the approach", "FollowingError",
            Injection("plant.enable", from_time=0.1, value=0.0)),
        row("drive lost in a push", "FollowingError",
            pushing("plant.enable", value=0.0)),
        row("setpoint stuck", "FollowingError",
            Injection(POSITION, from_time=0.2, frozen=True), Injection(VELOCITY, from_time=0.2, value=0.0)),
        row("setpoint 0.2 mm below the command", "FollowingError", collecting(POSITION, offset=-2e-4)),
        row("position setpoint at 0.99 of the command", "FollowingError",
            Injection(POSITION, from_time=0.0, scale=0.99)),
        row("drive of 10 N", "WeakDrive", changes=("plant.servo_force=10",)),
        row("servo of 28 Hz configured as 40 Hz", DONE, changes=("plant.servo_bandwidth=28",)),
        row("delay of 3 samples configured as 1", DONE, *both(late=2),
            within=(2.4e-4, "a push that ends 2 samples late at the 0.12 m/s of the slide")),
        row("radius configured 20 % too large", DONE, changes=("controller.ring.radius=0.06",)),
        row("roughness of 1 um configured as 0.1 um", DONE,
            changes=("plant.roughness=1e-6",)),
        row("position setpoint 10 samples late, velocity in time", "FollowingError",
            Injection(POSITION, from_time=0.0, late=10),
            within=(1.2e-3, "10 samples at the 0.12 m/s of the slide")),
        row("spindle encoder scaled by 1.1", DONE, Injection(SPINDLE, from_time=0.0, scale=1.1),
            within=(5e-5, "a tenth of the 0.5 mm of the first push")),
        row("probe drifts by 0.1 mm/s", "ProbeJump", collecting(PROBE, ramp=1e-4),
            within=(2e-4, "a push beyond the axis by the drift of the 2 s until detection")),
        row("probe off by 50 um after a push", DONE,
            Injection(PROBE, when=AFTER_A_PUSH, after=0.1, offset=5e-5),
            within=(7.5e-5, "a push beyond the axis by the error of the probe, and its overshoot")),
        row("radius configured as 1 mm, ring 1.5 mm off", "RingTooSmall",
            changes=("controller.ring.radius=1e-3", "controller.ring.eccentricity_max=9e-4",
                     "plant.eccentricity=1.5e-3")),
        row("ring 3 mm off at 130 rpm", "Centrifugal",
            changes=("plant.spindle_speed=13.6", "plant.eccentricity=3e-3")),
        row("pusher 6 mm farther back than configured", "ProbeRange",
            changes=("plant.probe_at_pusher=0.026", "plant.probe_stroke=0.03")),
        row("ring 10 mm off at 45 rpm, `law = Paper`", "Divergence",
            changes=(*PAPER, "plant.eccentricity=0.01"),
            within=(5e-3, "a push sideways, 2.5 mm of `expert.push.critical_distance`, and 2.5 mm more")),
        row("oval by 0.1 mm configured as 2 um", DONE, changes=("plant.lobe_2=1e-4",),
            within=(1e-4, "a push beyond the axis by the form outside the model")),
        row("ring of 20 kg", DONE, changes=("plant.mass=20",),
            within=(1.2e-4, "the largest overshoot of heavy rings")),
        row("enable falls and rises in a push", DONE, signals=(
            Signal("controller.enable", (0.0, 0.01, 1.9, 1.95), (False, True, False, True)),)),
        row("slide encoder lost during the retract of another fault", "ProbeLost PositionLost",
            collecting(PROBE, value=float("nan")), collecting(SLIDE, value=float("nan"), after=0.25),
            sequence=True),
        row("drive lost during the retract of another fault", "ProbeLost FollowingError",
            collecting(PROBE, value=float("nan")),
            Injection("plant.enable", when="controller.state == 'Fault'", after=0.05, value=0.0),
            sequence=True),
        row("probe frozen at rest, `law = Paper`", "ProbeFrozen",
            collecting(PROBE, frozen=True), changes=PAPER),
        row("probe scaled by 0.7, `law = Paper`", "ProbeFrozen",
            Injection(PROBE, from_time=0.0, scale=0.7), changes=PAPER,
            within=(6.1e-3, "1 mm unanswered, to 69 mm/s with the ring; a ring hit at 1.6 times that")),
        row("probe off by -0.2 mm after a push, `law = Paper`", "ProbeJump",
            Injection(PROBE, when=AFTER_A_PUSH, after=0.1, offset=-2e-4), changes=PAPER),
        row("probe free for good, `law = Paper`", "NoPart", collecting(PROBE, value=0.0), changes=PAPER),
        row("slide encoder frozen in a push of less than 1 mm, `law = Paper`", "ProbeJump PositionFrozen",
            pushing(SLIDE, frozen=True), changes=PAPER, sequence=True),
        row("drive does a third, `law = Paper`", "WeakDrive", *both(scale=0.3), changes=PAPER),
        row("spindle encoder frozen, `law = Paper`", "SpindleFrozen",
            collecting(SPINDLE, frozen=True), changes=PAPER),
        *commission.ROWS,
    ),
)  # fmt: skip
