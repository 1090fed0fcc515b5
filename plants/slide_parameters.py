"""Parameters of the slide, its motor, bearings, spindle and surface, each with unit, range and source."""

import math
from dataclasses import dataclass

from plants.base.parameters import ParameterError, parameter


@dataclass(frozen=True)
class SlideParameters:
    """Parameters of the slide."""

    timestep: float = parameter(5e-5, "s", "Plant step", 1e-6, 1e-3, "default; half a sample of 10 kHz")
    mass: float = parameter(10.4, "kg", "Moving mass", 0.1, 1e3, "default; 4 % above nominal")
    force_constant: float = parameter(19.4, "N/A", "Thrust per A", 0.1, 1e3, "default; 3 % below nominal")
    force_ripple: float = parameter(0.01, "1", "Relative ripple of the thrust", 0.0, 0.5)
    magnetic_pitch: float = parameter(0.03, "m", "Period of ripple and cogging", 1e-3, 1.0)
    damping: float = parameter(10.0, "N.s/m", "Viscous friction", 0.0, 1e4, "default; air bearing")
    cogging: float = parameter(0.2, "N", "Cogging at the pitch, amplitude", 0.0, 1e2)
    cogging_half: float = parameter(0.05, "N", "Cogging at half the pitch, amplitude", 0.0, 1e2)
    tool_mass: float = parameter(
        2.0, "kg", "Part of the mass beyond the structural mode: spindle and tool", 1e-3, 1e3
    )
    tool_frequency: float = parameter(
        0.0, "Hz", "Resonance of that part on a fixed slide, 0: rigid", 0.0, 5e3,
        "default; none, spindle brackets have some hundred hertz",
    )  # fmt: skip
    tool_damping: float = parameter(0.02, "1", "Damping ratio of that resonance", 0.0, 1.0)
    floor_force: float = parameter(
        0.0, "N", "Force of the floor vibration, amplitude", 0.0, 10.0, "default; none, 0.02 N is 0.2 mg"
    )
    floor_frequency: float = parameter(
        18.0, "Hz", "Frequency of the floor", 0.1, 1e3, "default; slab of a workshop"
    )
    balancer_residual: float = parameter(0.5, "N", "Residual weight, sampled within +-", 0.0, 1e2)
    balancer_sway: float = parameter(0.02, "N", "Balancer noise, standard deviation", 0.0, 10.0)
    balancer_time: float = parameter(0.5, "s", "Correlation time of that noise", 1e-3, 1e3)
    air_noise: float = parameter(1e-3, "N", "Air bearing noise, standard deviation", 0.0, 10.0)
    air_bandwidth: float = parameter(500.0, "Hz", "Bandwidth of that noise", 1.0, 1e5)
    spindle_speed: float = parameter(
        1000.0 * math.pi, "rad/s", "Spindle speed", 0.0, 2e4, "default; 30 000 rpm"
    )
    spindle_force: float = parameter(0.02, "N", "Axial force once per revolution, amplitude", 0.0, 10.0)
    spindle_force_twice: float = parameter(
        0.01, "N", "Axial force twice per revolution, amplitude", 0.0, 10.0
    )
    spindle_wobble: float = parameter(
        0.0, "1", "Variation of the spindle speed, amplitude over the mean", 0.0, 0.1, "default; none"
    )
    wobble_frequency: float = parameter(1.0, "Hz", "Frequency of that variation", 0.0, 1e3)
    encoder_noise: float = parameter(5e-10, "m", "Encoder noise, standard deviation", 0.0, 1e-3)
    encoder_resolution: float = parameter(1e-9, "m", "Encoder step", 0.0, 1e-3, "paper: 1 nm is usual")
    encoder_interpolation: float = parameter(
        0.0, "m", "Encoder error within a signal period, amplitude", 0.0, 1e-6,
        "default; none, interpolated encoders have a few nanometers",
    )  # fmt: skip
    encoder_period: float = parameter(4e-6, "m", "Signal period of the encoder", 1e-8, 1e-3)
    current_limit: float = parameter(5.0, "A", "Maximum current", 1e-3, 1e3)
    current_resolution: float = parameter(
        10.0 / 65_536.0, "A", "Step of the current command", 0.0, 1.0, "paper: 16 bit, here for +-5 A"
    )
    current_bandwidth: float = parameter(1e3, "Hz", "Bandwidth of the current loop", 10.0, 1e5)
    amplifier_noise: float = parameter(
        5e-5, "A", "Current noise within the bandwidth, standard deviation", 0.0, 1.0
    )
    stiffness: float = parameter(
        2e5, "N/m", "Contact of one flute: tool, spindle and workpiece in series", 0.0, 1e8
    )
    yield_depth: float = parameter(
        0.0, "m", "Elastic depth of one flute before the surface yields, 0: never", 0.0, 1e-3
    )
    cutting_pressure: float = parameter(
        0.0, "Pa", "Force per cross-section of the chip, 0: the flutes press without cutting", 0.0, 1e12,
        "default; none, 1 GPa for thick chips, some ten times that below 1 um",
    )  # fmt: skip
    cutting_width: float = parameter(
        1e-4, "m", "Width of the chip of a flute", 1e-6, 1e-2, "default; end mill of 0.2 mm"
    )
    tilt: float = parameter(5e-8, "m", "Axial run-out of the flutes, amplitude", 0.0, 1e-4)
    flute_shortfall: float = parameter(
        1e-7, "m", "Axial distance of the second flute from the first", 0.0, 1e-4
    )
    workpiece: bool = parameter(True, "1", "Whether there is a workpiece")
    surface_distance: float = parameter(1e-4, "m", "Minimum distance from the start to the surface", 0.0, 0.5)
    surface_spread: float = parameter(5e-5, "m", "Extra distance, sampled from 0 to", 0.0, 0.1)
    start_spread: float = parameter(1e-3, "m", "Start position, sampled within +-", 0.0, 0.1)


def check_together(p: SlideParameters) -> None:
    """Check parameters that limit each other.

    Raises
    ------
    ParameterError
        The first that does not fit: its name, value and limit.
    """
    if p.tool_frequency > 0.0 and p.tool_mass >= p.mass:
        raise ParameterError(
            f"parameter `plant.tool_mass` of plant `slide`: value `{p.tool_mass:g}` kg, "
            f"limit `{p.mass:g}` kg\nhint: It is a part of `plant.mass`."
        )
    if p.cutting_pressure > 0.0 and p.yield_depth > 0.0:
        raise ParameterError(
            f"parameter `plant.yield_depth` of plant `slide`: value `{p.yield_depth:g}` m, limit `0` m\n"
            "hint: Set one of both to 0: a surface that is cut (`plant.cutting_pressure`) does not yield."
        )
