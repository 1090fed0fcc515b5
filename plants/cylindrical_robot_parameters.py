"""Parameters of the robot, its drives, spindle, part and burr, each with unit, range and source."""

import math
from dataclasses import dataclass

from plants.base.parameters import parameter

TURN = 2.0 * math.pi
RPM = TURN / 60.0

# the test piece: lines of 120 mm and an arc of 15 mm about a corner in the middle of the reach
LEG, HEADING = 0.135, math.radians(46.0)


@dataclass(frozen=True)
class CylindricalRobotParameters:
    """Parameters of the machine and the part."""

    timestep: float = parameter(
        1e-3, "s", "Plant step", 1e-5, 5e-3, "derived: drives within 2 % to 400 rad/s"
    )

    # drives
    drive_frequency: float = parameter(
        274.0,
        "rad/s",
        "Velocity loops, natural frequency",
        10.0,
        1e3,
        "default; 2 % below the paper's 280",
    )
    drive_damping: float = parameter(0.52, "1", "Velocity loops, damping ratio", 0.05, 2.0, "paper")
    drive_gain: float = parameter(1.0, "1", "Velocity per commanded velocity", 0.5, 1.5, "paper")
    coulomb_friction: float = parameter(
        0.05, "1", "Coulomb friction over the largest force of each drive", 0.0, 0.5
    )
    reversal_friction: float = parameter(
        0.0, "1", "Friction after the gears of axes 1 and 3, grown after a reversal, over the largest force",
        0.0, 0.5, "default; none. Guides and seals have some 3 %",
    )  # fmt: skip
    reversal_way: float = parameter(
        2e-4, "1", "Displacement after a reversal over which it reverses, rad or m", 1e-6, 0.1,
        "default; 0.15 mm at the reach of axis 1",
    )  # fmt: skip
    backlash: float = parameter(
        0.0, "m", "Backlash of the gears of axes 1 and 3, at the tip at the tuned reach", 0.0, 0.01,
        "default; none. One arc minute is 0.2 mm at 0.75 m",
    )  # fmt: skip
    cogging: float = parameter(
        0.0, "1", "Cogging of each drive, amplitude over its largest force", 0.0, 0.2,
        "default; none. Servo motors have 1 to 2 %",
    )  # fmt: skip
    axis1_cogging: float = parameter(
        TURN / 160.0 / 24.0, "rad", "Period of the cogging of axes 1, 4, 5 and 6", 1e-6, 10.0,
        "default; 24 per revolution of a motor with a gear of 1:160",
    )  # fmt: skip
    axis3_cogging: float = parameter(
        0.02 / 24.0,
        "m",
        "Period of the cogging of axes 2 and 3",
        1e-6,
        1.0,
        "default; 24 per revolution, lead of 20 mm",
    )
    axis1_force: float = parameter(300.0, "N.m", "Largest torque of drive 1", 1.0, 1e6)
    axis2_force: float = parameter(1000.0, "N", "Largest force of drive 2", 1.0, 1e6)
    axis3_force: float = parameter(600.0, "N", "Largest force of drive 3", 1.0, 1e6)
    axis4_force: float = parameter(20.0, "N.m", "Largest torque of drive 4", 0.1, 1e5)
    axis5_force: float = parameter(20.0, "N.m", "Largest torque of drive 5", 0.1, 1e5)
    axis6_force: float = parameter(10.0, "N.m", "Largest torque of drive 6", 0.1, 1e5)
    axis1_speed: float = parameter(1.5, "rad/s", "Largest speed of drive 1", 0.01, 100.0)
    axis2_speed: float = parameter(1.0, "m/s", "Largest speed of drive 2", 0.01, 100.0)
    axis3_speed: float = parameter(1.0, "m/s", "Largest speed of drive 3", 0.01, 100.0, "paper: 500 mm/s")
    axis4_speed: float = parameter(3.0, "rad/s", "Largest speed of drive 4", 0.01, 100.0)
    axis5_speed: float = parameter(3.0, "rad/s", "Largest speed of drive 5", 0.01, 100.0)
    axis6_speed: float = parameter(3.0, "rad/s", "Largest speed of drive 6", 0.01, 100.0)

    # encoders, on the motors
    axis1_pulse: float = parameter(TURN / 640_000, "rad", "Pulse of encoder 1", 0.0, 0.1)
    axis2_pulse: float = parameter(2.5e-6, "m", "Pulse of encoder 2", 0.0, 0.01)
    axis3_pulse: float = parameter(
        5e-6, "m", "Pulse of encoder 3", 0.0, 0.01, "default; 20 mm of lead and 4000 pulses per revolution"
    )
    axis4_pulse: float = parameter(TURN / 400_000, "rad", "Pulse of encoder 4", 0.0, 0.1)
    axis5_pulse: float = parameter(TURN / 400_000, "rad", "Pulse of encoder 5", 0.0, 0.1)
    axis6_pulse: float = parameter(TURN / 400_000, "rad", "Pulse of encoder 6", 0.0, 0.1)

    encoder_noise: float = parameter(
        0.5,
        "1",
        "Noise of the encoders, standard deviation in pulses",
        0.0,
        100.0,
        "default; half a pulse. The paper has none",
    )

    # what moves
    axis1_rotor: float = parameter(
        12.8, "kg.m2", "Motor 1 at the output of its gear", 0.0, 1e4, "default; 1:160"
    )
    axis2_rotor: float = parameter(80.0, "kg", "Motor 2 at the output of its screw", 0.0, 1e4)
    axis3_rotor: float = parameter(49.0, "kg", "Motor 3 at the output of its screw", 0.0, 1e4)
    axis4_rotor: float = parameter(0.4, "kg.m2", "Motor 4 at the output of its gear", 0.0, 1e2)
    axis5_rotor: float = parameter(0.4, "kg.m2", "Motor 5 at the output of its gear", 0.0, 1e2)
    axis6_rotor: float = parameter(0.1, "kg.m2", "Motor 6 at the output of its gear", 0.0, 1e2)
    tuned_payload: float = parameter(
        5.0, "kg", "Mass of the spindle for which the drives are tuned", 0.1, 50.0
    )
    tuned_radius: float = parameter(0.75, "m", "Reach for which they are tuned", 0.3, 1.5)
    payload: float = parameter(5.0, "kg", "Mass of the spindle", 0.1, 50.0)
    flexible: bool = parameter(True, "1", "Whether the gears of the axes 1 and 3 are compliant")
    coupling_frequency: float = parameter(60.0, "Hz", "Loads on these gears, natural frequency", 10.0, 200.0)
    coupling_damping: float = parameter(0.05, "1", "Damping ratio of these loads", 0.0, 1.0)
    tool_length: float = parameter(0.2, "m", "Wrist to tip of the tool", 0.01, 1.0)
    start_height: float = parameter(0.02, "m", "Tip above the edge at the start", -1.0, 1.0)

    # spindle
    synchronous_speed: float = parameter(
        18_000.0 * RPM, "rad/s", "Speed without slip", 1.0, 1e5, "default; 2 poles at 300 Hz"
    )
    rated_speed: float = parameter(17_500.0 * RPM, "rad/s", "Speed at rated power", 1.0, 1e5, "paper")
    rated_power: float = parameter(600.0, "W", "Rated power", 1.0, 1e5, "paper")
    overload: float = parameter(2.5, "1", "Breakdown torque over rated torque", 1.01, 10.0)
    spindle_time: float = parameter(
        0.15, "s", "Time constant of the speed about the rated point", 1e-2, 10.0, "paper: 0.1 to 0.25"
    )
    spindle_friction: float = parameter(0.008, "N.m", "Friction of the spindle", 0.0, 0.1)
    spindle_lag: float = parameter(0.02, "s", "Lag of the measured speed", 1e-4, 1.0)
    spindle_noise: float = parameter(
        0.5,
        "rad/s",
        "Noise of the measured speed, standard deviation",
        0.0,
        100.0,
        "default; a step of the measurement. The paper has none",
    )
    spindle_resolution: float = parameter(
        20_000.0 * RPM / 4096, "rad/s", "Step of the measured speed", 0.0, 100.0, "default; 12 bit"
    )

    # tool and cut
    teeth: float = parameter(2.0, "1", "Teeth of the end mill", 1.0, 12.0, "paper")
    tool_radius: float = parameter(6e-3, "m", "Radius of the end mill", 1e-3, 0.05)
    cutting_pressure: float = parameter(
        9e8, "Pa", "Force per chip cross-section", 0.0, 1e10, "literature: 244 to 1319 MPa for aluminum"
    )
    edge_force: float = parameter(
        2e4, "N/m", "Force per engaged edge length", 0.0, 1e6, "literature: 7 to 28 N/mm for aluminum"
    )
    chip_most: float = parameter(5e-4, "m", "Largest chip of a tooth, above it the tool rubs", 1e-5, 0.01)
    force_along: float = parameter(0.5, "1", "Reaction against the feed, ratio", -2.0, 2.0)
    force_outward: float = parameter(0.35, "1", "Reaction outward, ratio", -2.0, 2.0)
    tool_reach: float = parameter(
        0.01, "m", "Distance above and below its tip in which the tool cuts", 1e-3, 0.1
    )

    # edge of the part, the desired path of the tip
    edge_start_x: float = parameter(0.75 - LEG * math.cos(HEADING), "m", "Start of the edge", -2.0, 2.0)
    edge_start_y: float = parameter(-LEG * math.sin(HEADING), "m", "Start of the edge", -2.0, 2.0)
    edge_start_z: float = parameter(-0.2, "m", "Start of the edge", -1.0, 1.0)
    edge_corner_x: float = parameter(0.75, "m", "Where its lines would meet", -2.0, 2.0)
    edge_corner_y: float = parameter(0.0, "m", "Where its lines would meet", -2.0, 2.0)
    edge_corner_z: float = parameter(-0.2, "m", "Where its lines would meet", -1.0, 1.0)
    edge_end_x: float = parameter(0.75 - LEG * math.sin(HEADING), "m", "End of the edge", -2.0, 2.0)
    edge_end_y: float = parameter(LEG * math.cos(HEADING), "m", "End of the edge", -2.0, 2.0)
    edge_end_z: float = parameter(-0.2, "m", "End of the edge", -1.0, 1.0)
    edge_radius: float = parameter(0.015, "m", "Radius of the corner", 0.0, 1.0)

    # position of the part, and the probe that touches it
    part_x: float = parameter(0.0, "m", "Displacement of the part from its configured edge", -0.1, 0.1)
    part_y: float = parameter(0.0, "m", "Displacement of the part from its configured edge", -0.1, 0.1)
    part_angle: float = parameter(
        0.0, "rad", "Rotation of the part about the vertical through its corner", -1.0, 1.0
    )
    wall_height: float = parameter(
        0.018,
        "m",
        "Height of the wall above the edge, along the burr",
        0.0,
        1.0,
        "default; higher than the burr",
    )
    probe_pretravel: float = parameter(
        1e-5,
        "m",
        "Travel of the touch probe from touch to contact",
        0.0,
        1e-3,
        "default; typical of touch-trigger probes",
    )
    probe_travel: float = parameter(
        0.01, "m", "Largest deflection", 1e-4, 0.1, "default; 12 degrees of a stylus of 50 mm"
    )
    probe_stiffness: float = parameter(
        1e3, "N/m", "Stiffness of the spring of the probe", 0.0, 1e6, "default; 1 N per millimeter"
    )
    probe_end_stiffness: float = parameter(
        1e6, "N/m", "Stiffness at the largest deflection", 0.0, 1e9, "default; stiff compared with the spring"
    )

    # burr
    burr_height_least: float = parameter(2e-3, "m", "Lowest burr", 0.0, 0.02, "paper")
    burr_height_most: float = parameter(5e-3, "m", "Highest burr", 0.0, 0.02, "paper")
    burr_thickness_least: float = parameter(1e-3, "m", "Thinnest burr", 0.0, 0.02, "paper")
    burr_thickness_most: float = parameter(2e-3, "m", "Thickest burr", 0.0, 0.02, "paper")
    burr_correlation: float = parameter(0.012, "m", "Length over which the burr changes", 1e-3, 1.0)
    burr_gaps: float = parameter(2.0, "1", "Largest number of gaps, sampled from 0 on", 0.0, 20.0)
    burr_gap_least: float = parameter(6e-3, "m", "Shortest gap", 0.0, 1.0)
    burr_gap_most: float = parameter(0.02, "m", "Longest gap", 0.0, 1.0)
    burr_begin: float = parameter(0.03, "m", "Start of the burr on the edge", 0.0, 10.0)
    burr_end: float = parameter(0.01, "m", "Length without burr before the end", 0.0, 10.0)
    burr_pitch: float = parameter(2.5e-4, "m", "Length of one bin", 1e-5, 0.01)
