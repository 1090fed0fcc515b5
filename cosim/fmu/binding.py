"""The functions of FMI 2.0 and FMI 3.0 of one instance, through FMPy."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, ClassVar

import numpy as np
from fmpy import fmi3
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from numpy.typing import NDArray

from cosim.errors import FmuError
from cosim.fmu.description import FmuFile, Variable
from cosim.fmu.messages import Messages

DISCARD = 2
TERMINATED = 3
"""Kind of status of FMI 2.0 that states whether a discarded step ends the run."""


class Bank:
    """Variables of one type that one FMI call transfers through an array shared with numpy.

    `values[i]` belongs to `variables[i]`; `base` is the type in the names of functions. An array has one
    value reference and all its elements.
    """

    def __init__(self, base: str, kind: Any, variables: list[Variable]) -> None:
        references = [variable.reference for variable in variables if variable.element == 0]
        self.base = base
        self.variables = variables
        self.references = (ctypes.c_uint * len(references))(*references)
        self.buffer = (kind * len(variables))()
        self.values: NDArray[Any] = np.frombuffer(self.buffer, np.dtype(kind))


class Binding:
    """Calls of one FMI version for one instance."""

    prefix = ""
    """Start of the names of functions and status values."""
    enumeration = ""
    """Type that transfers enumerations."""
    types: ClassVar[Mapping[str, Any]] = {}
    """Types of the numbers that are transferred, in the order of the calls."""
    answers: ClassVar[Mapping[str, bytes]] = {}
    """Identification of the headers with which a library was compiled."""
    ending = ""
    """How a step reports the end of a run."""
    library: Any = None
    """Class of FMPy."""

    def __init__(self, file: FmuFile, name: str) -> None:
        self.model = file.name
        self.slave = self.library(
            guid=file.guid,
            modelIdentifier=file.identifier,
            unzipDirectory=str(file.folder),
            instanceName=name,
        )

    @classmethod
    def type_of(cls, variable: Variable) -> str:
        """Type of a variable in the names of functions."""
        return cls.enumeration if variable.kind == "Enumeration" else variable.kind

    @classmethod
    def banks(cls, variables: list[Variable]) -> list[Bank]:
        """Group numbers by type; texts are not used in a closed loop."""
        groups = {base: [v for v in variables if cls.type_of(v) == base] for base in cls.types}
        return [Bank(base, cls.types[base], group) for base, group in groups.items() if group]

    def call(self, name: str, *arguments: Any) -> int:
        """Call a function by its name without prefix; return its status fmiOK or fmiWarning."""
        status: int = getattr(self.slave, self.prefix + name)(self.slave.component, *arguments)
        return status

    def mover(self, verb: str, bank: Bank, *more: int) -> Callable[[], int]:
        """Get or set call of a bank with its arguments bound."""
        function = getattr(self.slave, f"{self.prefix}{verb}{bank.base}")
        references = bank.references, len(bank.references)
        return partial(function, self.slave.component, *references, bank.buffer, *more)

    def set_start(self, variable: Variable, values: list[Any]) -> None:
        """Set the start value of a variable, or those of all elements of its array."""
        getattr(self.slave, f"set{self.type_of(variable)}")([variable.reference], values)

    def enter(self) -> int:
        """Enter the Initialization Mode."""
        return self.call("EnterInitializationMode")


class Fmi2(Binding):
    """FMI 2.0."""

    prefix = "fmi2"
    enumeration = "Integer"
    types: ClassVar[Mapping[str, Any]] = {
        "Real": ctypes.c_double,
        "Integer": ctypes.c_int,
        "Boolean": ctypes.c_int,
    }
    answers: ClassVar[Mapping[str, bytes]] = {"fmi2GetVersion": b"2.0", "fmi2GetTypesPlatform": b"default"}
    ending = "fmi2Discard with fmi2Terminated"
    library = FMU2Slave

    def instantiate(self, messages: Messages, log_events: bool) -> None:
        """Make the instance."""
        self.slave.instantiate(callbacks=messages.callbacks, loggingOn=log_events)

    def set_up(self, tolerance: float | None, stop_time: float) -> None:
        """Set the experiment, before the start values."""
        self.slave.setupExperiment(tolerance=tolerance, startTime=0.0, stopTime=stop_time)

    def step(self, time: float, step: float) -> tuple[int, bool]:
        """Do one step; return its status, and whether it ended the run."""
        try:
            return self.slave.fmi2DoStep(self.slave.component, time, step, 1), False
        except FMICallException as error:
            if error.status != DISCARD or not self._terminated():
                raise
            return DISCARD, True

    def _terminated(self) -> bool:
        try:
            return bool(self.slave.getBooleanStatus(TERMINATED))
        except FMICallException:
            return False


class Fmi3(Binding):
    """FMI 3.0, without Event Mode, early return and intermediate update."""

    prefix = "fmi3"
    enumeration = "Int64"
    types: ClassVar[Mapping[str, Any]] = {
        name: getattr(fmi3, f"fmi3{name}")
        for name in (
            *("Float64", "Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"),
            "Boolean",
        )
    }
    answers: ClassVar[Mapping[str, bytes]] = {"fmi3GetVersion": b"3.0"}
    ending = "`terminateSimulation`"
    library = fmi3.FMU3Slave

    def __init__(self, file: FmuFile, name: str) -> None:
        super().__init__(file, name)
        self.experiment: tuple[Any, ...] = ()
        self.event, self.terminate, self.early = (ctypes.c_bool() for _ in range(3))
        self.reached = ctypes.c_double()
        outputs = (self.event, self.terminate, self.early, self.reached)
        self.outputs = [ctypes.byref(output) for output in outputs]

    def mover(self, verb: str, bank: Bank, *more: int) -> Callable[[], int]:
        """Get or set call of a bank, which also takes the number of its values."""
        return super().mover(verb, bank, len(bank.variables), *more)

    def instantiate(self, messages: Messages, log_events: bool) -> None:
        """Make the instance."""
        self.slave.instantiate(loggingOn=log_events, logMessage=lambda _, *text: messages.receive(*text))

    def set_up(self, tolerance: float | None, stop_time: float) -> None:
        """Keep the experiment, which FMI 3.0 sets on entering the Initialization Mode."""
        self.experiment = (tolerance is not None, tolerance or 0.0, 0.0, True, stop_time)

    def enter(self) -> int:
        """Enter the Initialization Mode."""
        return self.call("EnterInitializationMode", *self.experiment)

    def step(self, time: float, step: float) -> tuple[int, bool]:
        """Do one step; return its status, and whether it ended the run.

        Raises
        ------
        FmuError
            The FMU needs an event or did not reach the end of the step.
        """
        self.event.value = self.terminate.value = self.early.value = False
        status: int = self.slave.fmi3DoStep(self.slave.component, time, step, True, *self.outputs)
        if self.terminate.value:
            return status, True
        if self.early.value:
            problem = f"`fmi3DoStep` of `{self.model}` returned early, at t = {self.reached.value:.9g} s"
            raise FmuError(f"{problem}, without permission", "Export it without early return.")
        if self.event.value:
            problem = f"`{self.model}` needs the Event Mode (`eventHandlingNeeded`), which is not supported"
            raise FmuError(problem, "Export it with events handled inside `fmi3DoStep`.")
        return status, False


VERSIONS: dict[int, type[Fmi2 | Fmi3]] = {2: Fmi2, 3: Fmi3}
"""Binding of each major version of FMI."""
