"""Worker processes without the calls that only POSIX has, as on Windows: limits, crashes, equal results."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest

from cosim.pool.worker_handle import ending

from ..conftest import DATA
from ..sweep import studies
from . import command

Write = Callable[..., Path]
ENDS = {
    "a crash": (["controller.crash_at=3"], (), "the FMU `probe` crashed at t = 0.003 s (step 3): killed by"),
    "an exit": (["controller.exit_at=3"], (), "it ended the process with exit code 0"),
    "a hang": (["controller.hang_at=3"], ("--timeout", "3"), "no result within `--timeout` = `3` s: the FMU"),
    "memory": (["controller.eat_at=3"], ("--memory", "300"), "MB of memory are more than `--memory` = `300`"),
}


@pytest.fixture(autouse=True)
def _portable(write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Write the lag scenario and hostile plants; let processes use only what Windows has as well."""
    for name in ("hostile_plants.py", "counting.py"):
        shutil.copy(DATA / name, folder / name)
    write(studies.MEASURED)
    monkeypatch.setenv("COSIM_PORTABLE", "1")


@pytest.mark.parametrize(("changes", "options", "line"), ENDS.values(), ids=ENDS)
def test_what_ends_a_process_is_one_line(changes: list[str], options: tuple[str, ...], line: str) -> None:
    settings = [word for change in changes for word in ("--set", change)]
    done = command.finished(*settings, *options)
    assert done.returncode == 2
    assert any(text.startswith("error: ") and line in text for text in done.stderr.splitlines()), done.stderr


@pytest.mark.parametrize("engine", ["reference", "native"])
def test_results_are_those_of_posix(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def result() -> dict[str, object]:
        done = command.finished("--json", "-", "--timeout", "60", "--memory", "500", "--engine", engine)
        found: dict[str, object] = json.loads(done.stdout)
        return {name: value for name, value in found.items() if name != "wall_s"}

    portable = result()
    monkeypatch.delenv("COSIM_PORTABLE")
    assert portable == result()


def test_a_sweep_has_several_processes_and_a_row_for_a_crash(folder: Path) -> None:
    cases = [*(f"controller.gain = 0.{k}" for k in range(1, 6)), "controller.crash_at = 3"]
    text = studies.case_list([f'{case}\nplant.name = "counting:Counting"' for case in cases])
    (folder / "study.toml").write_text(text)
    studies.sweep("study.toml", "--workers", "2")
    statuses = [row["status"] for row in studies.rows(folder / "study.sweep")]
    assert statuses == ["passed"] * 5 + ["crashed"]
    assert len(set((folder / "processes").read_text().split())) > 1


def test_a_change_of_the_process_is_left_to_its_run(folder: Path) -> None:
    (folder / "changing.py").write_text(
        "import os, probe_plants\nclass Changing(probe_plants.Lag):\n    def advance(self, substeps):\n"
        "        super().advance(substeps)\n        os.environ['CHANGED'] = str(os.getpid())\n"
    )
    (folder / "study.toml").write_text(studies.case_list(['plant.name = "changing:Changing"'] * 2))
    done = studies.sweep("study.toml", "--workers", "1")
    assert "changed the environment variables of its process" in done.stderr


def test_what_a_run_starts_ends_with_it(folder: Path) -> None:
    (folder / "starting.py").write_text(
        "import pathlib, subprocess, sys, time, probe_plants\nclass Starting(probe_plants.Lag):\n"
        "    def advance(self, substeps):\n"
        "        child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(100)'])\n"
        "        pathlib.Path('child').write_text(str(child.pid))\n        time.sleep(100)\n"
    )
    assert command.finished("--set", "plant.name=starting:Starting", "--timeout", "2").returncode == 2
    child = int((folder / "child").read_text())
    studies.wait_for(lambda: not psutil.pid_exists(child))


def test_a_worker_ends_with_the_process_that_started_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "tmp").mkdir()
    monkeypatch.setenv("TMPDIR", str(folder / "tmp"))
    with command.started("--set", "plant.name=hostile_plants:Slow") as process:
        command.wait_for_line(process, "asleep")
        (worker,) = psutil.Process(process.pid).children()
        process.kill()
    worker.wait(timeout=20.0)
    assert not list((folder / "tmp").iterdir())


def test_exit_codes_of_windows_are_named() -> None:
    assert ending(0xC0000005) == "killed by exception 0xC0000005 (access violation)"
    assert ending(0xC0000374) == "killed by exception 0xC0000374 (see NTSTATUS)"
