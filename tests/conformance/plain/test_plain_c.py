"""The controllers as C libraries: what they compute is what their FMUs compute, bit for bit."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from ..conftest import ROOT
from ..replay import put
from .libraries import CONTROLLERS, built, compiled, recorded, replaying

EXAMPLES = ROOT / "examples/plain-c"

pytestmark = pytest.mark.xdist_group("builds")


@pytest.mark.client("C", "replays a closed loop by the C library")
@pytest.mark.parametrize("name", CONTROLLERS)
def test_the_inputs_of_a_closed_loop_give_the_outputs_of_the_fmu(name: str, tmp_path: Path) -> None:
    loop = recorded(name)
    program, resources = replaying(name, loop, tmp_path)
    command = [str(program), str(len(loop.rows) // 2), str(resources)]
    run = subprocess.run(command, input=loop.rows.tobytes(), capture_output=True, check=False)
    assert (run.returncode, run.stderr) == (0, b"")
    seen = np.frombuffer(run.stdout).reshape(-1, len(loop.outputs))
    assert len(seen) == len(loop.rows)
    for i, (variable, wanted) in enumerate(loop.outputs.items()):
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
    assert "rejected: fmi2SetReal: `approach.velocity` = 1.0 m/s is outside" in run.stdout


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
        #include <string.h>
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
            memset(bytes, 0x5a, size);
            /* a buffer that is too small stays unchanged, and the size is returned all the same */
            if (fmu_dob_save(c, bytes, size - 1) != size || size % 256) return 1;
            for (size_t i = 0; i < size; i++)
                if (((char *)bytes)[i] != 0x5a) return 1;
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
                // an invalid state is rejected and changes nothing
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
