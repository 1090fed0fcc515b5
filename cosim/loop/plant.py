"""What the harness asks of a plant, and how plants are found."""

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
from cosim.errors import CosimError, PlantError, closest, concerning
from cosim.loop import own_code
from cosim.scenario.tables import parse, parse_value, readers, show

MJCF = ".xml"
"""Ending of the names of plants that are MJCF files."""
METHODS = ("reset", "sense", "command", "advance", "truth")
log = logging.getLogger("cosim")
SHAPE = "`cosim.loop.plant.Plant` is the shape of a plant, `Channel` that of its channels"


class Channel(Protocol):
    """A reading, command or truth of a plant.

    The harness applies `noise` (standard deviation), `quantum` (resolution, 0 is continuous), `minimum` and
    `maximum` to readings and commands. A command may have a `start` (0 without one): what the plant gets
    where nothing drives it.
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
    """A plant as the reference loop drives it; any class of this shape will do.

    One that also has a method `close()` is told with it that it is not wanted any more.
    """

    Parameters: ClassVar[type]

    @property
    def readings(self) -> tuple[Channel, ...]:
        """What the controller may measure."""

    @property
    def commands(self) -> tuple[Channel, ...]:
        """What the controller may command."""

    @property
    def truths(self) -> tuple[Channel, ...]:
        """What is recorded besides, and known to nobody in the loop."""

    @property
    def timestep(self) -> float:
        """One plant step, s."""

    def reset(self, seed: np.random.SeedSequence, duration: float) -> None:
        """Start anew; all random numbers of a run of `duration` seconds come from `seed`."""

    def sense(self) -> NDArray[np.float64]:
        """Ideal readings at the present time, in the order of `readings`."""

    def command(self, values: NDArray[np.float64]) -> None:
        """Take the commands, in the order of `commands`; they hold until the next."""

    def advance(self, substeps: int) -> None:
        """Move on by `substeps * timestep` seconds."""

    def truth(self) -> NDArray[np.float64]:
        """Truths at the present time, in the order of `truths`."""


def plant_class(name: str, folder: Path) -> Any:
    """Class of a plant: a name of the package `plants`, an MJCF file, or `module:Class` of your own.

    Parameters
    ----------
    name
        Name of the plant; empty is a plant without channels, for an FMU that runs alone.
    folder
        Folder of the scenario file, in which MJCF files and modules are looked for, too.

    Raises
    ------
    PlantError
        No such plant, file, module or class, or an MJCF file that MuJoCo cannot load.
    """
    physics.ready()
    if not name:
        return bare(Path(importlib.import_module("plants").__path__[0], "bare", f"empty{MJCF}"))
    if name.endswith(MJCF):
        return bare(paths.find_mjcf(name, folder))
    module_name, colon, class_name = name.partition(":")
    if not colon:
        return packaged(name)
    try:
        module = own_code.module(module_name, folder)
    except Exception as error:
        raise PlantError(
            f"cannot import the plant `{name}`: {type(error).__name__}: {error}", own_code.where(folder)
        ) from error
    if not hasattr(module, class_name):
        public = [key for key, value in vars(module).items() if isinstance(value, type)]
        raise PlantError(
            f"the module `{module_name}` has no class `{class_name}`", closest(class_name, public)
        )
    return getattr(module, class_name)


def exited(name: str, error: SystemExit) -> PlantError:
    """Error of a plant that would end the process."""
    problem = f"the plant `{name}` ended the process: `sys.exit({error.code!r})`"
    return PlantError(problem, "a plant raises an exception for what it cannot do")


def bare(file: Path) -> Any:
    """Class of the plant that an MJCF file describes."""
    try:
        return importlib.import_module("plants.bare").load(file)
    except ImportError as error:
        raise PlantError(f"cannot import the package `plants`: {error}", "run `cargo xtask setup`") from error
    except RuntimeError as error:
        problem, _, hint = str(error).partition("\nhint: ")
        raise PlantError(problem, hint) from None


def packaged(name: str) -> Any:
    """Class of one of the plants that come with the project."""
    try:
        plants: Any = importlib.import_module("plants")
    except ImportError as error:
        raise PlantError(f"cannot import the package `plants`: {error}", "run `cargo xtask setup`") from error
    names = list(plants.names())
    if name in names:
        try:
            return plants.load(name)
        except Exception as error:  # whatever the module of a new plant does wrong
            problem, _, hint = str(error).partition("\nhint: ")
            if isinstance(error, ImportError):
                hint = f"`plants/{name}.py` must be there; `cargo xtask setup` builds and installs the rest"
            text = f"cannot import the plant `{name}`: {type(error).__name__}: {problem}"
            raise PlantError(text, hint or "`-v` shows where") from error
    raise PlantError(
        f"there is no plant `{name}`",
        closest(name, names) + f"; your own is named `module:Class`, an MJCF file `name{MJCF}`",
    )


def build(name: str, parameters: dict[str, Any], folder: Path) -> Plant:
    """Build a plant with parameters checked against the fields, types and ranges of its `Parameters`.

    Raises
    ------
    PlantError
        Unknown plant or parameter, wrong type, value out of its range, or the plant refused its parameters.
    """
    with concerning("plant.name"):
        kind = plant_class(name, folder)
    values = check_parameters(kind, parameters)
    try:
        plant: Plant = kind(values)
    except (CosimError, KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:
        problem, _, hint = str(error).partition("\nhint: ")
        if isinstance(error, ValueError):
            raise PlantError(f"the plant `{name}` refused its parameters: {problem}", hint) from error
        raise PlantError(f"the plant `{name}` cannot be built: {problem}", hint) from error
    check_shape(plant, name)
    return plant


def close(plant: Plant, name: str) -> None:
    """Close a plant that can be closed; what goes wrong costs no result, it is logged."""
    try:
        getattr(plant, "close", lambda: None)()
    except (Exception, SystemExit) as error:
        log.warning("the plant `%s` failed while it was closed: %s: %s", name, type(error).__name__, error)


def record_qpos(plant: Any, name: str) -> None:
    """Make MuJoCo's `qpos` a part of what is recorded of a plant.

    Raises
    ------
    PlantError
        The plant has none, or cannot add it.
    """
    if not hasattr(plant, "record_qpos"):
        raise PlantError(f"the plant `{name}` has no `qpos`", "only plants of `plants` and MJCF files have")
    try:
        plant.record_qpos()
    except RuntimeError as error:
        raise PlantError(str(error)) from error


def check_parameters(kind: Any, parameters: dict[str, Any]) -> Any:
    """Parameters of a plant's class from a table, checked as for `build`; defaults are the plant's own."""
    check_class(kind)
    return parse(kind.Parameters, parameters, "plant", refuse)


def check_parameter(kind: Any, name: str, value: Any) -> Any:
    """Value of one parameter of a plant's class that `check_parameters` has seen."""
    return parse_value(kind.Parameters, name, value, "plant", refuse)


