"""One instance of a co-simulation FMU."""

from __future__ import annotations

import contextlib
import logging
import os
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from fmpy.fmi1 import FMICallException

from cosim.closing import Closing
from cosim.errors import FmuError, concerning
from cosim.fmu.binding import VERSIONS, Bank, Fmi2, Fmi3
from cosim.fmu.description import FmuFile, Variable
from cosim.fmu.library import check_headers, check_library
from cosim.fmu.messages import Messages
from cosim.fmu.named import ALONE, NamedFmu
from cosim.fmu.values import Value, beyond, expand
from cosim.warned import warn_once

WARNING = 1
STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")

Move = tuple[str, Callable[[], int]]
"""Name and function of a call that moves the values of a bank."""

log = logging.getLogger("cosim")
_read: set[Path] = set()
"""Folders of the FMUs of which every number was read in this process."""
_loading = threading.Lock()
"""Locked while FMPy changes the working directory, which the threads of a process share."""


class Instance(Closing):
    """An instantiated FMU.

    Life: `initialise` (which resets a used instance), then `compute` in every step, then `close`. `compute`
    moves the inputs and outputs; among these may be tunable parameters and local variables.

    Attributes
    ----------
    warned
        Function and time (s) of the first call of a run that returned a warning.
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
        binding, whole = VERSIONS[file.version], file.whole(inputs)
        self.partial = len(whole) > len(inputs)
        self.inputs = binding.banks(whole)
        self.outputs = binding.banks(file.whole(outputs))
        self.called = file.name if owner.alone else owner.name
        self.messages = Messages(self.called)
        self.closed = False
        self.warned: tuple[str, float] | None = None
        self.ended: float | None = None
        try:
            self._instantiate()
        except BaseException:
            self.messages.close()
            raise

    def _instantiate(self) -> None:
        self.fmi = load_library(self.file, self.name)
        self.used, self.running, self.dead = False, False, True
        with self.errors(f"instantiate the FMU `{self.called}`"):
            try:
                self.fmi.instantiate(self.messages, self.log_events)
            except Exception:
                if self.log_events or self.messages.kept:
                    raise
                # some FMUs log their reason only with logging on
                self.fmi.instantiate(self.messages, True)
        self.dead = False
        check_headers(self.fmi.slave, self.fmi.answers, self.file.path.name)
        self._setters = self._moves("Set", self.inputs)
        self._getters = self._moves("Get", self.outputs)

    def _moves(self, verb: str, banks: list[Bank]) -> list[Move]:
        return [(verb + bank.base, self.fmi.mover(verb, bank)) for bank in banks]

    def _move(self, moves: list[Move], time: float = 0.0) -> None:
        for name, function in moves:
            self._note(name, function(), time)

    def _note(self, function: str, status: int, time: float = 0.0) -> None:
        """Note the first warning of a run, and its time (s)."""
        if status == WARNING:
            self.warned = self.warned or (self.fmi.prefix + function, time)

    def initialise(self, parameters: dict[str, Any], stop_time: float, arrive: Callable[[], None]) -> None:
        """Set the start values, and the inputs in the initialization mode; a used instance is reset first.

        An instance that rejects the reset is replaced, with a warning: runs are independent of each other.
        `stop_time` (s) is the largest time that a step of the run may reach. `arrive` writes the inputs of
        t = 0 to the arrays of `inputs`; it is called in the initialization mode.

        Raises
        ------
        FmuError
            Unknown variable, a value of the wrong type, the FMU rejected it (with the message of the FMU), or
            the instance is closed.
        """
        if self.closed:
            raise FmuError(f"`{self.called}` is closed; a new run needs a new session")
        if self.dead:
            failed = f"`{self.called}` has failed permanently ({self.fmi.prefix}Fatal or a crash)"
            raise FmuError(f"{failed}; a new run needs a new instance")
        if self.used:
            self._reset()
        self.used, self.running, self.warned, self.ended = True, False, None, None
        if self.file.start_time:
            begins = f"its `DefaultExperiment` starts at {self.file.start_time:g} s, this run at 0 s"
            warn_once(f"{self.owner.who}: {begins}")
        with self.errors("set up the experiment" + ("" if self.owner.alone else f" of `{self.name}`")):
            self.fmi.set_up(self.file.tolerance, stop_time)
        for name, variable, values in self._starts(parameters):
            shown = values[0] if name == variable.name else values
            refused = f"the FMU rejected `{self.name}.{name}` = `{shown}`"
            with concerning(f"{self.name}.parameters.{name}"), self.errors(refused):
                self.fmi.set_start(variable, values)
            for value in values:
                if limit := beyond(variable, value):
                    warn_once(f"`{self.name}.{name}` = `{value}` is {limit}")
        refused = (
            f"{self.owner.who} rejected its parameters" if parameters else f"initialize {self.owner.who}"
        )
        with self.errors(refused):
            self._note("EnterInitializationMode", self.fmi.enter())
        if self.partial:
            # the elements of an array that nothing drives keep their start values
            self.read_inputs()
        arrive()
        with self.errors(f"set the inputs of {self.owner.who} at t = 0 s"):
            self._move(self._setters)
        with self.errors(refused):
            self._note("ExitInitializationMode", self.fmi.call("ExitInitializationMode"))
        self.running = True
        with self.errors(f"read the outputs of {self.owner.who}"):
            self._move(self._getters)

    def _starts(self, parameters: dict[str, Any]) -> list[tuple[str, Variable, list[Value]]]:
        """Start values to set: name, variable and values; an array is set as a whole."""
        arrays: dict[str, list[Value]] = {}
        found = []
        for variable, value in expand(self.file.variables, parameters, self.owner):
            values = [value]
            if variable.array and variable.array in arrays:
                arrays[variable.array][variable.element] = value
                continue
            if variable.array:
                values = [start(one) for one in self.file.whole([variable])]
                values[variable.element] = value
                arrays[variable.array] = values
            found.append((variable.array or variable.name, variable, values))
        return found

    def _reset(self) -> None:
        try:
            with self.errors(f"reset {self.owner.who}"):
                self.fmi.slave.reset()
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
            (bank,) = self.fmi.banks(self.file.whole([variable]))
            self._move(self._moves("Get", [bank]))
            return float(bank.values[variable.element])

    def read_inputs(self) -> None:
        """Read the start values of all input banks."""
        with self.errors(f"read the inputs of {self.owner.who}"):
            self._move(self._moves("Get", self.inputs))

    def compute(self, time: float, step: float) -> bool:
        """Write the inputs, do the step from `time` to `time + step` (s) and read the outputs.

        Returns whether the FMU ended the run in this step.
        """
        self._move(self._setters, time)
        status, ended = self.fmi.step(time, step)
        self._note("DoStep", status, time)
        if ended:
            self.ended = time
        self._move(self._getters, time)
        return ended

    def report(self) -> None:
        """Log the first warning status of a run, and that the FMU ended it."""
        if self.warned:
            function, time = self.warned
            warn_once(f"{self.owner.who}: `{function}` returned {self.fmi.prefix}Warning at t = {time:.9g} s")
        if self.ended is not None:
            status = f"`{self.fmi.prefix}DoStep` returned {self.fmi.ending}"
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
        except OSError as error:
            raise self.crashed(action, error) from None
        except Exception as error:  # FMPy raises bare exceptions, for example when instantiation fails
            words = self.messages.take()
            raise FmuError(f"{refusal(action)}: {words or error}") from None
        self.messages.take()

    def failure(self, action: str, error: FMICallException) -> FmuError:
        """Error of a failed FMI call; after a fatal one the instance is not called again."""
        self.running, self.dead = False, error.status >= 4
        words = self.messages.take() or "the FMU logged no reason"
        known = error.status in range(len(STATUS))
        status = self.fmi.prefix + STATUS[error.status] if known else str(error.status)
        return FmuError(f"{refusal(action)}: {words} ({error.function} returned {status})")

    def crashed(self, action: str, error: OSError) -> FmuError:
        """Error of an access violation, which ctypes reports on Windows; the instance is not called again."""
        self.running, self.dead = False, True
        words = self.messages.take()
        return FmuError(f"{refusal(action)}: {error}" + (f"; {words}" if words else ""))

    def read_all(self) -> None:
        """Read every number after a run, once in a process for each file; log the first rejected variable.

        A rejected call ends an instance, so the variables after the first are not read.
        """
        if self.file.folder in _read:
            return
        _read.add(self.file.folder)
        for variable in self.file.variables.values():
            if not variable.base or variable.element:
                continue
            try:
                self.read(variable)
            except FmuError as error:
                unknown = f"`{variable.name}` (value reference {variable.reference})"
                log.warning("%s does not know its variable %s: %s", self.owner.who, unknown, error.message)
                return

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
            self._logged("free", self.fmi.slave.freeInstance)

    def terminate(self) -> None:
        """End the run; a failing FMU is logged."""
        self._logged("terminate", partial(self.fmi.call, "Terminate"))

    def _logged(self, action: str, function: Callable[[], object]) -> None:
        """Call a function at the end of an instance or run; a failure is logged."""
        try:
            with self.errors(f"{action} `{self.called}`"):
                function()
        except FmuError as error:
            log.warning("%s", error.message)


def refusal(action: str) -> str:
    """Start of the message: the failed action, or the rejection by the FMU."""
    return action if action.startswith("the FMU") else f"cannot {action}"


def start(variable: Variable) -> Value:
    """Start value of an element of an array."""
    match variable.base:
        case "Boolean":
            return variable.start in ("true", "1")
        case "Integer":
            return int(variable.start or 0)
    return float(variable.start or 0.0)


def load_library(file: FmuFile, name: str) -> Fmi2 | Fmi3:
    """Load the FMU's library for an instance of that name."""
    check_library(file)
    with _loading:
        try:
            folder = os.getcwd()  # noqa: PTH109
        except FileNotFoundError:
            raise FmuError("the working directory no longer exists", "Change to another directory.") from None
        try:
            # FMPy does not restore the working directory if a library cannot be loaded
            with contextlib.chdir(folder):
                return VERSIONS[file.version](file, name)
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
