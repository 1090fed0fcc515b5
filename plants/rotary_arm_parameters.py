"""Parameters of the rotary arm, its spindle, slide, cut and probe, each with unit, range and source."""

import math
from dataclasses import dataclass

from plants.base.parameters import parameter

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class RotaryArmParameters:
    """Parameters of the machine."""

    timestep: float = parameter(2e-5, "s", "Plant step", 1e-6, 1e-4, "derived: 31 nm rms at the tool")
    arm_length: float = parameter(0.08, "m", "Arm axis to the center of the tool nose", 0.01, 0.5, "paper")
    arm_zero: float = parameter(
        0.0523, "rad", "Angle of the arm at the index of its encoder", -10.0, 10.0, "default; 3 degrees"
    )
    center_offset: float = parameter(
        0.15, "m", "Slide position with the arm axis on the spindle axis", -1.0, 1.0
    )
    hub_inertia: float = parameter(
        4.5e-4, "kg.m2", "Inertia of motor, encoder and hub", 1e-6, 1.0, "default; rotor 2e-4 and half an arm"
    )
    arm_inertia: float = parameter(
        3.5e-4,
        "kg.m2",
        "Inertia of the flexible part: arm and tool heads",
        1e-6,
        1.0,
        "default; 20 g each at 80 mm",
    )
    flexure_frequency: float = parameter(
        1200.0, "Hz", "Resonance of the arm with the hub held", 100.0, 1e4, "default; above 500 Hz"
    )
    flexure_damping: float = parameter(0.02, "1", "Damping ratio of the arm resonance", 0.0, 0.5)
    viscous_friction: float = parameter(2e-3, "N.m.s/rad", "Viscous friction of the arm bearing", 0.0, 1.0)
    coulomb_friction: float = parameter(
        0.01, "N.m", "Dry friction of the arm bearing", 0.0, 1.0, "default; below the 12th harmonic"
    )
    torque_limit: float = parameter(
        7.0, "N.m", "Largest torque", 1e-3, 1e3, "derived: 500 m/s^2 at 8e-4 kg.m2 needs 5.0, 25 % more"
    )
    torque_gain: float = parameter(
        0.97,
        "1",
        "Torque over commanded torque",
        0.1,
        10.0,
        "default; 3 % below nominal, usual for a motor",
    )
    torque_resolution: float = parameter(
        14.0 / 65_536.0, "N.m", "Step of the torque command", 0.0, 1.0, "default; 16 bit for +-7 N.m"
    )
    current_bandwidth: float = parameter(2e3, "Hz", "Bandwidth of the current loop", 10.0, 1e5)
    ripple_torque: float = parameter(
        6e-3, "N.m", "Arm torque in step with the spindle, amplitude", 0.0, 1.0,
        "default; gives the paper's 1.2 um",
    )  # fmt: skip
    ripple_order: float = parameter(
        12.0, "1", "Cycles of the ripple per revolution of the spindle", 0.0, 100.0, "paper"
    )
    ripple_orders: float = parameter(
        0.0, "N.m", "Ripple at 5, 7, 18 and 31 cycles per revolution, amplitude of each", 0.0, 1.0,
        "default; none, the paper has only the 12th",
    )  # fmt: skip
    hum_torque: float = parameter(
        0.0, "N.m", "Arm torque of fixed frequency, amplitude", 0.0, 1.0, "default; none"
    )
    hum_frequency: float = parameter(
        120.0, "Hz", "Frequency of the hum", 0.0, 5e3, "default; twice the mains, the 12th of 600 rpm"
    )
    cutting_force: float = parameter(2.0, "N", "Mean thrust on the tool", 0.0, 1e3)
    cutting_force_twice: float = parameter(0.1, "N", "Thrust twice per revolution, amplitude", 0.0, 1e3)
    cutting_noise: float = parameter(0.03, "N", "Noise of the thrust, standard deviation", 0.0, 1e2)
    cutting_bandwidth: float = parameter(800.0, "Hz", "Bandwidth of the thrust noise", 1.0, 1e5)
    cutting_pressure: float = parameter(
        0.0, "Pa", "Thrust per cross-section of the chip, 0: none", 0.0, 1e11,
        "default; none; 20 to 150 MPa are up to half of the cutting pressure of lens plastics",
    )  # fmt: skip
    depth_of_cut: float = parameter(
        1e-5, "m", "Height of the face above the last groove", 0.0, 1e-3, "default; finishing"
    )
    spindle_speed: float = parameter(
        20.0 * math.pi, "rad/s", "Spindle speed at the start", -1e3, 1e3, "paper: 600 rpm"
    )
    spindle_acceleration: float = parameter(
        10.0 * math.pi, "rad/s2", "Ramp of the spindle drive", 1e-3, 1e5, "default; 300 rpm in 1 s"
    )
    spindle_inertia: float = parameter(0.05, "kg.m2", "Inertia of spindle and part", 1e-4, 1e3)
    spindle_gain: float = parameter(2.0, "N.m.s/rad", "Velocity gain of the spindle drive", 1e-3, 1e4)
    spindle_ripple: float = parameter(
        0.05, "N.m", "Spindle torque once per revolution, amplitude", 0.0, 1e2, "default; 0.02 % of the speed"
    )
    spindle_ripple_twelfth: float = parameter(
        0.02, "N.m", "Spindle torque twelve times per revolution, amplitude", 0.0, 1e2
    )
    slide_start: float = parameter(
        0.04, "m", "Slide position at the start", -1.0, 1.0, "paper: cutting radius 30 mm"
    )
    feed: float = parameter(1e-5, "m", "Slide travel per revolution of the spindle", -1e-2, 1e-2)
    slide_acceleration: float = parameter(1.0, "m/s2", "Ramp of the slide drive", 1e-3, 1e3)
    slide_mass: float = parameter(40.0, "kg", "Mass of the slide with its load", 2.0, 1e4)
    slide_bandwidth: float = parameter(30.0, "Hz", "Natural frequency of the slide position loop", 1.0, 1e3)
    slide_damping: float = parameter(0.7, "1", "Damping ratio of the slide position loop", 0.01, 2.0)
    start_angle: float = parameter(
        0.0, "rad", "Angle of the arm at the start, 0 is along the slide", -10.0, 10.0
    )
    tool_height: float = parameter(
        0.0,
        "m",
        "Tool above the axis of the spindle",
        -1e-3,
        1e-3,
        "default; none; 20 um in the paper's set-up",
    )
    tool_radius: float = parameter(2e-3, "m", "Radius of the tool nose", 1e-5, 0.02, "default; usual diamond")
    part_radius: float = parameter(0.05, "m", "Radius of the part", 1e-3, 0.5, "paper: 100 mm")
    part_face: float = parameter(-0.01, "m", "Depth of the face of the blank", -1.0, 1.0)
    part_diameters: float = parameter(
        1.0, "1", "Stored diameters of the part, rounded: range of the probe", 1.0, 64.0
    )
    roughness: float = parameter(3e-8, "m", "Roughness of a cut, standard deviation", 0.0, 1e-3)
    probe_radius: float = parameter(1.5e-3, "m", "Radius of the probe ball", 1e-5, 0.02)
    probe_place: float = parameter(
        0.08, "m", "Probe on the slide, from the arm axis to the spindle axis", -1.0, 1.0
    )
    probe_misplacement: float = parameter(
        2e-5, "m", "Error of the probe position, sampled within +-", 0.0, 1e-2
    )
    probe_zero: float = parameter(5e-3, "m", "Depth at which the probe reads 0", -1.0, 1.0)
    probe_noise: float = parameter(5e-8, "m", "Probe noise, standard deviation", 0.0, 1e-3)
    probe_resolution: float = parameter(1e-7, "m", "Step of the probe", 0.0, 1e-3, "paper")
    arm_resolution: float = parameter(
        TURN / 2**23, "rad", "Step of the arm encoder", 0.0, 1e-2, "default; 60 nm at the tool"
    )
    arm_eccentricity: float = parameter(
        0.0, "rad", "Arm encoder: error once per revolution, amplitude", 0.0, 1e-2,
        "default; none; 1 um of eccentricity on a grating of 50 mm is 20 urad",
    )  # fmt: skip
    spindle_eccentricity: float = parameter(
        0.0,
        "rad",
        "Spindle encoder: error once per revolution, amplitude",
        0.0,
        1e-2,
        "default; none, as above",
    )
    spindle_resolution: float = parameter(TURN / 2**20, "rad", "Step of the spindle encoder", 0.0, 1e-1)
    slide_resolution: float = parameter(1e-7, "m", "Step of the slide encoder", 0.0, 1e-3)
