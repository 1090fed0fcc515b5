"""A motor spindle that its losses heat and its coolant cools; its shaft grows with the temperature."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

HEAT_CAPACITY = 12e3
"""Of rotor and housing, J/K."""
TO_COOLANT = 55.0
"""Heat flow to the coolant, W/K."""
TO_AIR = 6.0
"""Heat flow to the air, W/K."""
EXPANSION = 4.2e-6
"""Growth of the shaft, m/K."""


class Spindle(Fmi2Slave):
    """Losses (W) and coolant (degC) give temperature (degC) and growth (m)."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.losses, self.coolant, self.ambient = 0.0, 20.0, 20.0
        self.temperature, self.growth = 20.0, 0.0
        for name in ("losses", "coolant"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.register_variable(Real("ambient", **fixed))
        for name in ("temperature", "growth"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def exit_initialization_mode(self):
        """Start at the ambient temperature."""
        self.temperature = self.ambient

    def do_step(self, time, step):
        """Advance by one communication step, s."""
        cooling = TO_COOLANT * (self.temperature - self.coolant) + TO_AIR * (self.temperature - self.ambient)
        self.temperature += step * (self.losses - cooling) / HEAT_CAPACITY
        self.growth = EXPANSION * (self.temperature - self.ambient)
        return True
