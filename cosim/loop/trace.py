"""Traces: what is recorded in every step, and the files it is saved in."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.fmu.archive import DisplayUnit, FmuFile, Variable
from cosim.fmu.instance import BASE, Instance
from cosim.loop.condition import Program
from cosim.loop.plant import Plant, one_each


class Recorder:
    """Preallocated table of a run, shape (steps, columns); first column is the time.

    Parameters
    ----------
    fmus
        Initialised instances: inputs that nothing drives are recorded with their start value.
    plant
        The plant.
    steps
        Steps of the run.
    every
        Steps between two rows.
    """

    def __init__(self, fmus: Sequence[Instance], plant: Plant, steps: int, every: int = 1) -> None:
        self.plant = plant
        self.every = every
        self.stop: Program | None = None
        self.table = np.zeros((-(-steps // every), len(columns(fmus, plant))))
        # inputs that nothing drives are constant
        first = 1
        for fmu, variable in idle(fmus):
            self.table[:, first] = fmu.read(variable)
            first += 1
        self.start = first
        # then every bank of the FMUs, each a slice of the row
        self.banks: list[NDArray[Any]] = []
        self.parts: list[slice] = []
        for bank in (bank for fmu in fmus for bank in [*fmu.inputs, *fmu.outputs]):
            self.banks.append(bank.values)
            self.parts.append(slice(first, first + len(bank.variables)))
            first += len(bank.variables)
        self.truths = slice(first, None)

    def record(self, k: int, time: float) -> NDArray[np.float64] | None:
        """Fill and return the row of step `k`, if it has one."""
        row = self.row(k)
        if row is None:
            return None
        row[0] = time
        for part, values in zip(self.parts, self.banks, strict=True):
            row[part] = values
        row[self.truths] = one_each(self.plant.truth(), self.plant.truths, "truth")
        return row

    def row(self, k: int) -> NDArray[np.float64] | None:
        """Return the row of step `k`, if it has one."""
        row: NDArray[np.float64] | None = None if k % self.every else self.table[k // self.every]
        return row

    def recorded(self, steps: int) -> NDArray[np.float64]:
        """Return the rows of the first steps."""
        return self.table[: -(-steps // self.every)]


def idle(fmus: Sequence[Instance]) -> list[tuple[Instance, Variable]]:
    """Numeric inputs of the FMUs that nothing drives."""
    moved = {(fmu.name, v.name) for fmu in fmus for bank in fmu.inputs for v in bank.variables}
    inputs = [(fmu, v) for fmu in fmus for v in fmu.file.named("input") if v.kind != "String"]
    return [(fmu, v) for fmu, v in inputs if (fmu.name, v.name) not in moved]


def columns(fmus: Sequence[Instance], plant: Plant) -> dict[str, Variable | None]:
    """Names of the columns of a trace in order; with the FMU's variable where there is one."""
    moved = [(fmu, v) for fmu in fmus for bank in [*fmu.inputs, *fmu.outputs] for v in bank.variables]
    return {
        "time": None,
        **{f"{fmu.name}.{variable.name}": variable for fmu, variable in [*idle(fmus), *moved]},
        **{f"plant.{channel.name}": None for channel in plant.truths},
    }


def units(fmus: Sequence[Instance], plant: Plant) -> dict[str, str]:
    """Units of the columns of a trace, empty where none is known."""
    return {
        "time": "s",
        **{f"{fmu.name}.{v.name}": v.unit for fmu in fmus for v in fmu.file.variables.values()},
        **{f"plant.{channel.name}": channel.unit for channel in plant.truths},
    }


def displays(fmus: Sequence[Instance]) -> dict[str, DisplayUnit]:
    """Display units of the columns of a trace that have one."""
    variables = [(fmu.name, variable) for fmu in fmus for variable in fmu.file.variables.values()]
    return {f"{name}.{variable.name}": variable.display for name, variable in variables if variable.display}


def numeric_outputs(file: FmuFile) -> list[Variable]:
    """List the outputs of an FMU that can be recorded."""
    return [variable for variable in file.named("output") if BASE[variable.kind] != "String"]


def structured(table: NDArray[np.float64], names: list[str]) -> NDArray[Any]:
    """Table as a structured array with one field per column, the shape FMPy and pandas take."""
    dtype = np.dtype([(name, np.float64) for name in names])
    return np.ascontiguousarray(table).view(dtype).reshape(len(table))


def save(trace: NDArray[Any], path: Path, about: dict[str, Any]) -> None:
    """Save a trace as `.npz` (arrays `trace`, and `about` as JSON) or `.csv` (as FMPy writes and reads it).

    Raises
    ------
    CosimError
        Unknown ending or a file that cannot be written.
    """
    try:
        if path.suffix == ".npz":
            np.savez_compressed(path, trace=trace, about=np.array(json.dumps(about)))
        elif path.suffix == ".csv":
            table = trace.view(np.float64).reshape(len(trace), -1)
            header = ",".join(f'"{name}"' for name in trace.dtype.names or ())
            np.savetxt(path, table, fmt="%.17g", delimiter=",", header=header, comments="")
        else:
            raise CosimError(f"cannot save a trace as `{path}`", "the name must end in `.npz` or `.csv`")
    except OSError as error:
        raise CosimError(f"cannot write `{path}`: {error.strerror or error}") from None
