"""The FMUs under test: every file that was packed, and the probe, packed here."""

from __future__ import annotations

import ctypes
import json
import os
import platform
import shutil
import subprocess
import zipfile
from dataclasses import dataclass
from pathlib import Path

import fmpy
import pytest
from fmpy.model_description import ModelDescription, ScalarVariable

ROOT = Path(__file__).parents[2]
DRIVER = Path(__file__).with_name("driver.c")
HEADERS = Path(fmpy.__file__).parent / "c-code"
PROBE = "probe"
NAMES = [*sorted(file.stem for file in (ROOT / "target/fmu").glob("*.fmu")), PROBE]


@dataclass(frozen=True)
class Fmu:
    """An FMU file, where it lies unpacked, and its description."""

    file: Path
    folder: Path
    description: ModelDescription

    @property
    def library(self) -> Path:
        """The binary for this platform."""
        name = self.description.coSimulation.modelIdentifier
        return self.folder / "binaries" / str(fmpy.platform) / f"{name}{fmpy.sharedLibraryExtension}"

    def variables(self, causality: str | None = None, kind: str | None = None) -> list[ScalarVariable]:
        """Return the variables of a causality and a type; all by default."""
        return [
            variable
            for variable in self.description.modelVariables
            if causality in (None, variable.causality) and kind in (None, variable.type)
        ]

    def driven(self, driver: Path, *words: str) -> list[str]:
        """Return the command line of the driver with this FMU and a Real input of it."""
        reference = self.variables("input", "Real")[0].valueReference
        return [str(driver), str(self.library), self.description.guid, str(reference), *words]


def build_probe() -> Path:
    """Build the example `probe` of fmi2-export with the features of `cargo test --workspace`."""
    command = ["cargo", "build", "--workspace", "--examples", "--locked", "--message-format=json"]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, f"`{' '.join(command)}` failed:\n{run.stderr}"
    messages = (json.loads(line) for line in run.stdout.splitlines())
    built = [m for m in messages if m["reason"] == "compiler-artifact" and m["target"]["name"] == PROBE]
    return Path(built[0]["filenames"][0])


def generated_files(library: Path) -> dict[str, str]:
    """Return the files that a library describes itself with, asked as a packer does."""
    export_file = ctypes.CDLL(str(library)).fmi2_export_file
    export_file.argtypes, export_file.restype = [ctypes.c_char_p], ctypes.c_char_p
    assert export_file(b"no such file") is None
    paths = export_file(b"").decode().split("\n")
    return {path: export_file(path.encode()).decode() for path in paths}


def pack_probe(folder: Path) -> Path:
    """Pack the probe as an FMU file."""
    library, file = build_probe(), folder / f"{PROBE}.fmu"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, text in generated_files(library).items():
            archive.writestr(path, text)
        archive.write(library, f"binaries/{fmpy.platform}/{PROBE}{library.suffix}")
    return file


@pytest.fixture(scope="session", params=NAMES)
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Fmu:
    """Every FMU, unpacked in a folder with blanks, a percent sign and UTF-8 in its path."""
    file = ROOT / f"target/fmu/{request.param}.fmu"
    if request.param == PROBE:
        file = pack_probe(tmp_path_factory.mktemp("packed"))
    folder = tmp_path_factory.mktemp("unpacked") / "a b 100% µ\u00e9"
    fmpy.extract(str(file), str(folder))
    return Fmu(file, folder, fmpy.read_model_description(str(file)))


def need(program: str, found: str | None) -> str:
    """Return a program, or skip the test; on a build server (`CI` is set) fail instead."""
    if found is None:
        reason = f"`{program}` is not installed on this {platform.system()}"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    return found


def compile_driver(folder: Path, source: str) -> Path:
    """Compile the driver, or a changed one."""
    compiler = need("cc", shutil.which("cc"))
    (folder / "driver.c").write_text(source)
    flags = ["-std=gnu11", "-O1", "-g", "-Wall", "-Wextra", "-Werror"]
    command = [
        compiler,
        *flags,
        "-I",
        str(HEADERS),
        "-I",
        str(DRIVER.parent),
        "driver.c",
        "-o",
        "driver",
        "-ldl",
        "-lm",
    ]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "driver"
