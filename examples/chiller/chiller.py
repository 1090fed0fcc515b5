"""A chiller with a two-point controller, which switches its compressor."""

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

TIME_CONSTANT = 20.0
"""Of the coolant tank, s."""
COLD, WARM = 14.0, 22.0
"""Temperature of the coolant after a long time with and without compressor, degC."""


class Chiller(Fmi2Slave):
    """Measured temperature of the spindle (degC) gives the temperature of the coolant (degC)."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.measured, self.target, self.band = 20.0, 22.0, 0.2
        self.coolant, self.compressor = 20.0, False
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.register_variable(Real("measured", causality=Fmi2Causality.input))
        self.register_variable(Real("target", **fixed))
        self.register_variable(Real("band", **fixed))
        self.register_variable(Real("coolant", causality=Fmi2Causality.output))
        discrete = {"causality": Fmi2Causality.output, "variability": Fmi2Variability.discrete}
        self.register_variable(Boolean("compressor", **discrete))

    def do_step(self, time, step):
        """Advance by one communication step, s."""
        if abs(self.measured - self.target) > self.band:
            self.compressor = self.measured > self.target
        end = COLD if self.compressor else WARM
        self.coolant += step / TIME_CONSTANT * (end - self.coolant)
        return True
