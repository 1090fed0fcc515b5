"""Plants that do not return, exit or take the process along, each in its own way."""

import ctypes
import os
import pathlib
import sys
import time
from typing import Any

import numpy as np
import probe_plants


class ExitInInit(probe_plants.Lag):
    def __init__(self, parameters: probe_plants.LagParameters) -> None:
        sys.exit(0)


class ExitInReset(probe_plants.Lag):
    def reset(self, seed: np.random.SeedSequence, duration: float) -> None:
        sys.exit(0)


class ExitInStep(probe_plants.Lag):
    def advance(self, substeps: int) -> None:
        super().advance(substeps)
        if self.n == 5:
            sys.exit(0)


class AbortInInit(probe_plants.Lag):
    def __init__(self, parameters: probe_plants.LagParameters) -> None:
        os.abort()


class SleepInInit(probe_plants.Lag):
    def __init__(self, parameters: probe_plants.LagParameters) -> None:
        print("asleep", flush=True)
        time.sleep(1000.0)


class Vanish(probe_plants.Lag):
    def advance(self, substeps: int) -> None:
        os._exit(0)


class Parent(probe_plants.Lag):
    """Leaves a process that has inherited everything possible, and terminates."""

    def advance(self, substeps: int) -> None:
        os.system("sleep 300 & echo $! > child")
        os.abort()


class Hold(probe_plants.Lag):
    """Hangs in code of C that keeps the GIL, so that no other thread of Python runs."""

    def sense(self) -> Any:
        ctypes.PyDLL(None).pause()


class Notes(probe_plants.Lag):
    """Writes down when it is built and closed."""

    def __init__(self, parameters: probe_plants.LagParameters) -> None:
        super().__init__(parameters)
        self.note("built")

    def note(self, text: str) -> None:
        with pathlib.Path(__file__).with_name("notes").open("a") as file:
            file.write(f"{text} {self.parameters.pole:g}\n")

    def close(self) -> None:
        self.note("closed")


class Slow(Notes):
    """Does not return from a step."""

    def advance(self, substeps: int) -> None:
        print("asleep", flush=True)
        time.sleep(1000.0)


class Clings(Notes):
    """Does not return from `close`."""

    def close(self) -> None:
        time.sleep(1000.0)


class Breaks(Notes):
    """Fails in `close`."""

    def close(self) -> None:
        raise RuntimeError("the drive is stuck")


class EndInFilm(probe_plants.Lag):
    """Ends the process when a video reads its coordinates."""

    def record_qpos(self) -> None:
        os._exit(3)


class Panic(BaseException):
    """As that of Rust, which is not a known `Exception`."""


class PanicsInInit(probe_plants.Lag):
    """Panics when it is built."""

    def __init__(self, parameters: probe_plants.LagParameters) -> None:
        raise Panic("at the first line")


class PanicsInStep(probe_plants.Lag):
    """Panics when it is read."""

    def sense(self) -> Any:
        raise Panic("at the first line")
