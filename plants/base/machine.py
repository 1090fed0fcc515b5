"""A plant for native code: addresses of MuJoCo's functions, model and data, and the cells."""

import ctypes
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import mujoco

from machining_native import Cell, Circuit

FUNCTIONS = ("mj_step1", "mj_step2", "mjb_makeBatch", "mjb_deleteBatch", "mjb_apply", "mjb_error")
"""Functions that the native stepper calls; the batch catches MuJoCo's errors."""


class NotNativeError(RuntimeError):
    """A plant cannot be stepped by native code; the message has the reason."""


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
        Elements that act when measurements are taken, and in every plant step.
    `readings`, `commands`, `truths` : tuple of Cell
        The channels.
    owner : object
        Owner of the addresses; kept alive.
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
    """Addresses of `FUNCTIONS` in the library of the bindings, with its profiler switched off.

    The bindings give MuJoCo a clock for `data.timer`, which is read many times per step: a step of a small
    model takes up to twice as long.
    """
    found = [path for folder in mujoco.__path__ for path in Path(folder).glob("*mujoco.*")]
    libraries = [path for path in found if {".so", ".dylib", ".dll"} & set(path.suffixes)]
    if not libraries:
        raise NotNativeError("MuJoCo's library is not next to its bindings")
    library = ctypes.CDLL(str(libraries[0]))
    try:
        ctypes.c_void_p.in_dll(library, "mjcb_time").value = None
        return [ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0 for name in FUNCTIONS]
    except (AttributeError, ValueError) as error:
        raise NotNativeError(f"MuJoCo {mujoco.__version__} lacks a symbol: {error}") from None


@cache
def empty_model() -> Any:
    """Empty model."""
    return mujoco.MjModel.from_xml_string("<mujoco/>")


def address(bound: Any) -> int:
    """Address of the struct of an object of the bindings."""
    if not hasattr(bound, "_address"):
        raise NotNativeError(f"MuJoCo {mujoco.__version__} gives no address of `{type(bound).__name__}`")
    return int(bound._address)
