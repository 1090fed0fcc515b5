"""A plant from only an MJCF file: its sensors are the measurements, its actuators the commands."""

import hashlib
import logging
from pathlib import Path
from typing import Any, ClassVar

import mujoco
import numpy as np

from machining_native import Cell
from plants.bare import channels
from plants.bare.parameters import INTEGRATORS, apply, damping_ratios, named, parameters_of, start
from plants.base.plant import Plant, PlantError

log = logging.getLogger(__name__)
NOT_DIVIDED = "a step of `RK4` cannot be divided at the sensors"


class Bare(Plant):
    """A plant from one MJCF file; `load` makes its class."""

    file: ClassVar[Path]
    ratios: ClassVar[dict[int, float]]
    required: ClassVar[dict[str, tuple[str, str]]]
    """Parameters that must differ from the file: value and reason."""

    def name_channels(self, p: Any) -> None:
        """Use the sensors, actuators and joints of the MJCF, with the numbers of the parameters."""
        apply(p, self.model, self.data, self.ratios)
        self.timestep = float(self.model.opt.timestep)
        # commands start at the `ctrl` of this state
        mujoco.mj_resetData(self.model, self.data)
        start(p, self.model, self.data)
        self._readings = channels.readings(self.model)
        self._commands = channels.commands(self.model, self.data)
        self._truths = channels.truths(self.model, self.data)
        self.readings = tuple(one.channel for one in self._readings)
        self.commands = tuple(one.channel for one in self._commands)
        self.truths = tuple(one.channel for one in self._truths)
        self.begin(0)

    @classmethod
    def _mjcf(cls) -> Path:
        return cls.file

    def shape(self, spec: Any, p: Any) -> None:
        """Choose the integrator; the other parameters are written into the compiled model."""
        # RK4 is not one of them: that of the file stays, and the base class rejects it
        spec.option.integrator = INTEGRATORS.get(named(p)["integrator"], spec.option.integrator)

    def _undress(self, spec: Any) -> None:
        # in a file of others a class `looks` may hold what has mass
        pass

    def begin(self, steps: int) -> None:
        """Set the initial state and connect the channels to MuJoCo's arrays."""
        start(self.parameters, self.model, self.data)
        self.connect(self._cells(self._readings), self._cells(self._commands), self._cells(self._truths))

    def _cells(self, bound: tuple[channels.BoundChannel, ...]) -> dict[str, Cell]:
        return {one.channel.name: Cell(getattr(self.data, one.array), one.place) for one in bound}


def load(file: Path) -> type[Bare]:
    """Class of the plant that an MJCF file describes.

    Raises
    ------
    PlantError
        MuJoCo cannot read or compile the file, or two channels have one name.
    """
    model, spec = compiled(file)
    # reject two channels of one name before a run
    channels.truths(model, mujoco.MjData(model))
    rk4 = model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    members = {
        "__module__": __name__,
        "file": file,
        "Parameters": parameters_of(model, spec),
        "ratios": damping_ratios(model, spec),
        "required": {"integrator": ("implicitfast", NOT_DIVIDED)} if rk4 else {},
    }
    return type("Bare", (Bare,), members)


def fingerprint(file: Path) -> str:
    """SHA-256 of the compiled model, in hexadecimal: includes included files and meshes.

    Raises
    ------
    PlantError
        As for `load`.
    """
    model, _ = compiled(file)
    buffer = np.zeros(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return hashlib.sha256(buffer.tobytes()).hexdigest()


def compiled(file: Path) -> tuple[Any, Any]:
    """Model and specification of an MJCF file; an invalid number is an error, although MuJoCo only warns."""
    warnings: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(warnings.append)
    try:
        spec = mujoco.MjSpec.from_file(str(file))
        model = spec.compile()
        if nan := [text for text in warnings if "NaN" in text]:
            raise ValueError(nan[0])
        for text in dict.fromkeys(warnings):
            log.warning("MuJoCo warns of `%s`: %s", file.name, text)
        return model, spec
    except ValueError as error:
        lines = (
            str(error).removeprefix("XML Error: ").removeprefix("Error: ").replace(":\n", ": ").split("\n")
        )
        problem = ", ".join(filter(None, lines))
        hint = "hint: Check the elements and attributes in MuJoCo's XML reference."
        raise PlantError(f"MuJoCo cannot load `{file.name}`: {problem}\n{hint}") from None
    finally:
        mujoco.set_mju_user_warning(before)
