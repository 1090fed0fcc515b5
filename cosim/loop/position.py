"""Position of a run, in memory that another process can read even after a crash."""

from __future__ import annotations

import ctypes
import enum
import mmap
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cosim.process import Arithmetic
from cosim.warned import warn_once

PAGE = 4096
"""Bytes of a file that holds a position."""
NAME = 400
"""Maximum bytes of a name."""


class Stage(enum.IntEnum):
    """The running code and its task."""

    NONE = 0
    LOAD = 1
    INITIALISE = 2
    STEP = 3
    CLOSE = 4
    BUILD_PLANT = 5
    RESET_PLANT = 6
    STEP_PLANT = 7
    STEP_BOTH = 8
    READ = 9
    CLOSE_PLANT = 10


FMU = {
    Stage.LOAD: "while it was loaded and instantiated",
    Stage.INITIALISE: "while it was initialized",
    Stage.STEP: "",
    Stage.READ: "while its variables were read after the run",
    Stage.CLOSE: "while it was terminated and freed",
}
PLANT = {
    Stage.BUILD_PLANT: "while it was built",
    Stage.RESET_PLANT: "while it was reset",
    Stage.STEP_PLANT: "",
    Stage.CLOSE_PLANT: "while it was closed",
}


class Page(ctypes.Structure):
    """Layout of the shared memory. In the native engine `step` is the first of a chunk of steps.

    `repeated` counts the earlier runs that were repeated before a run.
    """

    _fields_ = (
        ("stage", ctypes.c_int64),
        ("step", ctypes.c_int64),
        ("steps", ctypes.c_int64),
        ("repeated", ctypes.c_int64),
        ("period", ctypes.c_double),
        ("fmu", ctypes.c_char * NAME),
        ("plant", ctypes.c_char * NAME),
    )


class Position:
    """Position of a run; a field of `page` is written before each call of foreign code.

    The floating-point environment is restored after each stage, because a change by one FMU would change the
    results of other FMUs and of later runs. The file has `PAGE` bytes, which another process maps as well;
    without it the record is for this process only.
    """

    def __init__(self, file: Path | None = None) -> None:
        memory: Any = bytearray(PAGE)
        if file is not None:
            with file.open("r+b") as opened:
                # what is written to each descriptor there is overwrites no name in it
                opened.seek(0, os.SEEK_END)
                memory = mmap.mmap(opened.fileno(), ctypes.sizeof(Page))
        self.page: Any = Page.from_buffer(memory)
        self.arithmetic = Arithmetic()

    def begin(self, fmu: str, plant: str, steps: int, period: float) -> None:
        """Start a new run; `period` is the communication step in s."""
        self.at(Stage.NONE)
        self.arithmetic = Arithmetic()
        self._write(fmu, plant, steps, period)

    def detach(self) -> None:
        """Keep the record, but not the memory of the other process."""
        self.page = Page.from_buffer_copy(self.page)

    def clear(self) -> None:
        """Clear the record of another process."""
        self._write("", "", 0, 0.0)

    def _write(self, fmu: str, plant: str, steps: int, period: float) -> None:
        page = self.page
        page.fmu, page.plant = fmu.encode()[: NAME - 1], plant.encode()[: NAME - 1]
        page.stage, page.step, page.steps, page.period = Stage.NONE, 0, steps, period

    def at(self, stage: Stage, fmu: str = "") -> None:
        """Record the running stage and the name of the FMU."""
        # the steps of a run are one stage, which `end_steps` ends
        if stage != Stage.STEP and self.arithmetic.put_back():
            text = f"{self.who()} changed the floating-point environment (rounding, denormals or traps)"
            warn_once(f"{text} {self.when()}".rstrip() + "; it was restored")
        self.page.fmu = fmu.encode()[: NAME - 1] or self.page.fmu
        self.page.stage = stage

    def end_steps(self, fmus: Sequence[str]) -> None:
        """Record that the steps of these FMUs are done."""
        self.page.step = 0
        self.page.fmu, self.page.stage = "`, `".join(fmus).encode()[: NAME - 1], Stage.STEP_BOTH
        self.at(Stage.NONE)

    def who(self) -> str:
        """Return the FMU or plant whose code runs; empty if neither."""
        stage, (fmu, plant) = self.page.stage, self.names()
        if stage in FMU:
            return fmu
        if stage in PLANT:
            return plant
        return self.ran() if stage == Stage.STEP_BOTH else ""

    def ran(self) -> str:
        """Return the FMU or plant of this run; empty if there is none."""
        return " or ".join(name for name in self.names() if name)

    def names(self) -> tuple[str, str]:
        """FMU and plant; empty if there is none."""
        fmu, plant = (name.decode(errors="ignore") for name in (self.page.fmu, self.page.plant))
        return f"the FMU `{fmu}`" if fmu else "", f"the plant `{plant}`" if plant else ""

    def when(self) -> str:
        """Time and step of the run; empty if unknown."""
        stage, k = self.page.stage, self.page.step
        time = f"t = {k * self.page.period:.9g} s (step {k})"
        if stage == Stage.STEP_BOTH:
            return f"at or after {time}"
        if stage in (Stage.STEP, Stage.STEP_PLANT):
            return f"at {time}"
        return FMU.get(stage) or PLANT.get(stage) or ""
