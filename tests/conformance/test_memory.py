"""Valgrind finds no fault and no leak in a run from loading to unloading."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import DRIVER, PROBE, Fmu, compile_driver, need

VALGRIND = [
    "--quiet",
    "--error-exitcode=99",
    "--leak-check=full",
    "--errors-for-leak-kinds=definite,indirect",
]

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="valgrind and dlopen are those of Linux")


@pytest.fixture(scope="module")
def valgrind() -> str:
    return need("valgrind", shutil.which("valgrind"))


def run(valgrind: str, driver: Path, fmu: Fmu) -> subprocess.CompletedProcess[str]:
    command = [valgrind, *VALGRIND, *fmu.driven(driver)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.client("valgrind", "watches a life in a C program")
def test_no_fault_and_no_leak(fmu: Fmu, valgrind: str, tmp_path: Path) -> None:
    result = run(valgrind, compile_driver(tmp_path, DRIVER.read_text()), fmu)
    assert (result.returncode, result.stdout, result.stderr) == (0, "done\n", "")


@pytest.mark.parametrize("fmu", [PROBE], indirect=True)
def test_a_leaked_instance_would_be_found(fmu: Fmu, valgrind: str, tmp_path: Path) -> None:
    result = run(valgrind, compile_driver(tmp_path, without("    free_instance(two);\n")), fmu)
    assert result.returncode == 99
    assert "definitely lost" in result.stderr


@pytest.mark.parametrize("fmu", [PROBE], indirect=True)
def test_a_leaked_state_goes_with_its_instance(fmu: Fmu, valgrind: str, tmp_path: Path) -> None:
    result = run(valgrind, compile_driver(tmp_path, without("    OK(free_state(from, &taken));\n")), fmu)
    assert (result.returncode, result.stdout, result.stderr) == (0, "done\n", "")


def without(line: str) -> str:
    """Return the driver without one of its lines."""
    source = DRIVER.read_text()
    assert source.count(line) == 1
    return source.replace(line, "")
