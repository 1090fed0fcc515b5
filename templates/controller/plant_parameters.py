"""Parameters of the slide, each with unit, range and source."""

from dataclasses import dataclass

from plants.base.parameters import parameter


@dataclass(frozen=True)
class __Name__Parameters:
    """Parameters of the slide."""

    timestep: float = parameter(1e-4, "s", "Plant step", 1e-6, 1e-3)
    mass: float = parameter(2.1, "kg", "Moving mass", 1e-3, 1e4, "default; 5 % above nominal")
    friction: float = parameter(2.0, "N", "Dry friction", 0.0, 1e4, "default; a ball guide")
    damping: float = parameter(5.0, "N.s/m", "Viscous friction", 0.0, 1e5)
    start_spread: float = parameter(1e-3, "m", "Start position, sampled within +-", 0.0, 1.0)
    force_max: float = parameter(60.0, "N", "Maximum force of the motor", 1e-3, 1e5)
    encoder_noise: float = parameter(5e-7, "m", "Encoder noise, standard deviation", 0.0, 1e-3)
    encoder_resolution: float = parameter(1e-6, "m", "Encoder step", 0.0, 1e-3)
