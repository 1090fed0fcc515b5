"""The controllers as C libraries: what they compute is what their FMUs compute, bit for bit."""

from __future__ import annotations

import json
import shutil
import subprocess
import zipfile
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.model_description import ModelDescription, ScalarVariable

import cosim

from .conftest import ROOT, need
from .replay import put

FOLDER = ROOT / "target/c"
EXAMPLES = ROOT / "examples/plain-c"
# a library takes a minute to build: by default those of the C++ example
CONTROLLERS = [
    "dob",
    "polish",
    *(pytest.param(name, marks=pytest.mark.full) for name in ("centering", "deburr", "fts")),
]
ROWS = 5000
WARNINGS = ["-Wall", "-Wextra", "-Werror"]

pytestmark = pytest.mark.xdist_group("builds")

DRIVER = """
#include <stdio.h>
#include <stdlib.h>
#include "{id}.h"

static void tell(void *user, int level, const char *text) {{
    (void)user;
    if (level > 0) fprintf(stderr, "%s\\n", text);
}}

int main(int count, char **words) {{
    {id}_parameters p;
    {id}_inputs in;
    {id}_outputs out;
    double row[{columns}];
    {id}_start_parameters(&p);
    {id}_start_inputs(&in);
{parameters}
    {id} *one = {id}_new(&p, count > 2 ? words[2] : NULL, tell, NULL), *other = NULL;
    if (one == NULL) return 1;
    const long half = atol(words[1]);
    for (long k = 0; fread(row, sizeof *row, {columns}, stdin) == {columns}; k++) {{
        if (k == half) {{
            /* goes on in another instance, which knows no parameters */
            const size_t size = {id}_save(one, NULL, 0);
            void *bytes = malloc(size);
            {id}_start_parameters(&p);
            other = {id}_new(&p, count > 2 ? words[2] : NULL, tell, NULL);
            if (size == 0 || {id}_save(one, bytes, size) != size) return 2;
            if (!{id}_restore(other, bytes, size)) return 2;
            {id}_free(one);
            one = other;
            free(bytes);
        }}
{inputs}
        if (!{id}_step(one, &in, &out)) return 3;
        const double seen[] = {{{outputs}}};
        fwrite(seen, sizeof *seen, {seen}, stdout);
    }}
    {id}_free(one);
    return 0;
}}
"""


@cache
def built(name: str) -> Path:
    """Build the library of a controller and return its folder; what is up to date stays."""
    need("objcopy", shutil.which("objcopy"))
    command = ["cargo", "xtask", "c", name]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return FOLDER / f"fmu-{name}"


def compiled(
    source: Path,
    program: Path,
    *names: str,
    words: tuple[str, ...] = ("cc", "-std=c99"),
    include: tuple[Path, ...] = (),
) -> Path:
    """Compile and link a program with the libraries of some controllers."""
    compiler = need(words[0], shutil.which(words[0]))
    headers = [f"-I{folder}" for folder in (*map(built, names), *include)]
    archives = [str(built(name) / f"libfmu_{name}.a") for name in names]
    command = [compiler, *words[1:], *WARNINGS, *headers, str(source), *archives, "-lm", "-o", str(program)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, ""), run.stderr
    return program


def member(variable: ScalarVariable) -> str:
    """Return a variable as the member of a C struct: arrays begin with 0, keywords of C++ end with `_`."""
    name, bracket, number = variable.name.partition("[")
    name = ".".join(f"{part}_" if part in ("export", "import") else part for part in name.split("."))
    return f"{name}[{int(number[:-1]) - 1}]" if bracket else name


def value(variable: ScalarVariable, told: Any, identifier: str) -> str:
    """Return a value as C writes it."""
    if variable.type == "Enumeration":
        return f"{identifier}_{variable.declaredType.name}_{told}"
    if variable.type == "Boolean":
        return "true" if told else "false"
    return json.dumps(told) if variable.type == "String" else repr(told)


def driver(
    description: ModelDescription, parameters: dict[str, Any], inputs: list[Any], outputs: list[Any]
) -> str:
    """Return a C program that reads inputs row by row and writes outputs."""
    identifier = description.coSimulation.modelIdentifier
    known = {variable.name: variable for variable in description.modelVariables}

    def cast(variable: ScalarVariable) -> str:
        if variable.type == "Enumeration":
            return f"({identifier}_{variable.declaredType.name})"
        return "(int)" if variable.type == "Integer" else ""

    zero = {v.name: " != 0.0" if v.type == "Boolean" else "" for v in inputs}
    return DRIVER.format(
        id=identifier,
        columns=len(inputs),
        seen=len(outputs),
        parameters="\n".join(
            f"    p.{member(known[name])} = {value(known[name], told, identifier)};"
            for name, told in parameters.items()
        ),
        inputs="\n".join(
            f"        in.{member(v)} = {cast(v)}row[{i}]{zero[v.name]};" for i, v in enumerate(inputs)
        ),
        outputs=", ".join(f"(double)out.{member(v)}" for v in outputs),
    )


