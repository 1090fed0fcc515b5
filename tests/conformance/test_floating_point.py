"""Hosts that trap floating-point exceptions run every FMU: none is raised in normal operation."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import cosim

from .conftest import DRIVER, Fmu, compile_driver

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="feenableexcept is of the GNU C library")

INVALID, DIVBYZERO, OVERFLOW = 1, 4, 8
"""The exceptions as `fenv.h` numbers them on x86-64."""
TRAPPED = INVALID | DIVBYZERO | OVERFLOW
LOOPS = [
    "centering",
    "centering/centrifugal",
    "centering/paper",
    "deburr",
    "deburr/learn",
    "deburr/paper",
    "dob",
    "dob/paper",
    "fts",
    "fts/paper",
    "polish",
    "polish/paper",
]
STEPS = 12_000
"""No loop runs longer: by then each has left its first states."""


@pytest.fixture(scope="module")
def libm() -> ctypes.CDLL:
    """Return the library of the flags."""
    return ctypes.CDLL("libm.so.6")


def test_no_exception_is_raised_at_rest(fmu: Fmu, tmp_path: Path) -> None:
    driver = compile_driver(tmp_path, DRIVER.read_text())
    result = subprocess.run(fmu.driven(driver, "traps"), capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout, result.stderr) == (0, "done\n", "")


def watched(libm: ctypes.CDLL, call: Callable[..., Any], raised: dict[int, int]) -> Callable[..., Any]:
    """Return a call that notes which exceptions it raised when it was made for the n-th time."""
    made = iter(range(sys.maxsize))

    def watching(*arguments: Any) -> Any:
        libm.feclearexcept(TRAPPED)
        answer = call(*arguments)
        number, flags = next(made), libm.fetestexcept(TRAPPED)
        if flags:
            raised[number] = flags
        return answer

    return watching


def test_the_flags_are_seen(libm: ctypes.CDLL) -> None:
    raised: dict[int, int] = {}
    call = watched(libm, libm.feraiseexcept, raised)
    for exception in (0, INVALID, DIVBYZERO, 0, OVERFLOW):
        call(exception)
    assert raised == {1: INVALID, 2: DIVBYZERO, 4: OVERFLOW}


def cut(name: str) -> Iterator[str]:
    """Yield what makes a scenario no longer than `STEPS`."""
    loop = cosim.load(name).loop
    if loop.steps > STEPS:
        yield f"loop.duration={STEPS * loop.step!r}"


@pytest.mark.parametrize("name", LOOPS)
def test_no_exception_is_raised_in_a_closed_loop(name: str, libm: ctypes.CDLL) -> None:
    initialisation: dict[int, int] = {}
    steps: dict[int, int] = {}
    with cosim.Session(cosim.load(name, set=list(cut(name)))) as session:
        slave = session.fmu.fmi.slave
        slave.fmi2DoStep = watched(libm, slave.fmi2DoStep, steps)
        slave.exitInitializationMode = watched(libm, slave.exitInitializationMode, initialisation)
        session.run()
    assert (initialisation, steps) == ({}, {}), f"flags by call, {INVALID} invalid, {DIVBYZERO} by zero"