def refuse(key: str, problem: str, hint: str) -> NoReturn:
    """Raise for a wrong parameter."""
    problem = "is not a parameter of this plant" if problem == "is not a known key" else problem
    with concerning(key.replace("plant.", "plant.parameters.", 1)):
        raise PlantError(f"`{key}` {problem}", hint)


def check_class(kind: Any) -> None:
    """Check that something is the class of a plant: its methods, and its parameters as a dataclass.

    Raises
    ------
    PlantError
        Names what is missing.
    """
    name = f"{getattr(kind, '__module__', 'module')}:{getattr(kind, '__name__', kind)}"
    parameters: Any = getattr(kind, "Parameters", None)
    problem = ""
    if not isinstance(kind, type):
        problem = "is no class"
    elif missing := [method for method in METHODS if not callable(getattr(kind, method, None))]:
        problem = f"has no method `{missing[0]}`"
    elif not dataclasses.is_dataclass(parameters):
        problem = "has no dataclass `Parameters`"
    else:
        try:
            readers(cast("Hashable", parameters))
        except Exception as error:  # whatever its annotations say
            problem = f"has `Parameters` whose types cannot be told: {type(error).__name__}: {error}"
    if problem:
        with concerning("plant.name"):
            raise PlantError(f"`{name}` {problem}, so it is no plant", SHAPE)


def check_shape(plant: Plant, name: str) -> None:
    """Check channels and time step of a plant that was built.

    Raises
    ------
    PlantError
        Names the first that is wrong.
    """
    try:
        step: Any = plant.timestep
        if isinstance(step, bool) or not isinstance(step, int | float) or not 0.0 < step < math.inf:
            raise PlantError(f"`timestep` is {show(step)}, it must be a positive number of seconds")
        for group in ("readings", "commands", "truths"):
            check_channels(group, getattr(plant, group))
    except Exception as error:
        problem = error.message if isinstance(error, PlantError) else f"{type(error).__name__}: {error}"
        with concerning("plant.name"):
            raise PlantError(f"the plant `{name}` has not the shape of one: {problem}", SHAPE) from error


def starts(channels: Sequence[Channel]) -> NDArray[np.float64]:
    """Values that commands have until something drives them."""
    return np.array([start(channel) for channel in channels], dtype=float)


def start(channel: Channel) -> float:
    """Value that a command has until something drives it, 0 where its channel says none."""
    value: float = getattr(channel, "start", 0.0)
    return value


def one_each(values: Any, channels: Sequence[Channel], method: str) -> Any:
    """Return the values that a method of a plant gave, if there is one for each of its channels.

    Raises
    ------
    PlantError
        There are more or fewer; a single number would stand for all of them.
    """
    if np.shape(values) != (len(channels),):
        found = f"values of shape `{np.shape(values)}`" if np.ndim(values) else f"the single value `{values}`"
        raise PlantError(f"`{method}` of the plant gave {found}, {len(channels)} channels need one each")
    return values


def check_channels(group: str, channels: Any) -> None:
    """Check the channels of one group: each with its own name, text and numbers."""
    if not isinstance(channels, list | tuple):
        raise PlantError(f"`{group}` is {show(channels)}, it must be a tuple of channels")
    names = [channel.name for channel in channels]
    for channel in channels:
        where = f"`{channel.name}` of `{group}`"
        for key in ("name", "unit", "description"):
            if not isinstance(getattr(channel, key), str):
                raise PlantError(f"{where} has the {key} {show(getattr(channel, key))}, it must be a text")
        if names.count(channel.name) > 1:
            raise PlantError(f"{where} is there twice")
        for key in ("noise", "quantum"):
            if not 0.0 <= getattr(channel, key) < math.inf:
                raise PlantError(f"{where} has the {key} {show(getattr(channel, key))}, it must be 0 or more")
        if not math.isfinite(start(channel)):
            raise PlantError(f"{where} has the start {show(start(channel))}, it must be finite")
        if not channel.minimum <= channel.maximum:
            raise PlantError(f"{where} is limited to `{channel.minimum}` .. `{channel.maximum}`")