@pytest.mark.client("C", "replays a closed loop by the C library")
@pytest.mark.parametrize("name", CONTROLLERS)
def test_the_inputs_of_a_closed_loop_give_the_outputs_of_the_fmu(name: str, tmp_path: Path) -> None:
    scenario = cosim.load(name)
    trace = cosim.run(scenario, 71_003, engine="native").trace
    assert trace is not None
    file = ROOT / f"target/fmu/{scenario.controller.fmu}.fmu"
    description = fmpy.read_model_description(str(file))
    recorded = {v: trace[f"controller.{v.name}"][:ROWS] for v in description.modelVariables
                if f"controller.{v.name}" in (trace.dtype.names or ())}  # fmt: skip
    inputs = [v for v in recorded if v.causality == "input"]
    outputs = [v for v in recorded if v.causality in ("output", "local") and v.type != "String"]
    assert len(inputs) == sum(v.causality == "input" for v in description.modelVariables)
    assert outputs

    source = tmp_path / "driver.c"
    source.write_text(driver(description, scenario.controller.parameters, inputs, outputs))
    program = compiled(source, tmp_path / "driver", name)
    with zipfile.ZipFile(file) as archive:
        archive.extractall(tmp_path / "fmu")
    rows = np.stack([recorded[v].astype(np.float64) for v in inputs], axis=1)
    command = [str(program), str(len(rows) // 2), str(tmp_path / "fmu/resources")]
    run = subprocess.run(command, input=rows.tobytes(), capture_output=True, check=False)
    assert (run.returncode, run.stderr) == (0, b"")
    seen = np.frombuffer(run.stdout).reshape(-1, len(outputs))
    assert len(seen) == len(rows)
    for i, variable in enumerate(outputs):
        wanted = recorded[variable].astype(np.float64)
        assert np.array_equal(seen[:, i].view(np.uint64), wanted.view(np.uint64)), variable.name


def test_an_example_finds_the_contact(tmp_path: Path) -> None:
    program = compiled(EXAMPLES / "contact.c", tmp_path / "contact", "dob")
    run = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, ""), run.stdout
    assert "state `Detect`" in run.stdout


def test_two_controllers_share_one_program_in_cpp(tmp_path: Path) -> None:
    words = ("c++", "-std=c++17")
    program = compiled(EXAMPLES / "two.cpp", tmp_path / "two", "dob", "polish", words=words)
    run = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, ""), run.stdout
    assert "refused: fmi2SetReal: `approach.velocity` = 1.0 m/s is outside" in run.stdout


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_library_shows_nothing_but_what_its_header_declares(name: str) -> None:
    archive = built(name) / f"libfmu_{name}.a"
    command = ["nm", "--defined-only", "--extern-only", "--format=posix", str(archive)]
    nm = subprocess.run(command, capture_output=True, text=True, check=True)
    symbols = {line.split()[0] for line in nm.stdout.splitlines() if len(line.split()) > 1}
    header = (archive.parent / f"fmu_{name}.h").read_text()
    assert len(symbols) >= 10
    assert all(symbol.startswith(f"fmu_{name}_") and f"{symbol}(" in header for symbol in symbols), symbols
    assert str(ROOT).encode() not in archive.read_bytes()


def test_a_state_of_the_library_is_one_of_the_fmu(tmp_path: Path) -> None:
    source = tmp_path / "save.c"
    source.write_text(
        """
        #include <stdio.h>
        #include <stdlib.h>
        #include "fmu_dob.h"
        int main(void) {
            fmu_dob_parameters p;
            fmu_dob_inputs in;
            fmu_dob_outputs out;
            fmu_dob_start_parameters(&p);
            fmu_dob_start_inputs(&in);
            fmu_dob *c = fmu_dob_new(&p, NULL, NULL, NULL);
            for (int k = 0; k < 100; k++) {
                in.position = 1e-9 * k;
                if (!fmu_dob_step(c, &in, &out)) return 1;
            }
            const size_t size = fmu_dob_save(c, NULL, 0);
            void *bytes = malloc(size);
            if (fmu_dob_save(c, bytes, size) != size) return 1;
            fwrite(bytes, 1, size, stdout);
            free(bytes);
            fmu_dob_step(c, &in, &out);
            fwrite(&out.current, sizeof out.current, 1, stdout);
            fmu_dob_free(c);
            return 0;
        }
        """
    )
    run = subprocess.run([str(compiled(source, tmp_path / "save", "dob"))], capture_output=True, check=True)
    state, current = run.stdout[:-8], np.frombuffer(run.stdout[-8:])[0]

    slave, references = instance_of_dob(tmp_path)
    handle = slave.deSerializeFMUstate(state)
    slave.setFMUstate(handle)
    slave.freeFMUstate(handle)
    put(slave, references["position"], 99e-9)
    slave.doStep(currentCommunicationPoint=100e-4, communicationStepSize=1e-4)
    assert slave.getReal([references["current"].valueReference])[0] == current
    slave.freeInstance()


