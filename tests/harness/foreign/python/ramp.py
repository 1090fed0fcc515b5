from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real


class Ramp(Fmi2Slave):
    """A setpoint that approaches its target with a limited rate."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.target = self.y = 0.0
        self.rate = 0.7
        self.hold = self.arrived = False
        self.steps = 0
        parameter = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.register_variable(Real("target", causality=Fmi2Causality.input))
        self.register_variable(Boolean("hold", causality=Fmi2Causality.input))
        self.register_variable(Real("rate", **parameter))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
        self.register_variable(Boolean("arrived", causality=Fmi2Causality.output))
        self.register_variable(Integer("steps", causality=Fmi2Causality.output))

    def exit_initialization_mode(self):
        self.y = 0.5 * self.target

    def do_step(self, time, step):
        if not self.hold:
            self.y += max(-self.rate * step, min(self.rate * step, self.target - self.y))
        self.arrived = self.y == self.target
        self.steps += 1
        return True
