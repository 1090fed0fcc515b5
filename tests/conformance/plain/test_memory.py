"""Memory of a C library: no allocation in a sample, and no use after free."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from ..conftest import need
from .libraries import CONTROLLERS, compiled, recorded, replaying

SAMPLES = 100

pytestmark = pytest.mark.xdist_group("builds")


def usage(command: list[str], given: bytes = b"") -> str:
    """Run a program under valgrind, which finds nothing wrong; return how often it allocated and how much."""
    valgrind = need("valgrind", shutil.which("valgrind"))
    whole = [valgrind, "--leak-check=full", "--error-exitcode=9", *command]
    run = subprocess.run(whole, input=given, capture_output=True, check=False)
    reported = run.stderr.decode()
    assert run.returncode == 0, reported
    return next(line.split("heap usage:")[1] for line in reported.splitlines() if "heap usage:" in line)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_sample_allocates_nothing(name: str, tmp_path: Path) -> None:
    loop = recorded(name)
    program, resources = replaying(name, loop, tmp_path)
    # the first samples of the loop in which the controller works without a new message
    news = [column for variable, column in loop.outputs.items() if variable.name in ("state", "fault")]
    state = np.stack(news, axis=1)
    idle, same = state[0], SAMPLES
    first = next(
        k
        for k in range(1, len(state) - same)
        if (state[k : k + same] == state[k]).all() and state[k][0] != idle[0]
    )

    def after(samples: int) -> str:
        # nothing is saved
        command = [str(program), str(len(loop.rows)), str(resources)]
        return usage(command, loop.rows[:samples].tobytes())

    assert after(first + 5) == after(first + same)


def test_what_is_freed_while_it_shows_stays_valid(tmp_path: Path) -> None:
    source = tmp_path / "free.c"
    source.write_text(
        """
        #include "fmu_dob.h"
        static fmu_dob *c;
        static int logged;
        static void log_message(void *user, int level, const char *text) {
            (void)user, (void)level, (void)text;
            logged++;
            fmu_dob_free(c);
        }
        int main(void) {
            fmu_dob_parameters p;
            fmu_dob_inputs in;
            fmu_dob_outputs out;
            fmu_dob_start_parameters(&p);
            fmu_dob_start_inputs(&in);
            c = fmu_dob_new(&p, NULL, log_message, NULL);
            for (int k = 0; k < 200; k++) {
                in.enable = k > 100;
                if (!fmu_dob_step(c, &in, &out)) return 1;
            }
            fmu_dob_free(c);
            return logged == 0;
        }
        """
    )
    usage([str(compiled(source, tmp_path / "free", "dob"))])
