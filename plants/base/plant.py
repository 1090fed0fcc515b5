"""Base class of plants: an MJCF file, native elements beyond MJCF, and named channels."""

import math
import sys
import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import mujoco
import numpy as np
from numpy.random import Generator, SeedSequence
from numpy.typing import NDArray

import machining_native as _native
from machining_native import Cell, Circuit, Stepper
from plants.base.coordinates import coordinates
from plants.base.machine import Machine, NotNativeError, address, empty_model, functions
from plants.base.names import Mjcf, native_names, unknown
from plants.base.parameters import check

Array = NDArray[np.float64]
STEPPED = ("sense", "command", "advance", "truth")
"""Methods that native code replaces."""
LOOKS = "looks"
"""Class of the geoms, lights and cameras of an MJCF that are only drawn."""


class PlantError(RuntimeError):
    """A plant cannot continue: the message names plant, time and cause."""


@dataclass(frozen=True)
class Channel:
    """One measurement, command or ground-truth signal.

    Parameters
    ----------
    name : str
        Name, unique among the measurements, the commands and the ground-truth signals.
    unit : str
        SI unit, `1` for a plain number.
    description : str
        Description in one sentence.
    noise : float
        Measurements: standard deviation of the noise that the harness adds before it quantizes.
    quantum : float
        Resolution to which the harness rounds, 0 for none.
    minimum, maximum : float
        Limits that the harness applies.
    start : float
        Commands: value from the reset to the first command; permanent for an undriven command.
    """

    name: str
    unit: str
    description: str
    noise: float = 0.0
    quantum: float = 0.0
    minimum: float = -math.inf
    maximum: float = math.inf
    start: float = 0.0


def vector(
    name: str, unit: str, description: str, axes: str = "xyz", /, **options: float
) -> tuple[Channel, ...]:
    """Channels of a vector, `<name>_<axis>` for each axis, with the options of `Channel`."""
    return tuple(Channel(f"{name}_{axis}", unit, f"{description}, {axis}", **options) for axis in axes)


