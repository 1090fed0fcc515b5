"""Scenarios of several probes: `out = gain * in + bias`, `sum` is the integral of `in`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cosim

Write = Callable[..., Path]
LOOP = 'title = "Several"\nloop = {step = 0.001, duration = 0.02}\n'


def fmu(name: str, more: str = "", **parameters: float | list[float]) -> str:
    """Table of one probe."""
    values = ", ".join(f"{key} = {value}" for key, value in parameters.items())
    return f'[[fmu]]\nname = "{name}"\nfmu = "probe"\nparameters = {{{values}}}\n{more}'


def wire(source: str, to: str, more: str = "") -> str:
    """Table of one wire."""
    return f'[[wire]]\nfrom = "{source}"\nto = "{to}"\n{more}'


def signal(to: str, times: list[float], values: list[float]) -> str:
    """Table of one signal."""
    return f'[[signal]]\nto = "{to}"\ntimes = {times}\nvalues = {values}\n'


def run(file: Path, *changes: str) -> cosim.Result:
    """Run a file in this process."""
    return cosim.run(cosim.load(file, set=changes))


def column(result: cosim.Result, name: str) -> NDArray[np.float64]:
    """Column of a trace that was kept."""
    return result.columns[name]


def whole(result: cosim.Result) -> NDArray[Any]:
    """Return the whole trace that was kept."""
    assert result.trace is not None
    return result.trace
