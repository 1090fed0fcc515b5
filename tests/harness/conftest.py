"""The probe FMU, compiled once, and scenarios around it."""

from __future__ import annotations

import json
import logging
import shutil
import subprocess
import zipfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import fmpy
import pytest

from .report import browser

DATA = Path(__file__).parent / "data"
HEADERS = Path(fmpy.__file__).parent / "c-code"

SCENARIO = """
title = "Lag with a probe"
undriven = ["controller.count", "controller.mode", "controller.flag", "plant.extra"]

[loop]
step = 0.001
duration = 0.05

[controller]
fmu = "probe"

[plant]
name = "probe_plants:Lag"

[[wire]]
from = "plant.x"
to = "controller.in"

[[wire]]
from = "controller.out"
to = "plant.u"
"""


def entry(table: str, **keys: object) -> str:
    """One entry of an array of tables of a scenario; TOML writes such values as JSON does."""
    lines = (f"{key} = {json.dumps(value)}" for key, value in keys.items())
    return "\n".join((f"[[{table}]]", *lines, ""))


def grid(**varied: Sequence[object]) -> str:
    """Study of the lag scenario: the grid of these values of its plant, by their keys."""
    keys = (entry("vary", key=f"plant.{key}", values=values) for key, values in varied.items())
    return "\n".join(('scenario = "lag.toml"', "[design]", 'kind = "grid"', *keys))


SETTLING = "\n[controller.parameters]\ngain = 0.5\nbias = [0.33333333, 0.0]\n"
"""Parameters with which the lag settles at 2/3 m; with those of the FMU it is at rest from the start."""
END = "\n" + entry("metric", name="end", unit="m", value="last(plant.x)")
"""Metric of the lag scenario: where it ends."""


def pack(target: Path, description: str, members: dict[str, bytes]) -> Path:
    """Write an FMU."""
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        for name, content in members.items():
            archive.writestr(name, content)
    return target


def compiled(folder: Path, source: Path) -> bytes:
    """Compile a library for tests from a C file."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.fail("a C compiler is needed to build the FMUs")
    library = folder / f"{source.stem}.so"
    command = [compiler, "-shared", "-fPIC", "-O1", f"-I{HEADERS}", str(source), "-lm"]
    subprocess.run([*command, "-o", str(library)], check=True)
    return library.read_bytes()


@pytest.fixture(scope="session")
def probe_library(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Compile the probe."""
    return compiled(tmp_path_factory.mktemp("probe"), DATA / "probe.c")


@pytest.fixture(scope="session")
def broken_library(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Compile the library whose defect the GUID names."""
    return compiled(tmp_path_factory.mktemp("defects"), DATA / "defects.c")


@pytest.fixture(scope="session")
def probe(tmp_path_factory: pytest.TempPathFactory, probe_library: bytes) -> Path:
    """Pack the FMU `probe.fmu`."""
    member = f"binaries/{fmpy.platform}/probe{fmpy.sharedLibraryExtension}"
    description = (DATA / "probe.xml").read_text()
    return pack(tmp_path_factory.mktemp("fmu") / "probe.fmu", description, {member: probe_library})


@pytest.fixture(scope="session")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a browser for all pages."""
    with browser.started(tmp_path_factory.mktemp("chromium")) as address:
        yield address


@pytest.fixture(autouse=True)
def _quiet_command_line() -> Iterator[None]:
    """Undo what a command that was called in this process does to the log."""
    yield
    log = logging.getLogger("cosim")
    log.handlers.clear()
    log.setLevel(logging.NOTSET)
    log.propagate = True


@pytest.fixture
def folder(tmp_path: Path, probe: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Folder of a user: the FMU, the plants, no scenario yet; caches and searches stay inside."""
    shutil.copy(probe, tmp_path / "probe.fmu")
    shutil.copy(DATA / "probe_plants.py", tmp_path / "probe_plants.py")
    monkeypatch.setenv("COSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("COSIM_SCENARIOS", raising=False)
    monkeypatch.delenv("COSIM_FMU_PATH", raising=False)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def write(folder: Path) -> Callable[..., Path]:
    """Write a scenario file: the lag scenario and what is added."""

    def write_scenario(added: str = "", name: str = "lag.toml", text: str = SCENARIO) -> Path:
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text + added)
        return file

    return write_scenario
