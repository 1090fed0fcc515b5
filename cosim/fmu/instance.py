"""One instance of an FMI 2.0 co-simulation FMU, driven through FMPy."""

from __future__ import annotations

import contextlib
import ctypes
import logging
import os
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from numpy.typing import NDArray

from cosim.closing import Closing
from cosim.errors import FmuError, concerning
from cosim.fmu.archive import FmuFile, Variable
from cosim.fmu.library import check_headers, check_library
from cosim.fmu.messages import Messages
from cosim.fmu.named import ALONE, NamedFmu
from cosim.fmu.values import beyond, expand
from cosim.warned import warn_once

BASE = {
    "Real": "Real",
    "Integer": "Integer",
    "Enumeration": "Integer",
    "Boolean": "Boolean",
    "String": "String",
}
"""FMI function of each type; enumerations are integers."""
CTYPE: dict[str, Any] = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int}
WARNING, DISCARD = 1, 2
TERMINATED = 3
"""Kind of status that states whether a discarded step ends the run."""
STATUS = {0: "fmi2OK", 1: "fmi2Warning", 2: "fmi2Discard", 3: "fmi2Error", 4: "fmi2Fatal", 5: "fmi2Pending"}

log = logging.getLogger("cosim")
_loading = threading.Lock()
"""Locked while FMPy changes the working directory, which the threads of a process share."""


class Bank:
    """Variables of one base type that one FMI call transfers through an array shared with numpy.

    Parameters
    ----------
    base
        Real, Integer or Boolean.
    variables
        The variables; `values[i]` belongs to `variables[i]`.
    """

    def __init__(self, base: str, variables: list[Variable]) -> None:
        count = len(variables)
        self.base = base
        self.variables = variables
        self.references = (ctypes.c_uint * count)(*(variable.reference for variable in variables))
        self.buffer = (CTYPE[base] * count)()
        self.values: NDArray[Any] = np.frombuffer(self.buffer, np.dtype(CTYPE[base]))


def banks(variables: list[Variable]) -> list[Bank]:
    """Group variables by base type; Strings are not used in a closed loop."""
    groups = {base: [v for v in variables if BASE[v.kind] == base] for base in CTYPE}
    return [Bank(base, group) for base, group in groups.items() if group]


