"""Parameters of the slide, its motor, bearings, spindle and surface, each with unit, range and source."""

import math
from dataclasses import dataclass

from plants.base.parameters import parameter


@dataclass(frozen=True)
class SlideParameters:
    """Parameters of the slide."""

    timestep: float = parameter(5e-5, "s", "Plant step", 1e-6, 1e-3, "our choice: half a sample of 10 kHz")
    mass: float = parameter(10.4, "kg", "Moving mass", 0.1, 1e3, "our choice: 4 % above nominal")
    force_constant: float = parameter(19.4, "N/A", "Thrust per A", 0.1, 1e3, "our choice: 3 % below nominal")
    force_ripple: float = parameter(0.01, "1", "Relative ripple of the thrust", 0.0, 0.5)
    magnetic_pitch: float = parameter(0.03, "m", "Period of ripple and cogging", 1e-3, 1.0)
    damping: float = parameter(10.0, "N.s/m", "Viscous friction", 0.0, 1e4, "our choice: air bearing")
    cogging: float = parameter(0.2, "N", "Cogging at the pitch, amplitude", 0.0, 1e2)
    cogging_half: float = parameter(0.05, "N", "Cogging at half the pitch, amplitude", 0.0, 1e2)
    balancer_residual: float = parameter(0.5, "N", "Weight left over, drawn within +-", 0.0, 1e2)
    balancer_sway: float = parameter(0.02, "N", "Balancer noise, deviation", 0.0, 10.0)
    balancer_time: float = parameter(0.5, "s", "Correlation time of that noise", 1e-3, 1e3)
    air_noise: float = parameter(1e-3, "N", "Air bearing noise, deviation", 0.0, 10.0)
    air_bandwidth: float = parameter(500.0, "Hz", "Bandwidth of that noise", 1.0, 1e5)
    spindle_speed: float = parameter(
        1000.0 * math.pi, "rad/s", "Spindle speed", 0.0, 2e4, "our choice: 30 000 rpm"
    )
    spindle_force: float = parameter(0.02, "N", "Axial force once a turn, amplitude", 0.0, 10.0)
    spindle_force_twice: float = parameter(0.01, "N", "The same twice a turn", 0.0, 10.0)
    encoder_noise: float = parameter(5e-10, "m", "Encoder noise, deviation", 0.0, 1e-3)
    encoder_resolution: float = parameter(1e-9, "m", "Encoder step", 0.0, 1e-3, "paper: 1 nm is usual")
    current_limit: float = parameter(5.0, "A", "Largest current", 1e-3, 1e3)
    current_resolution: float = parameter(
        10.0 / 65_536.0, "A", "Step of the current command", 0.0, 1.0, "paper: 16 bit, here for +-5 A"
    )
    current_bandwidth: float = parameter(1e3, "Hz", "Bandwidth of the current loop", 10.0, 1e5)
    amplifier_noise: float = parameter(5e-5, "A", "Current noise within the bandwidth, deviation", 0.0, 1.0)
    stiffness: float = parameter(
        2e5, "N/m", "Contact of one flute: tool, spindle and work in series", 0.0, 1e8
    )
    yield_depth: float = parameter(
        0.0, "m", "Elastic depth of one flute before the surface yields, 0: never", 0.0, 1e-3
    )
    tilt: float = parameter(5e-8, "m", "Axial run-out of the flutes, amplitude", 0.0, 1e-4)
    flute_shortfall: float = parameter(1e-7, "m", "What the second flute lacks", 0.0, 1e-4)
    workpiece: bool = parameter(True, "1", "Whether there is a workpiece")
    surface_distance: float = parameter(1e-4, "m", "Least distance from the start to the surface", 0.0, 0.5)
    surface_spread: float = parameter(5e-5, "m", "Extra distance, drawn from 0 to", 0.0, 0.1)
    start_spread: float = parameter(1e-3, "m", "Start position, drawn within +-", 0.0, 0.1)
