import enum

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Integer, Real, String


class State(enum.IntEnum):
    IDLE = 0
    HEAT = 1
    DONE = 2


class Machine(Fmi2Slave):
    """A heater with a state machine; its state is an Integer and a text."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.start = False
        self.ambient = 20.0
        self.temperature = 20.0
        self.state = 0
        self.name = "idle"
        self.register_variable(Boolean("start", causality=Fmi2Causality.input))
        self.register_variable(Real("ambient", causality=Fmi2Causality.input))
        self.register_variable(Real("temperature", causality=Fmi2Causality.output))
        self.register_variable(Integer("state", causality=Fmi2Causality.output))
        self.register_variable(String("name", causality=Fmi2Causality.output))

    def setup_experiment(self, start_time, stop_time, tolerance):
        self.stop = stop_time

    def exit_initialization_mode(self):
        self.temperature = self.ambient

    def do_step(self, time, step):
        if self.state == State.IDLE and self.start:
            self.state = int(State.HEAT)
        elif self.state == State.HEAT and self.temperature > 21.0:
            self.state = int(State.DONE)
        power = 40.0 if self.state == State.HEAT else 0.0
        self.temperature += step * (power - (self.temperature - self.ambient) / 3.0)
        self.name = State(self.state).name.lower()
        return True
