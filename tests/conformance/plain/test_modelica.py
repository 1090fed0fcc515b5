"""The controllers as blocks of Modelica: a package that tools read, and the C code of the blocks."""

from __future__ import annotations

import importlib.util
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest
from fmpy import read_model_description

from ..conftest import ROOT, need
from .libraries import CONTROLLERS, RARE, WORDS, compiled

PACKAGE = ROOT / "target/modelica/MachiningFMUs"
UTILITIES = """
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#define ModelicaFormatMessage printf
#define ModelicaFormatWarning printf
static void ModelicaError(const char *text) { fputs(text, stderr); exit(9); }
"""
PROGRAM = """
#include "fmu_dob_modelica.h"
int main(void) {
    const double reals[] = {%s};
    const int integers[] = {%s};
    const char *texts[] = {%s};
    fmu_dob_parameters p;
    fmu_dob_inputs in;
    fmu_dob_outputs out;
    fmu_dob_start_parameters(&p);
    fmu_dob_start_inputs(&in);
    p.io_delay = 0;
    fmu_dob *plain = fmu_dob_new(&p, NULL, NULL, NULL);
    void *block = fmu_dob_modelica_new(reals, integers, texts, "");
    for (int k = 0; k < 5000; k++) {
        double seen[256];
        int numbers[256];
        in.position = 1e-9 * (k %% 5);
        in.enable = k > 100;
        /* in the order of the block */
        const double reals_in[] = {in.position, in.spindle_speed};
        const int integers_in[] = {in.position_valid, in.enable, in.commission, in.calibrate, in.reset_fault};
        fmu_dob_modelica_step(block, reals_in, integers_in, seen, numbers);
        if (!fmu_dob_step(plain, &in, &out) || out.current != seen[0] || (int)out.state != numbers[0])
            return 1;
    }
    fmu_dob_modelica_free(block);
    fmu_dob_free(plain);
    return 0;
}
"""

EXAMPLES = {"Contact": "dob", "Mold": "polish", "Edge": "deburr", "Lens": "fts", "Ring": "centering"}
"""And the controller of each."""

pytestmark = pytest.mark.xdist_group("builds")


@cache
def package(name: str) -> Path:
    """Build the package with the block of a controller."""
    command = ["cargo", "xtask", "c", "--modelica", name]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return PACKAGE


def block_of(name: str) -> Path:
    """File of the block that calls the library of a controller."""
    (file,) = [file for file in package(name).glob("*.mo") if f"fmu_{name}_modelica.h" in file.read_text()]
    return file


@pytest.mark.parametrize(
    "file",
    ["package.mo", "Interfaces.mo", "Examples/package.mo", *(f"Examples/{name}.mo" for name in EXAMPLES)],
)
def test_rumoca_reads_what_is_written_by_hand(file: str) -> None:
    need("rumoca", "rumoca" if importlib.util.find_spec("rumoca") else None)
    import rumoca

    text = (ROOT / "modelica/MachiningFMUs" / file).read_text()
    assert rumoca.format(text)
    with pytest.raises(RuntimeError):
        rumoca.format("ende ".join(text.rsplit("end ", 1)))


@pytest.mark.client("rumoca", "reads the block of Modelica")
@pytest.mark.parametrize("name", CONTROLLERS)
def test_rumoca_reads_the_block(name: str) -> None:
    need("rumoca", "rumoca" if importlib.util.find_spec("rumoca") else None)
    import rumoca

    text = block_of(name).read_text()
    assert rumoca.format(text)
    with pytest.raises(RuntimeError):
        rumoca.format(text.replace("end when;", "", 1))


@pytest.mark.parametrize(
    ("example", "name"),
    [
        pytest.param(example, name, marks=pytest.mark.full if name in RARE else ())
        for example, name in EXAMPLES.items()
    ],
)
def test_rumoca_resolves_an_example_up_to_its_external_object(example: str, name: str) -> None:
    need("rumoca", "rumoca" if importlib.util.find_spec("rumoca") else None)
    import rumoca

    file = package(name) / f"Examples/{example}.mo"
    session = rumoca.Session(roots=[str(PACKAGE)])
    # all names, types and units are found; what it cannot compile is the external object itself
    with pytest.raises(rumoca.CompileError, match=r"failed in ToDae.*unsupported type `Controller`"):
        session.load(file, model=f"MachiningFMUs.Examples.{example}")


