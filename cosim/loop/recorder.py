"""Recording of the steps of a run."""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.fmu.description import FmuFile, Variable
from cosim.fmu.instance import Instance
from cosim.loop.condition import Program
from cosim.loop.plant import Plant, one_each
from cosim.trace.columns import Columns
from cosim.warned import warn_once

BLOCK = 4096
"""Rows of a block of a run of which only the checksums are needed."""
LOCALS_MAX = 256
"""Local variables of an FMU that are recorded without a request; models of other tools may have thousands."""


class Sink(Protocol):
    """Receives the rows of a run in blocks, so that they need not fit into memory."""

    rows: int

    def write(self, columns: Sequence[NDArray[np.float64]]) -> None:
        """Receive rows, given by their columns."""


class Checksums:
    """Checksum of each column of a run, independent of its blocks of rows.

    Rows are passed on to a sink, if there is one; otherwise a run needs little memory. `passing` states
    whether the sink has failed, or is receiving rows.
    """

    def __init__(self) -> None:
        self.rows = BLOCK
        self.sink: Sink | None = None
        self.columns: list[int] = []
        self.passing = False

    def write(self, columns: Sequence[NDArray[np.float64]]) -> None:
        """Receive rows, given by their columns."""
        pairs = itertools.zip_longest(columns, self.columns, fillvalue=0)
        self.columns = [zlib.crc32(np.ascontiguousarray(column).data, before) for column, before in pairs]
        if self.sink is not None:
            self.passing = True
            self.sink.write(columns)
            self.passing = False


class Recorder:
    """Preallocated table of a run, shape (rows, columns); native code reads its attributes.

    There is a row in every `every`-th of the steps. A sink receives the rows of a full table, whose length it
    defines; without it all rows are in one table.
    """

    def __init__(
        self, fmus: Sequence[Instance], plant: Plant, steps: int, every: int = 1, sink: Sink | None = None
    ) -> None:
        self.plant, self.every, self.sink = plant, every, sink
        self.stop: Program | None = None
        self.triggers: Sequence[Any] = ()
        rows = -(-steps // every)
        self.columns = columns(fmus, plant)
        self.table = np.zeros((rows if sink is None else min(rows, sink.rows), len(self.columns)))
        # rows that the sink has received, and the step whose row is beyond the table
        self.taken, self.full = 0, len(self.table) * every
        # a minimum is NaN once a value was
        self.minima, self.sensed = np.zeros(len(self.columns)), np.zeros(len(plant.readings))
        # inputs that nothing drives are constant
        constant = [fmu.read(variable) for fmu, variable in undriven_inputs(fmus)]
        self.start = 1 + len(constant)
        self.table[:, 1 : self.start] = constant
        # then every bank of the FMUs, each a slice of the row
        banks = [bank for fmu in fmus for bank in [*fmu.inputs, *fmu.outputs]]
        self.banks: list[NDArray[Any]] = [bank.values for bank in banks]
        ends = itertools.accumulate((len(bank.variables) for bank in banks), initial=self.start)
        *self.parts, self.truths = (slice(*pair) for pair in itertools.pairwise([*ends, None]))

    def record(self, k: int, time: float) -> NDArray[np.float64] | None:
        """Fill and return the row of step `k`, if it is recorded."""
        row = self.row(k)
        if row is None:
            return None
        row[0] = time
        for part, values in zip(self.parts, self.banks, strict=True):
            row[part] = values
        row[self.truths] = one_each(self.plant.truth(), self.plant.truths, "truth")
        return row

    def row(self, k: int) -> NDArray[np.float64] | None:
        """Return the row of step `k`, if it is recorded."""
        return None if k % self.every else self.table[k // self.every - self.taken]

    def room(self, k: int) -> int:
        """Provide space for the row of step `k`; return the next step that needs new space."""
        if k == self.full:
            self.hand_over(len(self.table))
        return self.full

    def recorded(self, steps: int) -> NDArray[np.float64]:
        """Return the rows that no sink received; log measurements and columns that were NaN."""
        rows = -(-steps // self.every) - self.taken
        self.hand_over(rows)
        # only an injection sets an input to NaN
        inputs = [name for name, (_, _, v) in self.columns.items() if v and v.causality == "input"]
        names = [*self.columns, *(f"plant.{channel.name}" for channel in self.plant.readings)]
        for name, minimum in zip(names, [*self.minima, *self.sensed], strict=True):
            if np.isnan(minimum) and name not in inputs:
                warn_once(f"`{name}` was NaN during the run: every comparison with NaN is false")
        return self.table[: rows if self.sink is None else 0]

    def hand_over(self, rows: int) -> None:
        """Pass the first rows of the table to the sink, if there is one."""
        self.minima = np.minimum(self.minima, np.min(self.table[:rows], axis=0, initial=0.0))
        if self.sink is not None and rows:
            try:
                self.sink.write(list(self.table[:rows].T))
            except OSError as error:
                raise CosimError(f"the trace cannot be written: {error.strerror or error}") from error
            self.taken += rows
            self.full += rows * self.every


def undriven_inputs(fmus: Sequence[Instance]) -> list[tuple[Instance, Variable]]:
    """Numeric inputs of the FMUs that nothing drives."""
    moved = {(fmu.name, v.name) for fmu in fmus for bank in fmu.inputs for v in bank.variables}
    inputs = [(fmu, v) for fmu in fmus for v in fmu.file.named("input") if v.base]
    return [(fmu, v) for fmu, v in inputs if (fmu.name, v.name) not in moved]


class Column(NamedTuple):
    """Unit and description of a column, empty if unknown, and the FMU's variable if there is one."""

    unit: str
    description: str
    variable: Variable | None = None


def columns(fmus: Sequence[Instance], plant: Plant) -> dict[str, Column]:
    """Columns of a trace by name, in their order."""
    moved = [(fmu, v) for fmu in fmus for bank in [*fmu.inputs, *fmu.outputs] for v in bank.variables]
    variables = [*undriven_inputs(fmus), *moved]
    return {
        "time": Column("s", ""),
        **{f"{fmu.name}.{v.name}": Column(v.unit, v.description, v) for fmu, v in variables},
        **{f"plant.{channel.name}": Column(channel.unit, channel.description) for channel in plant.truths},
    }


def report_unlisted(fmus: Sequence[Instance], columns: Columns) -> None:
    """Log outputs with a value that is not an item of their enumeration."""
    outputs = [(fmu, v) for fmu in fmus for bank in fmu.outputs for v in bank.variables if v.items]
    for fmu, variable in outputs:
        name = f"{fmu.name}.{variable.name}"
        values = columns[name]
        odd = np.flatnonzero(~np.isin(values, [number for _, number in variable.items]))
        if odd.size:
            items = ", ".join(f"`{number}` {item}" for item, number in variable.items)
            found = f"`{name}` is `{values[odd[0]]:g}` at t = {columns['time'][odd[0]]:.9g} s"
            warn_once(f"{found}, which is not one of its items: {items}")


def recorded(file: FmuFile, record_locals: bool | None) -> list[Variable]:
    """List the outputs and local variables of an FMU that are recorded, in its order.

    `record_locals` of None records the local variables of an FMU with at most `LOCALS_MAX`.
    """
    numeric = [variable for variable in file.variables.values() if variable.base]
    fixed = ("constant", "fixed")
    moving = {v.name for v in numeric if v.causality == "local" and v.variability not in fixed}
    if record_locals is None:
        record_locals = len(moving) <= LOCALS_MAX
    return [v for v in numeric if v.causality == "output" or (record_locals and v.name in moving)]
