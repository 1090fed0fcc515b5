"""Compensation of the growth of a spindle, from its measured temperature."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Compensation(Fmi2Slave):
    """Measured temperature (degC), filtered, gives the offset of the axis (m)."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.measured, self.reference, self.expansion, self.time_constant = 20.0, 20.0, 4e-6, 5.0
        self.filtered, self.offset = 20.0, 0.0
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.register_variable(Real("measured", causality=Fmi2Causality.input))
        for name in ("reference", "expansion", "time_constant"):
            self.register_variable(Real(name, **fixed))
        self.register_variable(Real("offset", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        """Advance by one communication step, s."""
        self.filtered += step / (step + self.time_constant) * (self.measured - self.filtered)
        self.offset = self.expansion * (self.filtered - self.reference)
        return True
