"""Parameters of the slide, each with unit, range and source."""

from dataclasses import dataclass

from plants.base.parameters import parameter


@dataclass(frozen=True)
class __Name__Parameters:
    """Parameters of the slide."""

    timestep: float = parameter(1e-4, "s", "Plant step", "our choice", 1e-6, 1e-3)
    mass: float = parameter(2.1, "kg", "Moving mass", "our choice: 5 % above nominal", 1e-3, 1e4)
    friction: float = parameter(2.0, "N", "Dry friction", "our choice: a ball guide", 0.0, 1e4)
    damping: float = parameter(5.0, "N.s/m", "Viscous friction", "our choice", 0.0, 1e5)
    start_spread: float = parameter(1e-3, "m", "Start, drawn within +-", "our choice", 0.0, 1.0)
    force_max: float = parameter(60.0, "N", "Largest force of the motor", "our choice", 1e-3, 1e5)
    encoder_noise: float = parameter(5e-7, "m", "Encoder noise, deviation", "our choice", 0.0, 1e-3)
    encoder_resolution: float = parameter(1e-6, "m", "Encoder step", "our choice", 0.0, 1e-3)
