"""Builds the C libraries and programs with them; a driver that replays recorded inputs."""

from __future__ import annotations

import json
import shutil
import subprocess
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.model_description import ModelDescription, ScalarVariable
from numpy.typing import NDArray

import cosim

from ..conftest import ROOT, need

FOLDER = ROOT / "target/c"
RARE = ("centering", "fts")
# a library takes a minute to build: by default those of the C++ example, and one with arrays, texts and files
CONTROLLERS = [
    "dob",
    "polish",
    "deburr",
    *(pytest.param(name, marks=pytest.mark.full) for name in RARE),
]
ROWS = 5000
WORDS = ("export", "import", "register")
"""Parts of names that C or C++ keeps for itself."""
WARNINGS = ["-Wall", "-Wextra", "-Werror"]

DRIVER = """
#include <stdio.h>
#include <stdlib.h>
#include "{id}.h"

static void log_message(void *user, int level, const char *text) {{
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
    {id} *one = {id}_new(&p, count > 2 ? words[2] : NULL, log_message, NULL), *other = NULL;
    if (one == NULL) return 1;
    const long half = atol(words[1]);
    for (long k = 0; fread(row, sizeof *row, {columns}, stdin) == {columns}; k++) {{
        if (k == half) {{
            /* continues in another instance, which has no parameters */
            const size_t size = {id}_save(one, NULL, 0);
            void *bytes = malloc(size);
            {id}_start_parameters(&p);
            other = {id}_new(&p, count > 2 ? words[2] : NULL, log_message, NULL);
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
    name = ".".join(f"{part}_" if part in WORDS else part for part in name.split("."))
    return f"{name}[{int(number[:-1]) - 1}]" if bracket else name


def value(variable: ScalarVariable, reported: Any, identifier: str) -> str:
    """Return a value as C writes it."""
    if variable.type == "Enumeration":
        return f"{identifier}_{variable.declaredType.name}_{reported}"
    if variable.type == "Boolean":
        return "true" if reported else "false"
    return json.dumps(reported) if variable.type == "String" else repr(reported)


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
            f"    p.{member(known[name])} = {value(known[name], reported, identifier)};"
            for name, reported in parameters.items()
        ),
        inputs="\n".join(
            f"        in.{member(v)} = {cast(v)}row[{i}]{zero[v.name]};" for i, v in enumerate(inputs)
        ),
        outputs=", ".join(f"(double)out.{member(v)}" for v in outputs),
    )


@dataclass(frozen=True)
class Recorded:
    """Inputs of a controller in a closed loop, and its outputs.

    Parameters
    ----------
    inputs
        Variables of the columns of `rows`.
    rows
        Inputs, shape (samples, inputs).
    outputs
        What was computed, as numbers, by the variables.
    """

    file: Path
    description: ModelDescription
    parameters: dict[str, Any]
    inputs: list[Any]
    rows: NDArray[np.float64]
    outputs: dict[Any, NDArray[np.float64]]


@cache
def recorded(name: str) -> Recorded:
    """Run the closed loop of a controller, and return its first samples."""
    scenario = cosim.load(name)
    trace = cosim.run(scenario, 71_003, engine="native").trace
    assert trace is not None
    file = ROOT / f"target/fmu/{scenario.controller.fmu}.fmu"
    description = fmpy.read_model_description(str(file))
    columns = {
        v: trace[f"controller.{v.name}"][:ROWS].astype(np.float64)
        for v in description.modelVariables
        if f"controller.{v.name}" in (trace.dtype.names or ())
    }
    inputs = [v for v in columns if v.causality == "input"]
    outputs = {v: c for v, c in columns.items() if v.causality in ("output", "local") and v.type != "String"}
    assert len(inputs) == sum(v.causality == "input" for v in description.modelVariables)
    assert outputs
    rows = np.stack([columns[v] for v in inputs], axis=1)
    return Recorded(file, description, scenario.controller.parameters, inputs, rows, outputs)


def replaying(name: str, loop: Recorded, folder: Path) -> tuple[Path, Path]:
    """Compile the driver for a controller, and return it and the folder of the FMU's resources."""
    source = folder / "driver.c"
    source.write_text(driver(loop.description, loop.parameters, loop.inputs, list(loop.outputs)))
    with zipfile.ZipFile(loop.file) as archive:
        archive.extractall(folder / "fmu")
    return compiled(source, folder / "driver", name), folder / "fmu/resources"
