from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Lorenz(Fmi2Slave):
    """The equations of Lorenz, which enlarge the smallest difference of two runs."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.x, self.y, self.z, self.u = 1.0, 1.0, 1.0, 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        for name in "xyz":
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def do_step(self, time, step):
        for _ in range(10):
            h, x, y, z = step / 10, self.x, self.y, self.z
            self.x += h * 10.0 * (y - x)
            self.y += h * (x * (28.0 - z) - y + self.u)
            self.z += h * (x * y - 8.0 / 3.0 * z)
        return True
