"""A worker process leaves environment, disk and descriptors as they are."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ..conftest import grid
from ..sweep import studies
from . import command

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="descriptors and limits of Linux")


def test_what_a_run_starts_has_the_environment_of_the_command(write: Write, folder: Path) -> None:
    (folder / "starting.py").write_text(
        "import os, pathlib, probe_plants\nclass Starting(probe_plants.Lag):\n"
        "    def advance(self, substeps):\n        super().advance(substeps)\n"
        "        pathlib.Path('seen').write_text(os.environ['PYTHONPATH'])\n"
    )
    write()
    assert command.finished("--set", "plant.name=starting:Starting").returncode == 0
    assert (folder / "seen").read_text() == os.pathsep.join([str(command.ROOT)] * 2)


def test_a_run_that_prints_much_fills_no_disk(
    write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "printing.py").write_text(
        "import pathlib, tempfile, probe_plants\nclass Printing(probe_plants.Lag):\n"
        "    def advance(self, substeps):\n        super().advance(substeps)\n"
        "        print('.' * 200_000)\n"
        "        held = sum(file.stat().st_size for file in pathlib.Path(tempfile.gettempdir()).rglob('*'))\n"
        "        pathlib.Path('held').write_text(str(held))\n"
    )
    write()
    (folder / "tmp").mkdir()
    monkeypatch.setenv("TMPDIR", str(folder / "tmp"))
    (folder / "study.toml").write_text(studies.case_list(['plant.name = "printing:Printing"']))
    studies.sweep("study.toml")
    assert [row["status"] for row in studies.rows(folder / "study.sweep")] == ["done"]
    assert int((folder / "held").read_text()) == 0
    assert not list((folder / "tmp").iterdir())


def test_too_many_workers_for_the_limit_of_open_files_are_one_line(write: Write, folder: Path) -> None:
    write()
    (folder / "study.toml").write_text(grid(pole=[k / 200.0 for k in range(1, 101)]))
    words = f"ulimit -n 128; exec {sys.executable} -m cosim sweep study.toml --no-plots -q --workers 100"
    done = subprocess.run(
        ["bash", "-c", words],
        capture_output=True,
        text=True,
        env=studies.environment(),
        timeout=100,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.splitlines()[-2:] == [
        "error: a worker process cannot be started: Too many open files",
        "hint: Use fewer `--workers`, or raise the limits of the system.",
    ]
