"""Valgrind finds no fault and no leak in a run from loading to unloading."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest

from .conftest import PROBE, Fmu, need

DRIVER = Path(__file__).with_name("driver.c")
HEADERS = Path(fmpy.__file__).parent / "c-code"
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


def compile_driver(folder: Path, source: str) -> Path:
    compiler = need("cc", shutil.which("cc"))
    (folder / "driver.c").write_text(source)
    flags = ["-std=gnu11", "-O1", "-g", "-Wall", "-Wextra", "-Werror"]
    command = [compiler, *flags, "-I", str(HEADERS), "driver.c", "-o", "driver", "-ldl"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "driver"


def run(valgrind: str, driver: Path, fmu: Fmu) -> subprocess.CompletedProcess[str]:
    command = [valgrind, *VALGRIND, str(driver), str(fmu.library), fmu.description.guid]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_no_fault_and_no_leak(fmu: Fmu, valgrind: str, tmp_path: Path) -> None:
    result = run(valgrind, compile_driver(tmp_path, DRIVER.read_text()), fmu)
    assert (result.returncode, result.stdout, result.stderr) == (0, "done\n", "")


@pytest.mark.parametrize("fmu", [PROBE], indirect=True)
@pytest.mark.parametrize("line", ["    OK(free_state(from, &taken));\n", "    free_instance(two);\n"])
def test_a_forgotten_free_would_be_found(fmu: Fmu, valgrind: str, tmp_path: Path, line: str) -> None:
    source = DRIVER.read_text()
    assert source.count(line) == 1
    result = run(valgrind, compile_driver(tmp_path, source.replace(line, "")), fmu)
    assert result.returncode == 99
    assert "definitely lost" in result.stderr
