"""Commands that open an FMU or build a plant survive it: one clear line, exit code 2, limits, Ctrl-C."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ..cli.commands import cosim
from ..conftest import DATA, SCENARIO, grid
from . import command

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="signals of Linux")
BUILT = "the plant `hostile_plants:AbortInInit` crashed while it was built: killed by SIGABRT"
EXITS = "the FMU `probe` crashed while it was initialized: it ended the process with exit code 0"


@pytest.fixture(autouse=True)
def lag(write: Write, folder: Path) -> Path:
    """Write the lag scenario and one with a plant that aborts, one with an FMU that exits, and a study."""
    shutil.copy(DATA / "hostile_plants.py", folder / "hostile_plants.py")
    write()
    write(text=SCENARIO.replace("probe_plants:Lag", "hostile_plants:AbortInInit"), name="abort.toml")
    write("[controller.parameters]\nexit_at = -2\n", name="exit.toml")
    (folder / "study.toml").write_text(grid(name=["hostile_plants:AbortInInit"]))
    return folder


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["show", "abort.toml"], BUILT),
        (["new", "probe.fmu", "hostile_plants:AbortInInit"], BUILT),
    ],
    ids=["show", "new"],
)
def test_a_crash_is_one_line(arguments: list[str], line: str) -> None:
    done = cosim(*arguments)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"error: {line}\n")


def test_a_crash_in_a_check_loses_no_other_file() -> None:
    done = cosim("check", "abort.toml", "exit.toml", "study.toml", "lag.toml", "-q")
    assert (done.returncode, done.stdout) == (2, "lag.toml: scenario, valid\n")
    assert done.stderr.splitlines() == [
        f"error: `abort.toml`: {BUILT}",
        f"error: `exit.toml`: {EXITS}",
        f"error: `study.toml`: {BUILT}",
    ]


@pytest.mark.parametrize("name", ["show", "check", "new"])
def test_a_plant_that_does_not_return_ends_with_the_timeout_or_ctrl_c(name: str, lag: Path) -> None:
    text = SCENARIO.replace("probe_plants:Lag", "hostile_plants:SleepInInit")
    (lag / "sleep.toml").write_text(text)
    words = ("new", "probe.fmu", "hostile_plants:SleepInInit") if name == "new" else (name, "sleep.toml")
    with command.started("--timeout", "0.5", command=words) as process:
        stdout, stderr = process.communicate(timeout=100.0)
    assert (process.returncode, stdout) == (2, "")
    assert "no result within `--timeout` = `0.5` s" in stderr
    with command.started(command=words) as process:
        command.wait_for_line(process, "asleep")
        stdout, stderr = command.interrupted(process)
    assert (process.returncode, stdout, stderr) == (130, "", "error: interrupted\n")
    assert not (lag / "probe.toml").exists()


@pytest.mark.parametrize("name", ["show", "check"])
def test_a_limit_needs_a_process(name: str) -> None:
    done = cosim(name, "lag.toml", "--timeout", "5", "--in-process")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("error: `--timeout` needs a separate process\n")
