"""Where a run is: kept in memory that another process can look at, even after a crash."""

from __future__ import annotations

import ctypes
import enum
import mmap
from collections.abc import Sequence
from typing import Any

from cosim.process import Arithmetic
from cosim.warned import warn_once

NAME = 400
"""Bytes kept of a name."""


class Stage(enum.IntEnum):
    """Whose code runs, and for what."""

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
    Stage.INITIALISE: "while it was initialised",
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
    """What the memory holds. In the native engine `step` is the first of a chunk of steps."""

    _fields_ = (
        ("stage", ctypes.c_int64),
        ("step", ctypes.c_int64),
        ("steps", ctypes.c_int64),
        ("period", ctypes.c_double),
        ("fmu", ctypes.c_char * NAME),
        ("plant", ctypes.c_char * NAME),
    )


class Place:
    """Where a run is; a field of `page` is written before each call of foreign code.

    After each stage the processor calculates as before: what an FMU changes of that would change the numbers
    of others, and its own from one run to the next.

    Parameters
    ----------
    file
        Descriptor of a file that another process maps as well; None is for this process alone.
    """

    def __init__(self, file: int | None = None) -> None:
        size = ctypes.sizeof(Page)
        self.page: Any = Page.from_buffer(bytearray(size) if file is None else mmap.mmap(file, size))
        self.arithmetic = Arithmetic()

    def begin(self, fmu: str, plant: str, steps: int, period: float) -> None:
        """Forget the run before; `period` is the communication step in s."""
        self.at(Stage.NONE)
        self.arithmetic = Arithmetic()
        self._write(fmu, plant, steps, period)

    def clear(self) -> None:
        """Forget what another process noted."""
        self._write("", "", 0, 0.0)

    def _write(self, fmu: str, plant: str, steps: int, period: float) -> None:
        page = self.page
        page.fmu, page.plant = fmu.encode()[: NAME - 1], plant.encode()[: NAME - 1]
        page.stage, page.step, page.steps, page.period = Stage.NONE, 0, steps, period

    def at(self, stage: Stage, fmu: str = "") -> None:
        """Note whose code runs now; of several FMUs, of which."""
        # the steps of a run are one stage, which `end_steps` ends
        if stage != Stage.STEP and self.arithmetic.put_back():
            text = f"{self.who()} changed how the processor calculates (rounding, denormals or traps)"
            warn_once(f"{text} {self.when()}".rstrip() + "; it was put back")
        self.page.fmu = fmu.encode()[: NAME - 1] or self.page.fmu
        self.page.stage = stage

    def end_steps(self, fmus: Sequence[str]) -> None:
        """Note that the steps of these FMUs are done."""
        self.page.step = 0
        self.page.fmu, self.page.stage = "`, `".join(fmus).encode()[: NAME - 1], Stage.STEP_BOTH
        self.at(Stage.NONE)

    def who(self) -> str:
        """Whose code runs, empty if that of neither FMU nor plant."""
        stage = self.page.stage
        fmu, plant = self.names()
        return (
            fmu
            if stage in FMU
            else plant
            if stage in PLANT
            else self.ran()
            if stage == Stage.STEP_BOTH
            else ""
        )

    def ran(self) -> str:
        """Whose code this run is about, empty if there is none."""
        return " or ".join(name for name in self.names() if name)

    def names(self) -> tuple[str, str]:
        """FMU and plant, empty where there is none."""
        fmu, plant = (name.decode(errors="ignore") for name in (self.page.fmu, self.page.plant))
        return f"the FMU `{fmu}`" if fmu else "", f"the plant `{plant}`" if plant else ""

    def when(self) -> str:
        """Moment of the run, with time and step where there is one; empty if that is not known."""
        stage, k = self.page.stage, self.page.step
        time = f"t = {k * self.page.period:.9g} s (step {k})"
        if stage == Stage.STEP_BOTH:
            return f"at or after {time}"
        if stage in (Stage.STEP, Stage.STEP_PLANT):
            return f"at {time}"
        return FMU.get(stage) or PLANT.get(stage) or ""