@pytest.mark.parametrize(("example", "name"), EXAMPLES.items())
def test_an_example_has_one_equation_for_every_input_of_its_block(example: str, name: str) -> None:
    # rumoca finds no fault with a block of which an input is left open
    description = read_model_description(str(ROOT / f"target/fmu/fmu-{name}.fmu"))
    inputs = [flat(v.name) for v in description.modelVariables if v.causality == "input"]
    text = (ROOT / f"modelica/MachiningFMUs/Examples/{example}.mo").read_text()
    assert sorted(re.findall(r"^  controller\.(\w+) = ", text, re.MULTILINE)) == sorted(inputs)


def flat(name: str) -> str:
    """Name of a variable in a block of Modelica."""
    return re.sub(r"[.[]", "_", name).replace("]", "")


def lists(text: str) -> list[list[str]]:
    """Names in the arrays that a block hands over: Reals, Integers, texts of parameters, then of inputs."""
    made = text.split("controller_ = Controller(")[1].split("end when;")[0]
    arrays = re.findall(r"\{([^}]*)\}|fill\([^)]*\)", made)
    plain = r"if (\w+) then 1 else 0|Integer\((\w+)\)"
    return [
        [re.sub(plain, r"\1\2", item).strip() for item in array.split(",") if item.strip()]
        for array in arrays
    ]


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_block_and_its_code_have_one_order(name: str) -> None:
    text = block_of(name).read_text()
    code = (PACKAGE / f"Resources/Include/fmu_{name}_modelica.h").read_text()

    def of_member(member: str) -> str:
        numbered = re.sub(r"\[(\d+)\]", lambda found: f"[{int(found[1]) + 1}]", member)
        return re.sub(rf"({'|'.join(WORDS)})_", r"\1", flat(numbered))

    taken: dict[str, list[str]] = {}
    for member, array, index in re.findall(r"(?:p|in)\.([^ ]+) = (?:\(\w+\))?(\w+)\[(\d+)\];", code):
        names = taken.setdefault(array, [])
        assert len(names) == int(index)
        names.append(of_member(member))
    arrays = ("reals", "integers", "texts", "reals_in", "integers_in")
    assert lists(text) == [taken.get(array, []) for array in arrays]
    given = re.findall(r"(reals|integers)\[(\d+)\] = out\.([^;]+);", code)
    # each index of both arrays once, and as many as the block has
    for array in ("reals", "integers"):
        (size,) = re.findall(rf"discrete \w+ {array}_\[(\d+)\];", text)
        assert [int(index) for to, index, _ in given if to == array] == list(range(int(size)))
    assert given
    for array, index, member in given:
        assert re.search(rf"^  {of_member(member)} = {array}_\[{int(index) + 1}\]", text, re.MULTILINE), (
            member
        )


def test_the_code_of_a_block_does_the_samples_of_the_library(tmp_path: Path) -> None:
    text = block_of("dob").read_text()
    reals, integers, texts, _, _ = lists(text)
    items = {
        kind: re.findall(r"^    (\w+) ", body, re.MULTILINE)
        for kind, body in re.findall(r"type (\w+) = enumeration\(\n(.*?)\)", text, re.DOTALL)
    }
    starts = dict(re.findall(r"parameter \w+ (\w+)(?:\([^)]*\))? = ([^ ]+) ", text))

    def number(start: str) -> str:
        kind, dot, item = start.partition(".")
        return (
            str(items[kind].index(item) + 1)
            if dot and kind in items
            else {"true": "1", "false": "0"}.get(start, start)
        )

    (tmp_path / "ModelicaUtilities.h").write_text(UTILITIES)
    source = tmp_path / "block.c"
    source.write_text(
        PROGRAM
        % tuple(
            ", ".join(values)
            for values in (
                [starts[name] for name in reals],
                [number(starts[name]) for name in integers],
                [starts[name] for name in texts],
            )
        )
    )
    program = compiled(source, tmp_path / "block", "dob", include=(tmp_path, PACKAGE / "Resources/Include"))
    run = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, ""), run.stdout
    assert "state `Approach`" in run.stdout
