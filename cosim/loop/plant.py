"""The interface of a plant, and the search for plants."""

from __future__ import annotations

import dataclasses
import importlib
import logging
import math
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import Any, ClassVar, NoReturn, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from cosim import paths, physics
from cosim.errors import CosimError, PlantError, closest, concerning, show
from cosim.loop import own_code
from cosim.scenario.tables import parse, parse_value, readers

MJCF = (".xml", ".urdf")
"""File name extensions of the models that MuJoCo reads."""
METHODS = ("reset", "sense", "command", "advance", "truth")
log = logging.getLogger("cosim")
SHAPE = "Follow the protocols `Plant` and `Channel` in `cosim.loop.plant`."


class Channel(Protocol):
    """A measurement, command or ground-truth signal of a plant.

    The harness applies `noise` (standard deviation), `quantum` (resolution, 0 is continuous), `minimum` and
    `maximum` to measurements and commands. A command may have a `start` (default 0): its value
    while nothing drives it.
    """

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def unit(self) -> str: ...  # noqa: D102
    @property
    def description(self) -> str: ...  # noqa: D102
    @property
    def noise(self) -> float: ...  # noqa: D102
    @property
    def quantum(self) -> float: ...  # noqa: D102
    @property
    def minimum(self) -> float: ...  # noqa: D102
    @property
    def maximum(self) -> float: ...  # noqa: D102


class Plant(Protocol):
    """The interface of a plant; any class with these members is a plant.

    An optional method `close()` is called after the last run.
    """

    Parameters: ClassVar[type]

    @property
    def readings(self) -> tuple[Channel, ...]:
        """Measurements for the controller."""

    @property
    def commands(self) -> tuple[Channel, ...]:
        """Commands from the controller."""

    @property
    def truths(self) -> tuple[Channel, ...]:
        """Recorded ground-truth signals, unknown to the controller."""

    @property
    def timestep(self) -> float:
        """One plant step, s."""

    def reset(self, seed: np.random.SeedSequence, duration: float) -> None:
        """Reset; all random numbers of a run of `duration` seconds come from `seed`."""

    def sense(self) -> NDArray[np.float64]:
        """Ideal measurements at the present time, in the order of `readings`."""

    def command(self, values: NDArray[np.float64]) -> None:
        """Set the commands, in the order of `commands`; they are held until the next call."""

    def advance(self, substeps: int) -> None:
        """Advance by `substeps * timestep` seconds."""

    def truth(self) -> NDArray[np.float64]:
        """Ground truth at the present time, in the order of `truths`."""


def plant_class(name: str, folder: Path) -> Any:
    """Class of a plant: a name of the package `plants`, an MJCF file, or `module:Class` of your own.

    The folder of the scenario file is searched for MJCF files and modules. An empty name is a plant without
    channels, for an FMU that runs alone.
    """
    physics.ready()
    if not name:
        return bare(Path(project_module("plants").__path__[0], "bare", "empty.xml"))
    if name.endswith(MJCF):
        return bare(paths.find_mjcf(name, folder))
    module_name, colon, class_name = name.partition(":")
    if not colon:
        return packaged(name)
    try:
        module = own_code.module(module_name, folder)
    except Exception as error:
        problem = f"cannot import the plant `{name}`: {type(error).__name__}: {error}"
        raise PlantError(problem, own_code.where(folder)) from error
    if not hasattr(module, class_name):
        public = [key for key, value in vars(module).items() if isinstance(value, type)]
        problem = f"the module `{module_name}` has no class `{class_name}`"
        raise PlantError(problem, closest(class_name, public))
    return getattr(module, class_name)


def exited(name: str, error: SystemExit) -> PlantError:
    """Error of a plant that calls `sys.exit`."""
    problem = f"the plant `{name}` ended the process: `sys.exit({error.code!r})`"
    return PlantError(problem, "Raise an exception in the plant instead.")


def project_module(name: str) -> Any:
    """Import a module of the project's plants."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        problem = f"cannot import the package `plants`: {error}"
        raise PlantError(problem, "Run `cargo xtask setup`.") from error


def problem_and_hint(error: BaseException) -> tuple[str, str]:
    """Text of an error of a plant's code, and the hint in it."""
    problem, _, hint = str(error).partition("\nhint: ")
    return problem, hint


def bare(file: Path) -> Any:
    """Class of the plant that an MJCF file describes."""
    try:
        return project_module("plants.bare").load(file)
    except RuntimeError as error:
        raise PlantError(*problem_and_hint(error)) from None


def packaged(name: str) -> Any:
    """Class of one of the project's plants."""
    plants = project_module("plants")
    names = list(plants.names())
    if name not in names:
        hint = closest(name, names) + " Name your own plant `module:Class`, an MJCF file `name.xml`."
        raise PlantError(f"there is no plant `{name}`", hint)
    try:
        return plants.load(name)
    except Exception as error:  # the module of a new plant may raise anything
        problem, hint = problem_and_hint(error)
        if isinstance(error, ImportError):
            hint = f"Check `plants/{name}.py`, and run `cargo xtask setup`."
        text = f"cannot import the plant `{name}`: {type(error).__name__}: {problem}"
        raise PlantError(text, hint or "Show the origin with `-v`.") from error


