import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real


class Sampler(Fmi2Slave):
    """A moving mean of its input over the last samples, and a signal of the time."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u = self.mean = self.wave = 0.0
        self.length = 5
        self.samples = []
        length = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Integer("length", **length))
        self.register_variable(Real("mean", causality=Fmi2Causality.output))
        self.register_variable(Real("wave", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        self.samples = [*self.samples, self.u][-self.length :]
        self.mean = math.fsum(self.samples) / len(self.samples)
        self.wave = math.sin(2.0 * math.pi * (time + step))
        return True
