"""Parameters of the ring on its spindle; see `spindle_ring.py` for the machine."""

import math
from dataclasses import dataclass

from plants.base.parameters import ParameterError, parameter

TURN = 2.0 * math.pi
LINE_LIMIT = 0.95
"""Most that the centre of the ring may be beside the line of the probe, in radii."""


@dataclass(frozen=True)
class SpindleRingParameters:
    """Parameters of spindle, ring and slide."""

    timestep: float = parameter(1e-4, "s", "Plant step", "our choice", 1e-6, 2e-4)
    spindle_speed: float = parameter(
        TURN / 3.0, "rad/s", "Spindle speed, positive about +z", "paper: 20 rpm", -20.0, 20.0
    )
    spindle_error: float = parameter(
        0.0,
        "m",
        "Error motion of the axis in x and in y, amplitudes of n = 2 to 5 in all",
        "our choice",
        0.0,
        1e-4,
    )
    spindle_error_noise: float = parameter(
        0.0, "m", "Asynchronous error motion in x and in y, deviation", "our choice", 0.0, 1e-4
    )
    spindle_error_time: float = parameter(
        0.05, "s", "Correlation time of the asynchronous part", "our choice", 1e-3, 1e3
    )
    table_radius: float = parameter(0.15, "m", "Radius of the table", "our choice", 0.01, 1.0)

    part_present: bool = parameter(True, "1", "Whether there is a ring", "our choice")
    mass: float = parameter(1.0, "kg", "Mass of the ring", "paper: 0.75 to 1.5 kg", 0.1, 200.0)
    radius: float = parameter(0.05, "m", "Mean outer radius of the ring", "our choice", 0.01, 0.5)
    wall: float = parameter(0.15, "1", "Thickness of the ring over its radius", "our choice", 0.01, 1.0)
    feet_radius: float = parameter(
        0.04, "m", "Radius of the three points on which the ring rests", "our choice", 1e-3, 0.5
    )
    eccentricity: float = parameter(
        5e-4, "m", "Distance of the ring from the axis at first", "our choice", 0.0, 0.1
    )
    eccentricity_angle: float = parameter(
        0.0, "rad", "Direction in which the ring is off at first, on the table", "our choice", -TURN, TURN
    )
    eccentricity_angle_spread: float = parameter(
        math.pi, "rad", "Added to that, drawn within +-", "our choice: any direction", 0.0, math.pi
    )
    lobe_2: float = parameter(2e-6, "m", "Two lobes (oval), amplitude, phase drawn", "our choice", 0.0, 1e-3)
    lobe_3: float = parameter(2e-6, "m", "Three lobes, amplitude, phase drawn", "our choice", 0.0, 1e-3)
    lobe_5: float = parameter(5e-7, "m", "Five lobes, amplitude, phase drawn", "our choice", 0.0, 1e-3)
    roughness: float = parameter(
        1e-7, "m", "Roughness of 15 to 100 waves per turn, deviation, phases drawn", "our choice", 0.0, 1e-4
    )

    mu_static: float = parameter(
        0.2, "1", "Static friction of ring on table", "paper: 0.15 to 0.25", 0.01, 2.0
    )
    mu_ratio: float = parameter(1.25, "1", "Static over kinetic friction", "our choice", 1.0, 5.0)
    stribeck_speed: float = parameter(
        1e-3, "m/s", "Slip speed of the Stribeck curve", "our choice", 1e-5, 1.0
    )
    bristle: bool = parameter(False, "1", "Elasto-plastic bristle instead of MuJoCo's contacts", "our choice")
    presliding: float = parameter(
        1e-6, "m", "Bristle: deflection at the static force", "our choice", 1e-7, 1e-4
    )
    break_away: float = parameter(
        0.7, "1", "Bristle: purely elastic share of that deflection", "our choice", 0.1, 0.99
    )
    bristle_damping: float = parameter(
        0.2, "1", "Bristle: damping ratio of the ring on it", "our choice", 0.0, 1.0
    )

    pusher_stiffness: float = parameter(5e6, "N/m", "Stiffness of the pusher tip", "our choice", 1e4, 1e8)
    pusher_damping: float = parameter(
        0.15, "1", "Damping ratio of the ring on the tip", "our choice", 0.0, 1.0
    )
    pusher_friction: float = parameter(0.12, "1", "Friction of pusher on ring", "our choice", 0.0, 1.0)
    probe_at_pusher: float = parameter(
        0.02, "m", "Probe position with the surface at the pusher tip", "our choice", 0.0, 0.1
    )
    probe_stroke: float = parameter(0.025, "m", "Stroke of the probe", "our choice", 1e-3, 0.1)
    probe_force_free: float = parameter(0.35, "N", "Gauging force at first touch", "our choice", 0.0, 10.0)
    probe_force_full: float = parameter(0.7, "N", "Gauging force at full stroke", "paper", 0.0, 10.0)
    probe_friction: float = parameter(
        0.1, "1", "Friction of probe on ring", "our choice: ruby on steel", 0.0, 1.0
    )
    probe_resolution: float = parameter(50e-9, "m", "Resolution of the probe", "paper", 0.0, 1e-4)
    probe_noise: float = parameter(30e-9, "m", "Noise of the probe, deviation", "paper", 0.0, 1e-4)

    dirt_height: float = parameter(
        0.0, "m", "Height of the particles that stick to the ring", "our choice", 0.0, 1e-3
    )
    dirt_fraction: float = parameter(
        0.02, "1", "Share of the circumference under particles", "our choice", 0.0, 0.5
    )
    dirt_width: float = parameter(
        5e-4,
        "m",
        "Width of a particle under the probe tip",
        "our choice: 20 um under a ball of 3 mm",
        1e-4,
        0.01,
    )
    spike_height: float = parameter(
        0.0, "m", "Electrical spikes on the probe, up or down", "our choice", 0.0, 1e-3
    )
    spike_fraction: float = parameter(0.02, "1", "Share of the readings that are hit", "our choice", 0.0, 0.5)

    slide_mass: float = parameter(8.0, "kg", "Moving mass of the slide", "our choice", 0.5, 200.0)
    servo_bandwidth: float = parameter(
        40.0, "Hz", "Natural frequency of the slide's servo", "our choice", 1.0, 500.0
    )
    servo_damping: float = parameter(0.7, "1", "Damping ratio of the slide's servo", "our choice", 0.05, 5.0)
    servo_force: float = parameter(400.0, "N", "Largest force of the slide's motor", "our choice", 1.0, 1e5)
    setpoint_period: float = parameter(
        1e-3, "s", "Longest time for which the servo extrapolates a setpoint", "our choice: 1 kHz", 0.0, 1.0
    )
    slide_velocity_max: float = parameter(
        0.12, "m/s", "Largest velocity setpoint of the slide", "paper", 1e-3, 10.0
    )
    slide_resolution: float = parameter(20e-9, "m", "Resolution of the slide's encoder", "paper", 0.0, 1e-4)
    travel: float = parameter(0.15, "m", "Travel of the slide from its start", "our choice", 0.01, 1.0)
    start_distance: float = parameter(
        0.03,
        "m",
        "From the free probe to the place of a centred surface at the start",
        "our choice",
        0.0,
        0.5,
    )
    angle_resolution: float = parameter(
        TURN / 4000.0, "rad", "Resolution of the spindle's encoder", "paper: 0.09 deg", 0.0, 0.1
    )


def check_together(p: SpindleRingParameters) -> None:
    """Check parameters that limit each other.

    Raises
    ------
    ParameterError
        The first that does not fit: its name, value and limit, and where the limit comes from.
    """
    pairs = (
        ("feet_radius", "radius", p.feet_radius, p.radius),
        ("probe_at_pusher", "probe_stroke", p.probe_at_pusher, p.probe_stroke),
        ("eccentricity", "start_distance", p.eccentricity, p.start_distance),
        ("eccentricity", "radius", p.eccentricity, LINE_LIMIT * p.radius),
        ("eccentricity", "table_radius", p.eccentricity, p.table_radius - p.feet_radius),
    )
    for name, bound, value, limit in pairs:
        if value > limit:
            raise ParameterError(
                f"parameter `plant.{name}` of plant `spindle_ring`: value `{value:g}` m, "
                f"limit `{limit:g}` m\nhint: the limit comes from `plant.{bound}`"
            )
