"""A plant as native code steps it: addresses of MuJoCo's functions, of its model and data, and the cells."""

import ctypes
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import mujoco

from machining_native import Cell, Circuit

FUNCTIONS = ("mj_step1", "mj_step2", "mjb_makeBatch", "mjb_deleteBatch", "mjb_apply", "mjb_error")
"""What the native stepper calls; the batch is where it catches MuJoCo's errors."""


class NotNativeError(RuntimeError):
    """A plant cannot be stepped by native code; the message says why."""


@dataclass(frozen=True)
class Machine:
    """Addresses and cells of a plant, valid until its next reset.

    Parameters
    ----------
    functions : list of int
        Addresses of `FUNCTIONS`.
    empty : int
        Address of an empty model, for the batch.
    model, data : int
        Addresses of the plant's `mjModel` and `mjData`.
    timestep : float
        One plant step, s.
    warnings : numpy.ndarray
        Counters of MuJoCo's warnings.
    sensing, circuit : Circuit
        Elements that act when readings are taken, and in every plant step.
    readings, commands, truths : tuple of Cell
        The channels.
    owner : object
        What the addresses belong to; kept alive.
    """

    functions: list[int]
    empty: int
    model: int
    data: int
    timestep: float
    warnings: Any
    sensing: Circuit
    circuit: Circuit
    readings: tuple[Cell, ...]
    commands: tuple[Cell, ...]
    truths: tuple[Cell, ...]
    owner: object


@cache
def functions() -> list[int]:
    """Addresses of `FUNCTIONS` in the library that the bindings have loaded, whose profiler is switched off.

    The bindings give MuJoCo a clock that is read many times in a step, for `data.timer` alone: a step of a
    small model takes up to twice as long.
    """
    found = [path for folder in mujoco.__path__ for path in Path(folder).glob("*mujoco.*")]
    libraries = [path for path in found if {".so", ".dylib", ".dll"} & set(path.suffixes)]
    if not libraries:
        raise NotNativeError("MuJoCo's library is not where its bindings are")
    library = ctypes.CDLL(str(libraries[0]))
    try:
        ctypes.c_void_p.in_dll(library, "mjcb_time").value = None
        return [ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0 for name in FUNCTIONS]
    except (AttributeError, ValueError) as error:
        raise NotNativeError(f"MuJoCo {mujoco.__version__} lacks a symbol: {error}") from None


@cache
def empty_model() -> Any:
    """Model without anything in it."""
    return mujoco.MjModel.from_xml_string("<mujoco/>")


def address(bound: Any) -> int:
    """Address of the struct behind an object of the bindings."""
    if not hasattr(bound, "_address"):
        raise NotNativeError(f"MuJoCo {mujoco.__version__} tells no address of `{type(bound).__name__}`")
    return int(bound._address)