class Instance(Closing):
    """An instantiated FMU.

    Life: `initialise` (which resets a used instance), then `compute` in every step, then `close`.

    Parameters
    ----------
    file
        The opened FMU.
    inputs, outputs
        Variables that `compute` moves in every step; local variables may be among the outputs.
    log_events
        Whether the FMU logs events in addition to warnings and errors.
    owner
        Its entry in the scenario, for messages.

    Attributes
    ----------
    warned
        Function and time (s) of the first call of a run that returned fmi2Warning.
    ended
        Start (s) of the step in which the FMU ended the run; None if it did not.
    """

    def __init__(
        self,
        file: FmuFile,
        inputs: list[Variable],
        outputs: list[Variable],
        log_events: bool = False,
        owner: NamedFmu = ALONE,
    ) -> None:
        self.file = file
        self.owner = owner
        self.name = owner.name
        self.driven = inputs
        self.recorded = outputs
        self.log_events = log_events
        self.inputs = banks(inputs)
        self.outputs = banks(outputs)
        self.called = file.name if owner.alone else owner.name
        self.messages = Messages(self.called)
        self.closed = False
        self.warned: tuple[str, float] | None = None
        self.ended: float | None = None
        self._instantiate()

    def _instantiate(self) -> None:
        self.slave = load_library(self.file, self.name)
        self.used, self.running, self.dead = False, False, True
        with self.errors(f"instantiate the FMU `{self.called}`"):
            try:
                self.slave.instantiate(callbacks=self.messages.callbacks, loggingOn=self.log_events)
            except Exception:
                if self.log_events or self.messages.kept:
                    raise
                # some FMUs log their reason only with logging on
                self.slave.instantiate(callbacks=self.messages.callbacks, loggingOn=True)
        self.dead = False
        check_headers(self.slave, self.file.path.name)
        self._setters = [self._mover("Set", bank) for bank in self.inputs]
        self._getters = [self._mover("Get", bank) for bank in self.outputs]

    def _mover(self, verb: str, bank: Bank) -> Callable[[float], None]:
        """One FMI get or set call with its arguments bound; it is called with the time, s."""
        name = f"fmi2{verb}{bank.base}"
        function = getattr(self.slave, name)
        arguments = (self.slave.component, bank.references, len(bank.variables), bank.buffer)

        def move(time: float) -> None:
            if function(*arguments) == WARNING:
                self._warn(name, time)

        return move

    def _warn(self, function: str, time: float) -> None:
        self.warned = self.warned or (function, time)

    def initialise(self, parameters: dict[str, Any], stop_time: float, arrive: Callable[[], None]) -> None:
        """Set the start values, and the inputs in the initialization mode; a used instance is reset first.

        An instance that rejects the reset is replaced, with a warning: runs are independent of each other.

        Parameters
        ----------
        parameters
            Start values by variables.
        stop_time
            Largest time that a step of the run may reach, s.
        arrive
            Writes the inputs of t = 0 to the arrays of `inputs`; called in the initialization mode.

        Raises
        ------
        FmuError
            Unknown variable, a value of the wrong type, the FMU rejected it (with the message of the FMU), or
            the instance is closed.
        """
        if self.closed:
            raise FmuError(f"`{self.called}` is closed; a new run needs a new session")
        if self.dead:
            raise FmuError(
                f"`{self.called}` has failed permanently (fmi2Fatal); a new run needs a new instance"
            )
        if self.used:
            self._reset()
        self.used, self.running, self.warned, self.ended = True, False, None, None
        if self.file.start_time:
            begins = f"its `DefaultExperiment` starts at {self.file.start_time:g} s, this run at 0 s"
            warn_once(f"{self.owner.who}: {begins}")
        with self.errors("set up the experiment" + ("" if self.owner.alone else f" of `{self.name}`")):
            self.slave.setupExperiment(tolerance=self.file.tolerance, startTime=0.0, stopTime=stop_time)
        for variable, value in expand(self.file.variables, parameters, self.owner):
            refused = f"the FMU rejected `{self.name}.{variable.name}` = `{value}`"
            with concerning(f"{self.name}.parameters.{variable.name}"), self.errors(refused):
                getattr(self.slave, f"set{BASE[variable.kind]}")([variable.reference], [value])
            if limit := beyond(variable, value):
                warn_once(f"`{self.name}.{variable.name}` = `{value}` is {limit}")
        refused = (
            f"{self.owner.who} rejected its parameters" if parameters else f"initialize {self.owner.who}"
        )
        with self.errors(refused):
            if self.slave.enterInitializationMode() == WARNING:
                self._warn("fmi2EnterInitializationMode", 0.0)
        arrive()
        with self.errors(f"set the inputs of {self.owner.who} at t = 0 s"):
            self._move(self._setters, 0.0)
        with self.errors(refused):
            if self.slave.exitInitializationMode() == WARNING:
                self._warn("fmi2ExitInitializationMode", 0.0)
        self.running = True
        with self.errors(f"read the outputs of {self.owner.who}"):
            self._move(self._getters, 0.0)

    def _reset(self) -> None:
        try:
            with self.errors(f"reset {self.owner.who}"):
                self.slave.reset()
        except FmuError as error:
            reason = error.message.partition(": ")[2]
            warn_once(
                f"{self.owner.who}: every run gets a new instance, because it cannot be reset: {reason}"
            )
            self._free()
            self._instantiate()

    def read(self, variable: Variable) -> float:
        """Read the present value of one variable as a number."""
        with self.errors(f"read `{self.name}.{variable.name}`"):
            return float(getattr(self.slave, f"get{BASE[variable.kind]}")([variable.reference])[0])

    def read_inputs(self) -> None:
        """Read the start values of all input banks."""
        with self.errors(f"read the inputs of {self.owner.who}"):
            self._move([self._mover("Get", bank) for bank in self.inputs], 0.0)

    def compute(self, time: float, step: float) -> bool:
        """Write the inputs, do the step from `time` to `time + step` (s) and read the outputs.

        Returns
        -------
        bool
            Whether the FMU ended the run in this step.
        """
        self._move(self._setters, time)
        try:
            if self.slave.fmi2DoStep(self.slave.component, time, step, 1) == WARNING:
                self._warn("fmi2DoStep", time)
        except FMICallException as error:
            if error.status != DISCARD or not self._terminated():
                raise
            self.ended = time
        self._move(self._getters, time)
        return self.ended is not None

    def _move(self, moves: list[Callable[[float], None]], time: float) -> None:
        for move in moves:
            move(time)

    def _terminated(self) -> bool:
        try:
            return bool(self.slave.getBooleanStatus(TERMINATED))
        except FMICallException:
            return False

    def report(self) -> None:
        """Log the first fmi2Warning of a run, and that the FMU ended it."""
        if self.warned:
            function, time = self.warned
            warn_once(f"{self.owner.who}: `{function}` returned fmi2Warning at t = {time:.9g} s")
        if self.ended is not None:
            status = "`fmi2DoStep` returned fmi2Discard with fmi2Terminated"
            warn_once(f"{self.owner.who} ended the run in the step at t = {self.ended:.9g} s: {status}")

    @contextlib.contextmanager
    def errors(self, action: str) -> Iterator[None]:
        """Convert a failed FMI call into an error with the action and the message of the FMU."""
        try:
            yield
        except FmuError:
            raise
        except FMICallException as error:
            raise self.failure(action, error) from None
        except Exception as error:  # FMPy raises bare exceptions, for example when instantiation fails
            words = self.messages.take()
            raise FmuError(f"{refusal(action)}: {words or error}") from None
        self.messages.take()

    def failure(self, action: str, error: FMICallException) -> FmuError:
        """Error of a failed FMI call; after fmi2Fatal the instance is not called again."""
        self.running, self.dead = False, error.status >= 4
        words = self.messages.take() or "the FMU logged no reason"
        status = STATUS.get(error.status, str(error.status))
        return FmuError(f"{refusal(action)}: {words} ({error.function} returned {status})")

    def close(self) -> None:
        """Terminate and free the instance; errors are logged and do not affect the result."""
        if self.running:
            self.terminate()
        if not self.closed:
            self._free()
        self.running, self.closed = False, True
        self.messages.close()

    def _free(self) -> None:
        if not self.dead:
            self.slave.freeInstance()

    def terminate(self) -> None:
        """End the run; a failing FMU is logged."""
        try:
            self.slave.terminate()
        except FMICallException as error:
            log.warning("%s", self.failure(f"terminate `{self.called}`", error).message)


