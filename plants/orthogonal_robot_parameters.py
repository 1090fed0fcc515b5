"""Parameters of the orthogonal robot, its tip, force sensor and mold, each with unit, range and source."""

import math
from dataclasses import dataclass
from typing import Literal

from plants.base.parameters import ParameterError, choice, parameter

TURN = 2.0 * math.pi
IMPEDANCE = 0.95
"""Constraint impedance at which a sliding ball is lifted by mu v c / k: see `contact_impedance`."""
CONTACT_SHARE = 0.6
"""Largest contact stiffness, over what the contact damping allows in a plant step: see `_check_contact`."""
SERVO = "default; usual AC servo"


@dataclass(frozen=True)
class OrthogonalRobotParameters:
    """Parameters of the machine."""

    timestep: float = parameter(1e-4, "s", "Plant step", 1e-6, 1e-4, "derived: longer ones hop")

    # axes
    start_x: float = parameter(50e-6, "m", "Center of the ball at the start", -0.2, 0.2)
    start_y: float = parameter(0.0, "m", "Center of the ball at the start", -0.15, 0.15)
    start_z: float = parameter(
        0.7e-3, "m", "Center of the ball at the start", -0.05, 0.05, "default; 0.2 mm above the mold"
    )
    stroke_x: float = parameter(0.4, "m", "Stroke, with the mold in its middle", 0.01, 2.0, "paper")
    stroke_y: float = parameter(0.3, "m", "Stroke, with the mold in its middle", 0.01, 2.0, "paper")
    stroke_z: float = parameter(0.1, "m", "Stroke, with the mold in its middle", 0.01, 2.0, "paper")
    mass_x: float = parameter(12.0, "kg", "Carriage of the x axis alone", 0.1, 1e3)
    mass_y: float = parameter(8.0, "kg", "Carriage of the y axis alone", 0.1, 1e3)
    mass_z: float = parameter(5.0, "kg", "Carriage of the z axis alone, balanced", 0.1, 1e3)
    screw_mass: float = parameter(3.0, "kg", "Screw and motor of each axis, as a mass on it", 0.0, 1e3)
    drive_friction: float = parameter(2.0, "N", "Friction of each axis", 0.0, 1e2)
    drive_rolling_way: float = parameter(
        20e-6, "m", "Travel after a reversal in which the friction reverses, 0 for dry friction", 0.0, 1e-3,
        "default; balls roll freely after 0.1 mm (Futami, Furutani and Yoshida 1991)",
    )  # fmt: skip
    drive_damping: float = parameter(100.0, "N.s/m", "Viscous friction of each axis", 0.0, 1e5)
    drive_gain: float = parameter(
        0.95,
        "1",
        "Gain of position and velocity loop over the nominal one",
        0.1,
        10.0,
        "default; 5 % below nominal",
    )
    position_gain: float = parameter(80.0, "1/s", "Position loop", 1.0, 1e3, SERVO)
    velocity_bandwidth: float = parameter(500.0, "rad/s", "Velocity loop", 10.0, 5e3, SERVO)
    velocity_integral: float = parameter(60.0, "1/s", "Integral of the velocity loop", 0.0, 1e3, SERVO)
    feedforward: float = parameter(
        0.8, "1", "Fraction of the commanded velocity that is fed forward", 0.0, 1.0
    )
    feedforward_bandwidth: float = parameter(
        100.0, "Hz", "Bandwidth of the velocity feedforward", 1.0, 5e3, SERVO
    )
    drive_force: float = parameter(400.0, "N", "Largest force of each drive", 1.0, 1e5)
    pulse: float = parameter(1e-6, "m", "Travel per pulse", 1e-9, 1e-4, "paper")
    pulse_period: float = parameter(
        1e-3, "s", "Time over which the pulses of a command are spread", 1e-5, 1.0, "paper"
    )
    encoder_resolution: float = parameter(1e-6, "m", "Step of the encoders", 0.0, 1e-3, "paper")

    # tip, contact and force sensor
    ball_radius: float = parameter(0.5e-3, "m", "Radius of the ball of wood", 1e-4, 5e-3, "paper")
    tip_mass: float = parameter(0.010, "kg", "Mass below the force sensor", 1e-3, 1.0)
    tip_stiffness: float = parameter(
        209e3, "N/m", "Stiffness of tip and sensor", 1e4, 4e5,
        "derived: the paper's 178 N/mm with the contact in series",
    )  # fmt: skip
    tip_lateral: float = parameter(
        1.0, "1", "Stiffness of the tip across its axis over that along it", 0.02, 2.0
    )
    tip_damping: float = parameter(0.1, "1", "Damping ratio of the free tip", 0.0, 2.0)
    contact_stiffness: float = parameter(
        1.2e6, "N/m", "Stiffness of ball on mold", 1e5, 1e8, "default; stiffer ones hop"
    )
    contact_damping: float = parameter(
        500.0, "N.s/m", "Damping of ball on mold", 0.0, 1e6,
        "derived: less hops on stiff tips; MuJoCo lifts a sliding ball by mu v c / k, 0.8 um at 10 mm/s",
    )  # fmt: skip
    contact_impedance: float = parameter(
        IMPEDANCE, "1", "MuJoCo's constraint impedance of that contact", 0.2, 0.99,
        "default; at 0.5 it lifts a nineteenth as far, and a tip that breaks loose keeps its load",
    )  # fmt: skip
    friction: float = parameter(0.2, "1", "Friction coefficient of ball on mold", 0.0, 2.0)
    friction_ratio: float = parameter(
        1.0,
        "1",
        "Static over kinetic friction of ball on mold",
        1.0,
        5.0,
        "default; none, wood on steel has 1.2",
    )
    stribeck_speed: float = parameter(1e-3, "m/s", "Slip speed of the Stribeck curve", 1e-5, 1.0)
    sensor_turn: float = parameter(
        0.0, "rad", "Mounting angle of the force sensor about the tip", -math.pi, math.pi
    )
    force_bandwidth: float = parameter(200.0, "Hz", "Filter of the force sensor", 1.0, 5e3)
    force_noise: float = parameter(
        0.05, "N", "Standard deviation of the noise of the force sensor", 0.0, 10.0
    )
    force_resolution: float = parameter(
        0.178, "N", "Step of the force sensor", 0.0, 10.0, "paper: 1 um at 178 N/mm"
    )

    # mold
    mold: Literal["sphere", "led", "saddle", "freeform", "steep"] = choice(
        "led",
        "Surface, a name of `plants.tools.molds`",
        ("sphere", "led", "saddle", "freeform", "steep"),
        "paper",
    )
    mold_radius: float = parameter(
        2e-3, "m", "Radius at which the surface ends", 1e-4, 2.2e-3, "paper: 4 mm wide"
    )
    shift_x: float = parameter(0.0, "m", "Misplacement of the mold", -1e-3, 1e-3, "default; none")
    shift_y: float = parameter(0.0, "m", "Misplacement of the mold", -1e-3, 1e-3, "default; none")
    shift_z: float = parameter(0.0, "m", "Misplacement of the mold", -1e-3, 1e-3, "default; none")
    tilt_x: float = parameter(0.0, "rad", "Rotation vector of the mold", -0.2, 0.2, "default; none")
    tilt_y: float = parameter(0.0, "rad", "Rotation vector of the mold", -0.2, 0.2, "default; none")
    tilt_z: float = parameter(0.0, "rad", "Rotation vector of the mold", -0.2, 0.2, "default; none")
    lift_rate: float = parameter(0.02, "m/s", "Speed at which the mold follows `mold_lift`", 1e-4, 1.0)
    step_height: float = parameter(0.0, "m", "Height of a step in the surface", -2e-4, 2e-4, "default; none")
    step_place: float = parameter(0.5e-3, "m", "Start of the step along x", -2e-3, 2e-3)
    step_width: float = parameter(0.5e-3, "m", "Length of the rise of the step", 1e-4, 2e-3)


