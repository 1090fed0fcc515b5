"""Hosts that trap floating-point exceptions run every FMU: none is raised in normal operation."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import DRIVER, Fmu, compile_driver

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="feenableexcept is of the GNU C library")


def test_no_exception_is_raised(fmu: Fmu, tmp_path: Path) -> None:
    driver = compile_driver(tmp_path, DRIVER.read_text())
    result = subprocess.run(fmu.driven(driver, "traps"), capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout, result.stderr) == (0, "done\n", "")