def build(name: str, parameters: dict[str, Any], folder: Path) -> Plant:
    """Build a plant with parameters checked against the fields, types and ranges of its `Parameters`."""
    with concerning("plant.name"):
        kind = plant_class(name, folder)
    values = check_parameters(kind, parameters)
    try:
        plant: Plant = kind(values)
    except (CosimError, KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:
        problem, hint = problem_and_hint(error)
        action = "rejected its parameters" if isinstance(error, ValueError) else "cannot be built"
        raise PlantError(f"the plant `{name}` {action}: {problem}", hint) from error
    check_shape(plant, name)
    return plant


def close(plant: Plant, name: str) -> None:
    """Close a plant that has `close`; errors are logged and do not affect the result."""
    try:
        getattr(plant, "close", lambda: None)()
    except (Exception, SystemExit) as error:
        log.warning("the plant `%s` failed while it was closed: %s: %s", name, type(error).__name__, error)


def record_qpos(plant: Any, name: str) -> None:
    """Add MuJoCo's `qpos` to the recorded signals of a plant."""
    if not hasattr(plant, "record_qpos"):
        raise PlantError(f"the plant `{name}` has no `qpos`", "Use a plant of `plants` or an MJCF file.")
    try:
        plant.record_qpos()
    except RuntimeError as error:
        raise PlantError(str(error)) from error


def check_parameters(kind: Any, parameters: dict[str, Any]) -> Any:
    """Parameters of a plant's class from a table, checked as for `build`; defaults are the plant's own."""
    check_class(kind)
    return parse(kind.Parameters, parameters, "plant", refuse)


def check_parameter(kind: Any, name: str, value: Any) -> Any:
    """Value of one parameter of a plant's class after `check_parameters`."""
    return parse_value(kind.Parameters, name, value, "plant", refuse)


def refuse(key: str, problem: str, hint: str) -> NoReturn:
    """Raise for a wrong parameter."""
    problem = "is not a parameter of this plant" if problem == "is not a known key" else problem
    with concerning(key.replace("plant.", "plant.parameters.", 1)):
        raise PlantError(f"`{key}` {problem}", hint)


def check_class(kind: Any) -> None:
    """Check that an object is the class of a plant: methods, and parameters as a dataclass."""
    name = f"{getattr(kind, '__module__', 'module')}:{getattr(kind, '__name__', kind)}"
    parameters: Any = getattr(kind, "Parameters", None)
    problem = ""
    if not isinstance(kind, type):
        problem = "is not a class"
    elif missing := [method for method in METHODS if not callable(getattr(kind, method, None))]:
        problem = f"has no method `{missing[0]}`"
    elif not dataclasses.is_dataclass(parameters):
        problem = "has no dataclass `Parameters`"
    else:
        try:
            readers(cast("Hashable", parameters))
        except Exception as error:  # annotations may raise anything
            problem = f"has `Parameters` with unknown types: {type(error).__name__}: {error}"
    if problem:
        with concerning("plant.name"):
            raise PlantError(f"`{name}` {problem}, so it is not a plant", SHAPE)


def check_shape(plant: Plant, name: str) -> None:
    """Check channels and time step of a plant instance."""
    try:
        step: Any = plant.timestep
        if isinstance(step, bool) or not isinstance(step, int | float) or not 0.0 < step < math.inf:
            raise PlantError(f"`timestep` is {show(step)}, it must be a positive number of seconds")
        for group in ("readings", "commands", "truths"):
            check_channels(group, getattr(plant, group))
    except Exception as error:
        problem = error.message if isinstance(error, PlantError) else f"{type(error).__name__}: {error}"
        problem = f"the plant `{name}` does not have the interface of a plant: {problem}"
        with concerning("plant.name"):
            raise PlantError(problem, SHAPE) from error


def starts(channels: Sequence[Channel]) -> NDArray[np.float64]:
    """Values of commands until something drives them."""
    return np.array([start(channel) for channel in channels], dtype=float)


def start(channel: Channel) -> Any:
    """Value of a command until something drives it; 0 by default."""
    return getattr(channel, "start", 0.0)


def one_each(values: Any, channels: Sequence[Channel], method: str) -> Any:
    """Return the values of a method of a plant after a check of their number."""
    if np.shape(values) != (len(channels),):
        found = f"values of shape `{np.shape(values)}`" if np.ndim(values) else f"the single value `{values}`"
        raise PlantError(f"`{method}` of the plant gave {found} for {len(channels)} channels")
    return values


def check_channels(group: str, channels: Any) -> None:
    """Check names, texts and numbers of the channels of one group."""
    if not isinstance(channels, list | tuple):
        raise PlantError(f"`{group}` is {show(channels)}, it must be a tuple of channels")
    names = [channel.name for channel in channels]
    for channel in channels:
        where = f"`{channel.name}` of `{group}`"
        for key in ("name", "unit", "description"):
            if not isinstance(getattr(channel, key), str):
                raise PlantError(f"{where} has the {key} {show(getattr(channel, key))}, it must be a text")
        if names.count(channel.name) > 1:
            raise PlantError(f"{where} is defined twice")
        for key in ("noise", "quantum"):
            if not 0.0 <= getattr(channel, key) < math.inf:
                raise PlantError(f"{where} has the {key} {show(getattr(channel, key))}, it must be 0 or more")
        if not math.isfinite(start(channel)):
            raise PlantError(f"{where} has the start {show(start(channel))}, it must be finite")
        if not channel.minimum <= channel.maximum:
            raise PlantError(f"{where} is limited to `{channel.minimum}` .. `{channel.maximum}`")
