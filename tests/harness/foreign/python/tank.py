from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Container:
    """Part of the model whose attributes are variables of the FMU."""

    def __init__(self):
        self.level = 0.4
        self.area = 2.0


class Tank(Fmi2Slave):
    """A tank with nested variables, filled by its input and emptied through a hole."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.tank = Container()
        self.inflow = self.outflow = 0.0
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.register_variable(Real("inflow", causality=Fmi2Causality.input))
        self.register_variable(Real("tank.area", **fixed))
        self.register_variable(Real("tank.level", causality=Fmi2Causality.output))
        self.register_variable(Real("outflow", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        self.outflow = 0.3 * max(self.tank.level, 0.0) ** 0.5
        self.tank.level += step * (abs(self.inflow) - self.outflow) / self.tank.area
        return True
