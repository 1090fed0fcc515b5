"""The FMUs of the release set do the same on every platform that they are for."""

from __future__ import annotations

import ctypes
import struct
import subprocess
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.model_description import ScalarVariable
from numpy.typing import NDArray

import cosim

from .conftest import ROOT
from .platforms import AARCH64, FOLDER, LINUX64, WIN64, Machine, machine

SET = ROOT / "target/release-set"
ROWS = 10_000
SEED = 57_001
KINDS = {"Real": 0, "Integer": 1, "Enumeration": 1, "Boolean": 2, "String": 3}
LOOPS = [
    "centering",
    "centering/commission",
    "deburr",
    "deburr/commission",
    "deburr/learn",
    "deburr/twice",
    "dob",
    "dob/commission",
    "dob/nan",
    "dob/paper",
    "fts",
    "fts/calibrate-toroid",
    "fts/commission",
    "fts/identify",
    "fts/leaving",
    "polish",
    "polish/commission",
]
BY_EVENTS = ["centering", "deburr", "dob", "fts", "polish"]
EXACT = {"deburr", "deburr/twice", "dob", "dob/nan", "dob/paper"}
BOUND = 1e-8
"""Of the largest value of an output: `sin` and `cos` are those of each system, and round in their own way."""
ESTIMATE = 1e-6
"""Tolerance for results of a commissioning run: its least squares amplify rounding differences."""
LEAST = 1e-9
"""Lower bound of the value to which the tolerance refers, in SI units: smaller ones may be rounding."""

pytestmark = [
    pytest.mark.platforms,
    pytest.mark.skipif(
        not SET.is_dir(),
        reason="the release set is not built: `cargo xtask test --platforms` builds and runs it",
    ),
]


@dataclass(frozen=True)
class Replay:
    """Outputs of an FMU for a recording."""

    outputs: NDArray[np.uint64]
    log: str


@dataclass(frozen=True)
class Case:
    """A recording, the FMU that it belongs to, and what the FMU did in the closed loop."""

    description: Any
    folder: Path
    recording: Path
    outputs: list[ScalarVariable]
    trace: NDArray[Any]

    def replay(self, on: Machine, program: Path, out: Path, *mode: str) -> Replay:
        """Run the recording on a platform, by steps or by `events`."""
        name = self.description.coSimulation.modelIdentifier
        library = self.folder / "binaries" / on.name / f"{name}.{on.extension}"
        files = [on.path(library), self.description.guid, on.uri(self.folder / "resources")]
        result = on.run(program, *files, on.path(self.recording), on.path(out), *mode)
        assert (result.returncode, result.stderr) == (0, "")
        words = np.fromfile(out, dtype="<u8").reshape(-1, len(self.outputs))
        return Replay(words, result.stdout)


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("platforms")


@cache
def program(name: str, folder: Path) -> tuple[Machine, Path]:
    """Return a platform and the program that replays recordings on it."""
    on = machine(name)
    return on, on.compile(folder)