def instance_of_dob(folder: Path) -> tuple[FMU2Slave, dict[str, Any]]:
    """Return an instance of the FMU of the library, and its variables by name."""
    file = ROOT / "target/fmu/fmu-dob.fmu"
    description = fmpy.read_model_description(str(file))
    slave = FMU2Slave(
        instanceName="other",
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(file), str(folder / "fmu")),
        modelIdentifier=description.coSimulation.modelIdentifier,
    )
    slave.instantiate(callbacks=fmi2CallbackFunctions(logger=fmi2CallbackLoggerTYPE(lambda *_: None)))
    return slave, {variable.name: variable for variable in description.modelVariables}


@pytest.mark.parametrize("start", [0.0, -0.37, 2.00003])
def test_a_state_of_the_fmu_is_one_of_the_library(tmp_path: Path, start: float) -> None:
    source = tmp_path / "restore.c"
    source.write_text(
        """
        #include <stdio.h>
        #include "fmu_dob.h"
        int main(int count, char **words) {
            static char bytes[1 << 20];
            fmu_dob_parameters p;
            fmu_dob_inputs in;
            fmu_dob_outputs out;
            (void)count;
            fmu_dob_start_parameters(&p);
            fmu_dob_start_inputs(&in);
            fmu_dob *c = fmu_dob_new(&p, NULL, NULL, NULL);
            FILE *file = fopen(words[1], "rb");
            const size_t size = fread(bytes, 1, sizeof bytes, file);
            fclose(file);
            if (!fmu_dob_restore(c, bytes, size)) return 1;
            for (int k = 0; k < 300; k++) {
                // what is no state is refused, and changes nothing
                if (k % 100 == 50 && fmu_dob_restore(c, bytes, size / 2)) return 2;
                in.position = 1e-9 * k;
                if (!fmu_dob_step(c, &in, &out)) return 3;
                fwrite(&out.current, sizeof out.current, 1, stdout);
            }
            fmu_dob_free(c);
            return 0;
        }
        """
    )
    program = compiled(source, tmp_path / "restore", "dob", words=("cc", "-std=c11"))
    slave, references = instance_of_dob(tmp_path)
    slave.setupExperiment(startTime=start)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    # half a sample remains
    slave.doStep(currentCommunicationPoint=start, communicationStepSize=2.5e-4)
    handle = slave.getFMUstate()
    (tmp_path / "state").write_bytes(slave.serializeFMUstate(handle))
    slave.freeFMUstate(handle)
    expected = []
    for k in range(300):
        put(slave, references["position"], 1e-9 * k)
        slave.doStep(
            currentCommunicationPoint=start + 2.5e-4 + 1e-4 * k,
            communicationStepSize=1e-4,
        )
        expected.append(slave.getReal([references["current"].valueReference])[0])
    slave.freeInstance()
    run = subprocess.run([str(program), str(tmp_path / "state")], capture_output=True, check=False)
    assert (run.returncode, np.frombuffer(run.stdout).tolist()) == (0, expected)


def test_a_sample_allocates_nothing(tmp_path: Path) -> None:
    valgrind = need("valgrind", shutil.which("valgrind"))
    source = tmp_path / "steps.c"
    source.write_text(
        """
        #include <stdlib.h>
        #include "fmu_dob.h"
        int main(int count, char **words) {
            fmu_dob_parameters p;
            fmu_dob_inputs in;
            fmu_dob_outputs out;
            (void)count;
            fmu_dob_start_parameters(&p);
            fmu_dob_start_inputs(&in);
            fmu_dob *c = fmu_dob_new(&p, NULL, NULL, NULL);
            for (long k = atol(words[1]); k > 0; k--)
                if (!fmu_dob_step(c, &in, &out)) return 1;
            fmu_dob_free(c);
            return 0;
        }
        """
    )
    program = compiled(source, tmp_path / "steps", "dob")

    def allocations(steps: int) -> str:
        command = [valgrind, "--leak-check=full", "--error-exitcode=9", str(program), str(steps)]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr
        return next(line.split("heap usage:")[1] for line in run.stderr.splitlines() if "heap usage:" in line)

    assert allocations(10) == allocations(1000)
