"""Parameters of the ring on its spindle; see `spindle_ring.py` for the machine."""

import math
from dataclasses import dataclass

from plants.base.parameters import ParameterError, parameter

TURN = 2.0 * math.pi
LINE_LIMIT = 0.95
"""Maximum distance of the ring center from the line of the probe, in radii."""


@dataclass(frozen=True)
class SpindleRingParameters:
    """Parameters of spindle, ring and slide."""

    timestep: float = parameter(1e-4, "s", "Plant step", 1e-6, 2e-4)
    spindle_speed: float = parameter(
        TURN / 3.0, "rad/s", "Initial spindle speed, positive about +z", -20.0, 20.0, "paper: 20 rpm"
    )
    spindle_acceleration: float = parameter(
        30.0, "rad/s2", "Acceleration of the spindle drive", 1e-2, 1e4, "default; 90 rpm in 0.3 s"
    )
    spindle_ripple: float = parameter(
        0.0, "1", "Oscillation of the spindle speed over its mean, amplitude", 0.0, 0.1, "default; none"
    )
    spindle_ripple_order: float = parameter(
        6.0,
        "1",
        "Cycles of the speed oscillation per revolution",
        0.1,
        1e3,
        "default; pole pairs of the motor",
    )
    spindle_error: float = parameter(
        0.0, "m", "Error motion of the axis in x and in y, amplitudes of n = 2 to 5 in all", 0.0, 1e-4
    )
    spindle_error_noise: float = parameter(
        0.0, "m", "Asynchronous error motion in x and in y, standard deviation", 0.0, 1e-4
    )
    spindle_error_time: float = parameter(
        0.05, "s", "Correlation time of the asynchronous error motion", 1e-3, 1e3
    )
    table_radius: float = parameter(0.15, "m", "Radius of the table", 0.01, 1.0)

    part_present: bool = parameter(True, "1", "Whether there is a ring")
    mass: float = parameter(1.0, "kg", "Mass of the ring", 0.1, 200.0, "paper: 0.75 to 1.5 kg")
    radius: float = parameter(0.05, "m", "Mean outer radius of the ring", 0.01, 0.5)
    wall: float = parameter(0.15, "1", "Thickness of the ring over its radius", 0.01, 1.0)
    feet_radius: float = parameter(0.04, "m", "Radius of the three points on which the ring rests", 1e-3, 0.5)
    eccentricity: float = parameter(5e-4, "m", "Initial distance of the ring from the axis", 0.0, 0.1)
    eccentricity_angle: float = parameter(
        0.0, "rad", "Initial direction of the eccentricity, on the table", -TURN, TURN
    )
    eccentricity_angle_spread: float = parameter(
        math.pi,
        "rad",
        "Random part of the initial direction, within +-",
        0.0,
        math.pi,
        "default; any direction",
    )
    lobe_2: float = parameter(2e-6, "m", "Two lobes (oval), amplitude, random phase", 0.0, 1e-3)
    lobe_3: float = parameter(2e-6, "m", "Three lobes, amplitude, random phase", 0.0, 1e-3)
    lobe_5: float = parameter(5e-7, "m", "Five lobes, amplitude, random phase", 0.0, 1e-3)
    roughness: float = parameter(
        1e-7, "m", "Roughness of 15 to 100 waves per revolution, rms, random phases", 0.0, 1e-4
    )

    form: float = parameter(
        0.0, "m", "Form of form_first to form_last waves per revolution, rms, random phases", 0.0, 1e-4,
        "default; none; what chucks and rolls leave",
    )  # fmt: skip
    form_first: float = parameter(
        7.0, "1", "Smallest number of waves of the form, a whole number", 2.0, 100.0
    )
    form_last: float = parameter(14.0, "1", "Largest number of waves of the form, a whole number", 2.0, 100.0)

    mu_static: float = parameter(
        0.2, "1", "Static friction of ring on table", 0.01, 2.0, "paper: 0.15 to 0.25"
    )
    mu_ratio: float = parameter(1.25, "1", "Static over kinetic friction", 1.0, 5.0)
    mu_spread: float = parameter(
        0.0, "1", "Variation of the friction under a foot over the table, amplitude", 0.0, 0.9,
        "default; none; planar friction varies by some ten percent over the position",
    )  # fmt: skip
    mu_patch: float = parameter(
        2e-4, "m", "Period of the friction variation in x and in y", 1e-6, 0.1, "default; shorter than a push"
    )
    stribeck_speed: float = parameter(1e-3, "m/s", "Slip speed of the Stribeck curve", 1e-5, 1.0)
    bristle: bool = parameter(False, "1", "Elasto-plastic bristle instead of MuJoCo's contacts")
    presliding: float = parameter(1e-6, "m", "Bristle: deflection at the static force", 1e-7, 1e-4)
    break_away: float = parameter(0.7, "1", "Bristle: purely elastic fraction of that deflection", 0.1, 0.99)
    bristle_damping: float = parameter(0.2, "1", "Bristle: damping ratio of the ring on it", 0.0, 1.0)

    pusher_stiffness: float = parameter(5e6, "N/m", "Stiffness of the pusher tip", 1e4, 1e8)
    pusher_damping: float = parameter(0.15, "1", "Damping ratio of the ring on the tip", 0.0, 1.0)
    pusher_friction: float = parameter(0.12, "1", "Friction of pusher on ring", 0.0, 1.0)
    probe_at_pusher: float = parameter(
        0.02, "m", "Probe position with the surface at the pusher tip", 0.0, 0.1
    )
    probe_stroke: float = parameter(0.025, "m", "Stroke of the probe", 1e-3, 0.1)
    probe_force_free: float = parameter(0.35, "N", "Gauging force at first touch", 0.0, 10.0)
    probe_force_full: float = parameter(0.7, "N", "Gauging force at full stroke", 0.0, 10.0, "paper")
    probe_friction: float = parameter(
        0.1, "1", "Friction of probe on ring", 0.0, 1.0, "default; ruby on steel"
    )
    probe_resolution: float = parameter(50e-9, "m", "Resolution of the probe", 0.0, 1e-4, "paper")
    probe_noise: float = parameter(30e-9, "m", "Noise of the probe, standard deviation", 0.0, 1e-4, "paper")

    dirt_height: float = parameter(0.0, "m", "Height of the particles that stick to the ring", 0.0, 1e-3)
    dirt_fraction: float = parameter(0.02, "1", "Fraction of the circumference under particles", 0.0, 0.5)
    dirt_width: float = parameter(
        5e-4, "m", "Width of a particle under the probe tip", 1e-4, 0.01,
        "default; 20 um under a ball of 3 mm",
    )  # fmt: skip
    spike_height: float = parameter(0.0, "m", "Electrical spikes on the probe, up or down", 0.0, 1e-3)
    spike_fraction: float = parameter(0.02, "1", "Fraction of the samples with a spike", 0.0, 0.5)

    slide_mass: float = parameter(8.0, "kg", "Moving mass of the slide", 0.5, 200.0)
    servo_bandwidth: float = parameter(
        37.0,
        "Hz",
        "Natural frequency of the slide servo",
        1.0,
        500.0,
        "default; 8 % below the configured value",
    )
    servo_damping: float = parameter(0.7, "1", "Damping ratio of the slide servo", 0.05, 5.0)
    servo_integral_time: float = parameter(
        0.0,
        "s",
        "Integral time of the slide servo, 0: none",
        0.0,
        10.0,
        "default; none; drives have 20 ms up",
    )
    servo_force: float = parameter(400.0, "N", "Largest force of the slide motor", 1.0, 1e5)
    brake_time: float = parameter(
        0.02, "s", "Time constant with which the slide stops without its drive", 1e-3, 1e3,
        "default; shorted windings of a linear motor",
    )  # fmt: skip
    setpoint_period: float = parameter(
        1e-3, "s", "Longest time for which the servo extrapolates a setpoint", 0.0, 1.0, "default; 1 kHz"
    )
    slide_velocity_max: float = parameter(
        0.12, "m/s", "Largest velocity setpoint of the slide", 1e-3, 10.0, "paper"
    )
    slide_resolution: float = parameter(20e-9, "m", "Resolution of the slide encoder", 0.0, 1e-4, "paper")
    travel: float = parameter(0.15, "m", "Travel of the slide from its start", 0.01, 1.0)
    start_distance: float = parameter(
        0.03, "m", "Initial distance from the free probe to the surface of a centered ring", 0.0, 0.5
    )
    angle_resolution: float = parameter(
        TURN / 4000.0, "rad", "Resolution of the spindle encoder", 0.0, 0.1, "paper: 0.09 deg"
    )