def refusal(action: str) -> str:
    """Start of the message: the failed action, or the rejection by the FMU."""
    return action if action.startswith("the FMU") else f"cannot {action}"


def load_library(file: FmuFile, name: str) -> Any:
    """Load the FMU's library for an instance of that name."""
    check_library(file.folder, file.identifier, file.path.name)
    try:
        with _loading, working_directory_kept():
            return FMU2Slave(
                guid=file.guid,
                modelIdentifier=file.identifier,
                unzipDirectory=str(file.folder),
                instanceName=name,
            )
    except FmuError:
        raise
    except AttributeError as error:
        raise FmuError(
            f"the library of `{file.name}` lacks an FMI function: {error}",
            "Check the FMU with `fmpy validate`.",
        ) from None
    except Exception as error:  # FMPy raises bare exceptions here
        raise FmuError(
            f"cannot load the library of `{file.name}`: {error}",
            "Check the platform of the library and its dependencies.",
        ) from None


@contextlib.contextmanager
def working_directory_kept() -> Iterator[None]:
    """Restore the working directory, which FMPy does not if a library cannot be loaded."""
    try:
        folder = os.getcwd()  # noqa: PTH109
    except FileNotFoundError:
        raise FmuError("the working directory no longer exists", "Change to another directory.") from None
    try:
        yield
    finally:
        os.chdir(folder)