def check_together(p: OrthogonalRobotParameters) -> None:
    """Check combinations of parameters.

    Raises
    ------
    ParameterError
        The ball does not reach the bottom of a step, or the contact hops or oscillates at this plant step.
    """
    _check_contact(p)
    _check_impedance(p)
    # largest curvature of a quintic rise: 10 / sqrt(3)
    curvature = 10.0 / math.sqrt(3.0) * abs(p.step_height) / p.step_width**2
    if curvature * p.ball_radius >= 0.5:
        limit = math.sqrt(20.0 / math.sqrt(3.0) * abs(p.step_height) * p.ball_radius)
        raise ParameterError(
            f"parameter `plant.step_width` of plant `orthogonal_robot`: value `{p.step_width:g}` m, "
            f"limit `{limit:g}` m at `step_height` = `{p.step_height:g}` m\n"
            "hint: Increase it: the ball must fit into the foot of the step."
        )


def _check_contact(p: OrthogonalRobotParameters) -> None:
    """Reject a contact on which the ball hops permanently, since the force of one plant step is then useless.

    A ball that moves down at the speed v is up to v h deep when a step h first detects the contact. The
    spring k adds up to k (v h)^2 / 2 of energy, and the damper c removes c v^2 h in that step:
    so k h / c has a limit below 2. Measured with 5 N, tips of 10 g with 209 and 400 N/mm, and c from 150 to
    1500 N.s/m: at 0.6 none hops, at 0.7 some do.

    Raises
    ------
    ParameterError
        `contact_stiffness` is above its limit.
    """
    limit = CONTACT_SHARE * p.contact_damping / p.timestep
    if p.contact_stiffness > limit:
        raise ParameterError(
            f"parameter `plant.contact_stiffness` of plant `orthogonal_robot`: "
            f"value `{p.contact_stiffness:g}` N/m, limit `{limit:g}` N/m at "
            f"`contact_damping` = `{p.contact_damping:g}` N.s/m and `timestep` = `{p.timestep:g}` s\n"
            "hint: Reduce `timestep` and increase `loop.substeps`, or increase the damping: the ball hops."
        )


def _check_impedance(p: OrthogonalRobotParameters) -> None:
    """Reject a contact that oscillates from step to step.

    With the impedance d a contact has the effective mass m / (1 - d). Its damper c acts for a whole plant
    step h on the initial speed and leaves 1 - h c (1 - d) / m of it: below 0 the speed changes its sign,
    below -1 it grows.

    Raises
    ------
    ParameterError
        `contact_impedance` is below its limit.
    """
    limit = 1.0 - p.tip_mass / (p.contact_damping * p.timestep) if p.contact_damping > 0.0 else 0.0
    if p.contact_impedance < limit:
        raise ParameterError(
            f"parameter `plant.contact_impedance` of plant `orthogonal_robot`: "
            f"value `{p.contact_impedance:g}`, limit at least `{limit:g}` at `tip_mass` = `{p.tip_mass:g}` kg"
            f", `contact_damping` = `{p.contact_damping:g}` N.s/m and `timestep` = `{p.timestep:g}` s\n"
            "hint: Reduce `timestep` and increase `loop.substeps`, or increase the impedance, reduce the "
            "damping or use a heavier tip."
        )