@cache
def case(loop: str, folder: Path) -> Case:
    """Run a closed loop and write down what its controller got."""
    scenario = cosim.load(loop, ["loop.record_every=1"])
    result = cosim.run(scenario, SEED)
    trace = result.trace
    assert trace is not None
    file = SET / f"{scenario.controller.fmu}.fmu"
    unpacked = folder / loop.replace("/", "-")
    fmpy.extract(str(file), str(unpacked))
    description = fmpy.read_model_description(str(file))
    variables = {variable.name: variable for variable in description.modelVariables}
    inputs = [v for v in variables.values() if v.causality == "input" and v.type != "String"]
    outputs = [v for v in variables.values() if v.causality in ("output", "local") and v.type != "String"]
    given = []
    for name, value in scenario.controller.parameters.items():
        # an array has a variable for each of its elements
        elements = enumerate(value, start=1) if isinstance(value, list | tuple) else ()
        given += [(variables[f"{name}[{i}]"], element) for i, element in elements] or [
            (variables[name], value)
        ]

    rows = max(ROWS, len(trace))
    words = [len(given), len(inputs), len(outputs), rows, rows // 2]
    parts = [struct.pack("<5Q", *words), struct.pack("<d", scenario.loop.step)]
    parts += [struct.pack("<2Q", KINDS[v.type], v.valueReference) + word(v, value) for v, value in given]
    parts += [struct.pack("<2Q", KINDS[v.type], v.valueReference) for v in [*inputs, *outputs]]
    columns = [column(v, trace[f"controller.{v.name}"], rows) for v in inputs]
    recording = unpacked / "recording"
    recording.write_bytes(b"".join(parts) + np.stack(columns, axis=1).tobytes())
    return Case(description, unpacked, recording, outputs, trace)


def word(variable: ScalarVariable, value: Any) -> bytes:
    """Return a value as the program reads it."""
    if variable.type == "String":
        text = str(value).encode()
        return struct.pack("<Q", len(text)) + text.ljust(-(-len(text) // 8) * 8, b"\0")
    if variable.type == "Enumeration" and isinstance(value, str):
        value = next(int(item.value) for item in variable.declaredType.items if item.name == value)
    return struct.pack("<d", value) if variable.type == "Real" else struct.pack("<q", int(value))


def column(variable: ScalarVariable, values: NDArray[Any], rows: int) -> NDArray[np.uint64]:
    """Return an input in every row; it stays what it was at the end of the loop."""
    kind = np.float64 if variable.type == "Real" else np.int64
    held = np.concatenate([values, np.repeat(values[-1:], rows - len(values))])
    return held.astype(kind).view(np.uint64)


def deviation(home: NDArray[np.uint64], away: NDArray[np.uint64]) -> float:
    """Return 0 for equal bits, else the largest difference as a part of the largest value, or of `LEAST`."""
    if np.array_equal(home, away):
        return 0.0
    one, other = home.view(np.float64), away.view(np.float64)
    # NaN against a number exceeds every bound
    return float(np.max(np.abs(one - other)) / max(np.max(np.abs(one)), LEAST))


@pytest.mark.parametrize("loop", LOOPS)
@pytest.mark.parametrize("name", [AARCH64, WIN64])
def test_outputs_and_log_are_those_of_linux64(name: str, loop: str, folder: Path) -> None:
    reported = case(loop, folder)
    home = reported.replay(*program(LINUX64, folder), folder / "home")
    away = reported.replay(*program(name, folder), folder / "away")
    assert len(home.outputs) >= ROWS
    reals = [f"controller.{v.name}" if v.type == "Real" else "" for v in reported.outputs]
    # the program replays what happened in the loop
    for k, column_name in enumerate(reals):
        if column_name in (reported.trace.dtype.names or ()):
            happened = np.asarray(reported.trace[column_name], dtype=np.float64).view(np.uint64)
            assert np.array_equal(home.outputs[: len(happened), k], happened), column_name
    for k, v in enumerate(reported.outputs):
        bound = (
            0.0
            if v.type != "Real" or loop in EXACT
            else ESTIMATE
            if v.name.startswith("measured.")
            else BOUND
        )
        assert deviation(home.outputs[:, k], away.outputs[:, k]) <= bound, v.name
    assert home.log == away.log
    assert home.log


@pytest.mark.parametrize("loop", BY_EVENTS)
@pytest.mark.parametrize("name", [LINUX64, AARCH64, WIN64])
def test_events_give_the_samples_of_steps(name: str, loop: str, folder: Path) -> None:
    reported, (on, replays) = case(loop, folder), program(name, folder)
    steps = reported.replay(on, replays, folder / "steps")
    events = reported.replay(on, replays, folder / "events", "events")
    assert np.array_equal(events.outputs, steps.outputs)
    assert events.log == steps.log


@pytest.mark.parametrize("name", [LINUX64, AARCH64, WIN64])
def test_a_panic_is_an_error_of_one_instance(name: str, folder: Path) -> None:
    on, replays = program(name, folder)
    probe = FOLDER / "probe"
    description = fmpy.read_model_description(str(probe))
    failure = next(v for v in description.modelVariables if v.name == "failure")
    recording = folder / "failure"
    given = struct.pack("<2Q", KINDS[failure.type], failure.valueReference) + word(failure, "Panic")
    recording.write_bytes(struct.pack("<5Qd", 1, 0, 0, 1, 0, 1e-3) + given)
    library = on.path(probe / f"binaries/{name}/probe.{on.extension}")
    result = on.run(replays, library, description.guid, on.uri(probe), on.path(recording), "fails")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.count("panic") >= 2, result.stdout


FMUS = ["fmu-centering", "fmu-deburr", "fmu-dob", "fmu-fts", "fmu-polish"]


@pytest.mark.parametrize("name", FMUS)
def test_every_fmu_holds_all_platforms(name: str) -> None:
    with zipfile.ZipFile(SET / f"{name}.fmu") as archive:
        folders = {path.split("/")[1] for path in archive.namelist() if path.startswith("binaries/")}
    assert folders == {LINUX64, AARCH64, WIN64}


@pytest.mark.parametrize("name", FMUS)
def test_every_fmu_is_small(name: str) -> None:
    assert (SET / f"{name}.fmu").stat().st_size <= 1_500_000


@pytest.mark.parametrize("name", FMUS)
def test_libraries_have_no_texts_that_are_files_of_the_fmu(name: str, tmp_path: Path) -> None:
    with zipfile.ZipFile(SET / f"{name}.fmu") as archive:
        for path in (path for path in archive.namelist() if path.startswith("binaries/")):
            assert b"<fmiModelDescription" not in archive.read(path), path
        library = archive.extract(f"binaries/{LINUX64}/{name.replace('-', '_')}.so", tmp_path)
    file = ctypes.CDLL(library).fmi2_export_file
    file.restype = ctypes.c_char_p
    assert file(b"") is None
    assert file(b"modelDescription.xml") is None


def test_libraries_are_portable_and_of_one_model() -> None:
    for file in sorted(SET.glob("*.fmu")):
        command = ["cargo", "run", "--quiet", "--package", "cargo-fmu", "--", "fmu", "inspect", str(file)]
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert (run.returncode, run.stdout.count("46 functions")) == (0, 3), run.stdout + run.stderr
