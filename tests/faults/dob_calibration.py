"""Faults of contact detection in a calibration: rows of the matrix in `dob.py`."""

from __future__ import annotations

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

from .matrix import Row

POSITION, CURRENT = "controller.position", "plant.current"
DEEP = "max(maximum(plant.depth, 0.0)[controller.drive_enable])"
"""Travel beyond the first possible touch while the drive is on."""
EXCURSION = (
    "max(abs(plant.position - controller.reference.position)"
    '[controller.drive_enable & (controller.state == "Detect") & (controller.calibrated.touches == 1)])'
)
"""Distance of the slide from its reference in the second touch while the drive is on."""

CALIBRATE = Signal("controller.calibrate", (0.0, 0.01), (False, True))
AT_REST = Signal("controller.enable", (0.0,), (False,))
SECOND = 'controller.state == "Detect" and controller.calibrated.touches == 1'
FAST = (
    "controller.calibration.velocity_min=6e-5", "controller.calibration.velocity_max=2e-4",
    "controller.expert.calibration.touches=2",
    "controller.expert.calibration.touches_max=2",
    "plant.surface_distance=4e-5", "plant.surface_spread=0", "plant.start_spread=0",
    "controller.calibration.position=4e-5",
    "controller.expert.limits.touch_scatter=2e-7", "controller.expert.calibration.std_max=2e-7",
    "loop.duration=9", 'loop.stop_when=controller.state == "Fault"',
)  # fmt: skip
"""Ten touches in 7 s."""
TOUCH = "touches at up to 200 um/s, 0.45 um"


def calibration(
    name: str, faults: tuple[str, ...], truth: str, limit: float, why: str, *changes: str, **kind: object
) -> Row:
    """Row of a calibration cycle: a fault in its second touch, or a wrong configuration."""
    to = str(kind.pop("to", ""))
    inject = (Injection(to, when=SECOND, after=0.02, **kind),) if to else ()  # type: ignore[arg-type]
    return Row(name, faults, truth, limit, why, inject, (CALIBRATE, AT_REST), (*FAST, *changes))


ROWS = (
    calibration(
        "calibration: encoder frozen in a touch",
        ("PositionFrozen",),
        EXCURSION,
        1e-7,
        "8 nm in each of the 6 samples until the fault is detected, at 81 um/s",
        to=POSITION,
        frozen=True,
    ),
    calibration(
        "calibration: encoder jumps by 1 um in a touch",
        ("PositionJump",),
        EXCURSION,
        2e-6,
        "1 um, the error of the encoder",
        to=POSITION,
        offset=1e-6,
    ),
    calibration(
        "calibration: encoder invalid in a touch",
        ("PositionLost",),
        EXCURSION,
        1e-7,
        "8 nm in each of the 6 samples until the fault is detected, at 81 um/s",
        to="controller.position_valid",
        value=0.0,
    ),
    calibration(
        "calibration: current lost in a touch",
        ("WeakDrive", "FollowingError", "Overload"),
        EXCURSION,
        3e-5,
        "drive lost: the residual weight of 0.5 N moves 10.4 kg to `expert.limits.following_error` = 20 um",
        to=CURRENT,
        value=0.0,
    ),
    calibration(
        "calibration: current of the wrong sign in a touch",
        ("DriveSign",),
        EXCURSION,
        3e-5,
        "5 A, 97 N: 9.3 m/s2 until `expert.limits.following_error` = 20 um, and 4 samples more",
        to=CURRENT,
        scale=-1.0,
    ),
    calibration(
        "calibration: current offset of 0.05 A in a touch",
        ("ContactRejected",),
        DEEP,
        6e-7,
        TOUCH,
        to=CURRENT,
        offset=0.05,
    ),
    calibration(
        "calibration: spindle signal lost in a touch",
        ("SpindleJump",),
        DEEP,
        6e-7,
        TOUCH,
        to="controller.spindle_speed",
        value=0.0,
    ),
    calibration(
        "calibration: reference position 1 um too far",
        ("CalibrationRejected",),
        DEEP,
        6e-7,
        TOUCH,
        "controller.calibration.position=4.1e-5",
    ),
    calibration(
        "calibration: reference position 1 um too near",
        ("CalibrationRejected",),
        DEEP,
        6e-7,
        TOUCH,
        "controller.calibration.position=3.9e-5",
    ),
    calibration(
        "calibration: scatter of the touches above its limit",
        ("CalibrationRejected",),
        DEEP,
        6e-7,
        TOUCH,
        "controller.expert.limits.touch_scatter=2e-9",
    ),
    calibration(
        "calibration: workpiece too soft for the detector",
        ("LateContact",),
        DEEP,
        4.2e-5,
        "force guard: 0.4 N on two flutes of 5 N/mm, 40 um, and 1 um to stop",
        "plant.stiffness=5e3",
    ),
    calibration(
        "calibration: no workpiece",
        ("TravelLimit",),
        DEEP,
        1e-9,
        "no workpiece, no depth",
        "plant.workpiece=false",
        "controller.approach.travel_max=1.9e-4",
    ),
    calibration(
        "calibration: travel too short for the fastest touch",
        ("CalibrationRejected",),
        DEEP,
        1e-9,
        "rejected before the stage moves",
        "controller.approach.travel_max=8e-5",
    ),
    calibration(
        "calibration: workpiece 5 um from the start",
        ("LateContact",),
        DEEP,
        3e-6,
        "force guard: 0.4 N on one flute, 2 um, and 1 um to stop",
        "plant.surface_distance=5e-6",
    ),
)
