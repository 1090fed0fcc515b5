"""The FMUs with a defect, made once; a folder that holds what the bad inputs speak of."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from ..conftest import DATA, END, HEADERS
from . import fmus
from .calling import Refuse, refused


@pytest.fixture(scope="session")
def broken_library(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Compile the library whose defect the GUID names."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    assert compiler, "a C compiler is needed to build the FMUs"
    library = tmp_path_factory.mktemp("defects") / "defects.so"
    command = [compiler, "-shared", "-fPIC", "-O1", f"-I{HEADERS}", str(DATA / "defects.c"), "-lm"]
    subprocess.run([*command, "-o", str(library)], check=True)
    return library.read_bytes()


@pytest.fixture
def lag(write: object, folder: Path) -> Path:
    """Write the lag scenario with a metric and a criterion into a folder of its own."""
    assert callable(write)
    write(END + '[[criterion]]\nid = "end"\nclaim = "ends"\nmetric = "end"\nmaximum = 1.0\n')
    return folder


@pytest.fixture
def refuse(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Refuse:
    """Check that a bad input is rejected correctly."""
    return lambda case: refused(case, monkeypatch, capsys)


@pytest.fixture
def broken(lag: Path, broken_library: bytes, request: pytest.FixtureRequest) -> str:
    """FMU with the defect that the test is parametrized with."""
    build, _ = (fmus.FILES | fmus.WARNED)[request.param]
    build(lag / "broken.fmu", broken_library)
    return "broken.fmu"
