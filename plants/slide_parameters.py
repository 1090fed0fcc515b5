"""Parameters of the slide, its motor, bearings, spindle and surface, each with unit, range and source."""

import math
from dataclasses import dataclass

from plants.base.parameters import parameter


@dataclass(frozen=True)
class SlideParameters:
    """Parameters of the slide."""

    timestep: float = parameter(5e-5, "s", "Plant step", "our choice: half a sample of 10 kHz", 1e-6, 1e-3)
    mass: float = parameter(10.4, "kg", "Moving mass", "our choice: 4 % above nominal", 0.1, 1e3)
    force_constant: float = parameter(19.4, "N/A", "Thrust per A", "our choice: 3 % below nominal", 0.1, 1e3)
    force_ripple: float = parameter(0.01, "1", "Relative ripple of the thrust", "our choice", 0.0, 0.5)
    magnetic_pitch: float = parameter(0.03, "m", "Period of ripple and cogging", "our choice", 1e-3, 1.0)
    damping: float = parameter(10.0, "N.s/m", "Viscous friction", "our choice: air bearing", 0.0, 1e4)
    cogging: float = parameter(0.2, "N", "Cogging at the pitch, amplitude", "our choice", 0.0, 1e2)
    cogging_half: float = parameter(0.05, "N", "Cogging at half the pitch, amplitude", "our choice", 0.0, 1e2)
    balancer_residual: float = parameter(
        0.5, "N", "Weight left over, drawn within +-", "our choice", 0.0, 1e2
    )
    balancer_sway: float = parameter(0.02, "N", "Balancer noise, deviation", "our choice", 0.0, 10.0)
    balancer_time: float = parameter(0.5, "s", "Correlation time of that noise", "our choice", 1e-3, 1e3)
    air_noise: float = parameter(1e-3, "N", "Air bearing noise, deviation", "our choice", 0.0, 10.0)
    air_bandwidth: float = parameter(500.0, "Hz", "Bandwidth of that noise", "our choice", 1.0, 1e5)
    spindle_speed: float = parameter(
        1000.0 * math.pi, "rad/s", "Spindle speed", "our choice: 30 000 rpm", 0.0, 2e4
    )
    spindle_force: float = parameter(0.02, "N", "Axial force once a turn, amplitude", "our choice", 0.0, 10.0)
    spindle_force_twice: float = parameter(0.01, "N", "The same twice a turn", "our choice", 0.0, 10.0)
    encoder_noise: float = parameter(5e-10, "m", "Encoder noise, deviation", "our choice", 0.0, 1e-3)
    encoder_resolution: float = parameter(1e-9, "m", "Encoder step", "paper: 1 nm is usual", 0.0, 1e-3)
    current_limit: float = parameter(5.0, "A", "Largest current", "our choice", 1e-3, 1e3)
    current_resolution: float = parameter(
        10.0 / 65_536.0, "A", "Step of the current command", "paper: 16 bit, here for +-5 A", 0.0, 1.0
    )
    current_bandwidth: float = parameter(1e3, "Hz", "Bandwidth of the current loop", "our choice", 10.0, 1e5)
    amplifier_noise: float = parameter(
        5e-5, "A", "Current noise within the bandwidth, deviation", "our choice", 0.0, 1.0
    )
    stiffness: float = parameter(
        2e5, "N/m", "Contact of one flute: tool, spindle and work in series", "our choice", 0.0, 1e8
    )
    yield_depth: float = parameter(
        0.0, "m", "Elastic depth of one flute before the surface yields, 0: never", "our choice", 0.0, 1e-3
    )
    tilt: float = parameter(5e-8, "m", "Axial run-out of the flutes, amplitude", "our choice", 0.0, 1e-4)
    flute_shortfall: float = parameter(1e-7, "m", "What the second flute lacks", "our choice", 0.0, 1e-4)
    workpiece: bool = parameter(True, "1", "Whether there is a workpiece", "our choice")
    surface_distance: float = parameter(
        1e-4, "m", "Least distance from the start to the surface", "our choice", 0.0, 0.5
    )
    surface_spread: float = parameter(5e-5, "m", "Extra distance, drawn from 0 to", "our choice", 0.0, 0.1)
    start_spread: float = parameter(1e-3, "m", "Start position, drawn within +-", "our choice", 0.0, 0.1)