class Plant(ABC):
    """A MuJoCo model that is stepped by a harness: sense, command, advance.

    A subclass is in `<plant>.py`, next to `<plant>.xml`. It names its channels in `readings`, `commands`
    and `truths`, and writes its parameters into the MJCF in `shape` (a parameter `timestep` is already set).
    In `begin` it generates random values and connects every channel to a cell. One communication step is
    `sense`, `command`, `advance`; `truth` describes the time of the last `sense`. Elements of `circuit` act
    in every plant step. Elements of `sensing` act when measurements are taken, for signals that must be
    computed from the state of that instant.

    A stepped plant has no parts that are only drawn: elements of the MJCF class `looks` are removed to save
    time. `drawn` returns the plant with these parts, and with those that a subclass adds in `dress` and
    moves in `draw`.

    Parameters
    ----------
    parameters : dataclass, optional
        An instance of the `Parameters` of the class; default: its defaults.

    Raises
    ------
    ParameterError
        A parameter has the wrong type or is outside its range.
    PlantError
        The MJCF selects the integrator RK4.
    """

    Parameters: ClassVar[type]
    wires: ClassVar[tuple[str, ...]] = ()
    coordinates: tuple[Channel, ...] = ()

    readings: tuple[Channel, ...]
    commands: tuple[Channel, ...]
    truths: tuple[Channel, ...]

    # truths of the run that is looked at; none for a plant that is stepped
    _shown: Mapping[str, Array] | None = None

    def __init__(self, parameters: Any = None) -> None:
        self.parameters = self.Parameters() if parameters is None else parameters
        self.name = self._mjcf().stem
        check(self.parameters, self.name)
        spec = mujoco.MjSpec.from_file(str(self._mjcf()))
        if hasattr(self.parameters, "timestep"):
            spec.option.timestep = self.parameters.timestep
        self.shape(Mjcf(spec, self._mjcf().name), self.parameters)
        if self._shown is None:
            self._undress(spec)
        else:
            self.dress(Mjcf(spec, self._mjcf().name), self.parameters, self._shown)
        self.model = spec.compile()
        self._refuse_rk4()
        self.data = mujoco.MjData(self.model)
        self.timestep = float(self.model.opt.timestep)
        self.circuit = Circuit()
        self.sensing = Circuit()
        self._signals = np.zeros(max(len(self.wires), 1))
        self._warnings = self.data.warning.number
        self._sensed = False
        self.name_channels(self.parameters)

    @classmethod
    def _mjcf(cls) -> Path:
        return Path(str(sys.modules[cls.__module__].__file__)).with_suffix(".xml")

    def _undress(self, spec: Any) -> None:
        for element in (*spec.geoms, *spec.lights, *spec.cameras):
            if element.classname.name == LOOKS:
                spec.delete(element)

    def _refuse_rk4(self) -> None:
        # mj_step2 would silently integrate with Euler
        if self.model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
            raise PlantError(
                f"plant `{self.name}`: integrator `RK4` cannot be split at the sensors\n"
                "hint: Use `implicitfast` in the <option> of the MJCF, or as `plant.parameters.integrator`."
            )

    # what a subclass says

    @abstractmethod
    def shape(self, spec: Any, p: Any) -> None:
        """Write the parameters `p` into the MJCF (`plants.base.names.Mjcf`) before it is compiled."""

    def name_channels(self, p: Any) -> None:  # noqa: B027
        """Set `readings`, `commands` and `truths` if they depend on the parameters `p`."""

    @abstractmethod
    def begin(self, steps: int) -> None:
        """Generate random values, set the initial state, bind the elements and `connect` the channels.

        `steps` is the number of plant steps for which signals need a sample.
        """

    def dress(self, spec: Any, p: Any, shown: Mapping[str, Array]) -> None:  # noqa: B027
        """Add parts that are only drawn and depend on the parameters `p` or the ground truth of a run."""

    def draw(  # noqa: B027
        self, shown: Mapping[str, Array], row: int, enlarged: Callable[[str, float], float]
    ) -> None:
        """Move parts that are only drawn to a row of `shown`, after `qpos` is set.

        `enlarged` converts a value of a coordinate, given by joint, to the drawn value.
        """

    # what a subclass uses

    def stream(self, source: str) -> Generator:
        """Random numbers of one named source, independent of other sources."""
        key = (*self._seed.spawn_key, zlib.crc32(source.encode()))
        return np.random.default_rng(SeedSequence(self._seed.entropy, spawn_key=key))

    def wire(self, name: str, **options: Any) -> Cell:
        """Cell of a wire between elements, one of `wires`."""
        if name not in self.wires:
            raise unknown(f"wire in `{type(self).__name__}.wires` named", name, self.wires)
        return Cell(self._signals, self.wires.index(name), **options)

    def constant(self, value: float) -> Cell:
        """Cell with the constant `value`."""
        return Cell(np.array([value]))

    def normals(self, source: str, steps: int) -> Cell:
        """Signal of standard normal numbers, one per plant step."""
        return Cell(self.stream(source).standard_normal(steps), stride=1)

    def connect(
        self, readings: Mapping[str, Cell], commands: Mapping[str, Cell], truths: Mapping[str, Cell]
    ) -> None:
        """Connect the channels to cells by name."""
        self.reading_cells = _in_order(self.readings, readings)
        self.command_cells = _in_order(self.commands, commands)
        places = {one.name: Cell(self.data.qpos, i) for i, one in enumerate(self.coordinates)}
        self.truth_cells = _in_order(self.truths, {**truths, **places})

    # what a harness calls

    def drawn(self, shown: Mapping[str, Array]) -> "Plant":
        """Return the plant for drawing; `shown` has the ground truth of a run, a column for each name."""
        plant = type(self).__new__(type(self))
        # before its own `__init__`, which may take the parameters alone
        plant._shown = shown
        plant.__init__(self.parameters)  # type: ignore[misc]
        return plant

    def record_qpos(self) -> None:
        """Add MuJoCo's `qpos` to the ground truth from the next reset on; a second call does nothing.

        Raises
        ------
        PlantError
            The plant has `truth` in Python, or a signal with such a name.
        """
        if type(self).truth is not Plant.truth:
            raise PlantError(f"`qpos` cannot be added to `{type(self).__name__}.truth`, a Python method")
        if self.coordinates:
            return
        text = "Coordinate of MuJoCo, for replay"
        found = tuple(Channel(name, unit, text) for name, unit in coordinates(self.model))
        if taken := {one.name for one in found} & {truth.name for truth in self.truths}:
            raise PlantError(f"plant `{self.name}` has a signal `{min(taken)}` with the name of a coordinate")
        self.coordinates, self.truths = found, (*self.truths, *found)

    def reset(self, seed: int | SeedSequence, duration: float) -> None:
        """Back to time zero; all random numbers of a run of `duration` seconds are generated here.

        Parameters
        ----------
        seed : int or numpy.random.SeedSequence
            Equal seeds give bit-identical runs.
        duration : float
            Time for which the plant can be advanced, s.
        """
        self._seed = seed if isinstance(seed, SeedSequence) else SeedSequence(seed)
        mujoco.mj_resetData(self.model, self.data)
        self._signals[:] = 0.0
        self.circuit = Circuit()
        self.sensing = Circuit()
        with native_names(_native):
            self.begin(round(duration / self.timestep) + 1)
        for channel, cell in zip(self.commands, self.command_cells, strict=True):
            cell.write(channel.start)
        # a step of no time writes the outputs of time zero
        mujoco.mj_forward(self.model, self.data)
        for circuit in (self.circuit, self.sensing):
            circuit.step(0.0)
            circuit.reset()
        self._sensed = False

    def sense(self) -> Array:
        """Ideal measurements at this time, in the order of `readings`."""
        self._attempt(mujoco.mj_step1, self.model, self.data)
        self._check_warnings()
        self._attempt(self.sensing.step, 0.0)
        self._sensed = True
        return np.array(self._read())

    def _check_warnings(self) -> None:
        if any(self._warnings.tolist()):
            kinds = [mujoco.mjtWarning(int(i)).name for i in np.flatnonzero(self._warnings)]
            raise self._error(f"MuJoCo warns: `{'`, `'.join(kinds)}`")

    def _read(self) -> list[float]:
        values = [cell.read() for cell in self.reading_cells]
        if not all(map(math.isfinite, values)):
            raise self._error(_not_finite("reading", self.readings, values))
        return values

    def command(self, values: Array) -> None:
        """Set the commands, in the order of `commands`; they are held until the next call."""
        numbers = values.tolist()
        if not all(map(math.isfinite, numbers)):
            raise self._error(_not_finite("command", self.commands, numbers))
        for cell, value in zip(self.command_cells, numbers, strict=True):
            cell.write(value)

    def advance(self, substeps: int) -> None:
        """Advance by `substeps` plant steps from the last `sense`."""
        if not self._sensed:
            raise self._error("`advance` before `sense`")
        self._sensed = False
        self._attempt(self._advance, substeps)

    def _advance(self, substeps: int) -> None:
        model, data, step, h = self.model, self.data, self.circuit.step, self.timestep
        for substep in range(substeps):
            if substep > 0:
                mujoco.mj_step1(model, data)
            step(h)
            mujoco.mj_step2(model, data)

    def truth(self) -> Array:
        """Return the ground truth at the last `sense`, in the order of `truths`."""
        return np.array([cell.read() for cell in self.truth_cells])

    def check_native(self) -> None:
        """Check that native code can step this plant.

        Raises
        ------
        NotNativeError
            The plant has a part of its step in Python, or MuJoCo gives no addresses.
        """
        for name in STEPPED:
            if getattr(type(self), name) is not getattr(Plant, name):
                raise NotNativeError(f"`{type(self).__name__}.{name}` is written in Python")
        for bound in (self.model, self.data):
            address(bound)
        functions()

    def machine(self) -> Machine:
        """Addresses for a native stepper, valid until the next reset; see `check_native`."""
        return Machine(
            functions=functions(),
            empty=address(empty_model()),
            model=address(self.model),
            data=address(self.data),
            timestep=self.timestep,
            warnings=self.data.warning.number,
            sensing=self.sensing,
            circuit=self.circuit,
            readings=self.reading_cells,
            commands=self.command_cells,
            truths=self.truth_cells,
            owner=self,
        )

    def run(self, stepper: Stepper, until: int) -> tuple[str, int, float] | None:
        """Run a native stepper of this plant to step `until`, as sense, command and advance.

        Returns
        -------
        (str, int, float) or None
            Another cause than the plant for the end of the run, see `Stepper.run`.
        """
        stop: tuple[str, int, float] | None = self._attempt(stepper.run, until)
        match stop:
            case ("warning", _, _):
                self._check_warnings()
            case ("sensed", _, _):
                self._read()
        return stop

    def _attempt(self, function: Callable[..., Any], *arguments: object) -> Any:
        try:
            return function(*arguments)
        except IndexError as error:
            hint = "hint: Call `reset` with the duration of the whole run."
            raise self._error(f"{error}\n{hint}") from error
        except (FloatingPointError, RuntimeError, mujoco.FatalError) as error:
            raise self._error(str(error)) from error

    def _error(self, cause: str) -> PlantError:
        return PlantError(f"plant `{self.name}` at t = `{self.data.time:.6g}` s: {cause}")


def _in_order(channels: Sequence[Channel], cells: Mapping[str, Cell]) -> tuple[Cell, ...]:
    names = [channel.name for channel in channels]
    if sorted(names) != sorted(cells):
        raise ValueError(f"channels `{names}` are connected as `{list(cells)}`")
    return tuple(cells[name] for name in names)


def _not_finite(kind: str, channels: Sequence[Channel], values: Iterable[float]) -> str:
    pairs = [(c, v) for c, v in zip(channels, values, strict=True) if not math.isfinite(v)]
    return f"{kind} " + ", ".join(f"`{channel.name}` is `{value}` {channel.unit}" for channel, value in pairs)