def check_together(p: SpindleRingParameters) -> None:
    """Check parameters that limit each other.

    Raises
    ------
    ParameterError
        The first one that does not fit, with name, value, limit and source of the limit.
    """
    pairs = (
        ("feet_radius", "radius", p.feet_radius, p.radius),
        ("probe_at_pusher", "probe_stroke", p.probe_at_pusher, p.probe_stroke),
        ("eccentricity", "start_distance", p.eccentricity, p.start_distance),
        ("eccentricity", "radius", p.eccentricity, LINE_LIMIT * p.radius),
        ("eccentricity", "table_radius", p.eccentricity, p.table_radius - p.feet_radius),
    )
    if p.bristle and p.mu_spread > 0.0:
        raise ParameterError(
            f"parameter `plant.mu_spread` of plant `spindle_ring`: value `{p.mu_spread:g}`, limit `0`\n"
            "hint: only the contacts have it, set `plant.bristle` to false"
        )
    for name in ("form_first", "form_last"):
        if not (value := float(getattr(p, name))).is_integer():
            raise ParameterError(
                f"parameter `plant.{name}` of plant `spindle_ring`: value `{value:g}`, a whole number"
            )
    if p.form_first > p.form_last:
        raise ParameterError(
            f"parameter `plant.form_first` of plant `spindle_ring`: value `{p.form_first:g}`, "
            f"limit `{p.form_last:g}`\nhint: the limit comes from `plant.form_last`"
        )
    for name, bound, value, limit in pairs:
        if value > limit:
            raise ParameterError(
                f"parameter `plant.{name}` of plant `spindle_ring`: value `{value:g}` m, "
                f"limit `{limit:g}` m\nhint: the limit comes from `plant.{bound}`"
            )
