"""A run that ends normally terminates its FMU and closes its plant; an aborted one does not wait."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.pool import supervisor

from ..conftest import DATA
from . import command

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")


@pytest.fixture
def notes(write: Write, folder: Path) -> Path:
    """Write the lag with a plant that notes what is done to it into the file that is returned."""
    shutil.copy(DATA / "hostile_plants.py", folder / "hostile_plants.py")
    sys.modules.pop("hostile_plants", None)
    write()
    return folder / "notes"


def test_a_run_terminates_its_fmu_and_closes_its_plant(notes: Path) -> None:
    changes = ("--set", "plant.name=hostile_plants:Notes", "--set", "controller.chat_at=-3")
    done = command.finished(*changes, "-v")
    assert done.returncode == 0
    assert "info: Probe [logAll] terminated after 50 steps" in done.stderr
    assert notes.read_text() == "built 0.5\nclosed 0.5\n"


def test_a_run_that_is_given_up_is_not_waited_for(notes: Path) -> None:
    slow = ("--set", "plant.name=hostile_plants:Slow")
    assert command.finished(*slow, "--timeout", "0.5").returncode == 2
    assert not notes.exists() or notes.read_text() == "built 0.5\n"
    notes.unlink(missing_ok=True)
    with command.started(*slow) as process:
        command.wait_for_line(process, "asleep")
        command.interrupted(process)
    assert (process.returncode, notes.read_text()) == (130, "built 0.5\n")


ENDINGS = {
    "a crash": (
        ["controller.crash_at=-3"],
        "the FMU `probe` crashed while it was terminated and freed: killed by SIGABRT",
    ),
    "a hang": (
        ["controller.hang_at=-3"],
        "the FMU `probe` hung while it was terminated and freed: it did not end within 0.5 s and was killed",
    ),
    "a plant that hangs": (
        ["plant.name=hostile_plants:Clings"],
        "the plant `hostile_plants:Clings` hung while it was closed: it did not end within 0.5 s",
    ),
    "a plant that fails": (
        ["plant.name=hostile_plants:Breaks"],
        "the plant `hostile_plants:Breaks` failed while it was closed: RuntimeError: the drive is stuck",
    ),
    "a crash when it is read": (
        ["controller.crash_at=-4"],
        "the FMU `probe` crashed while its variables were read after the run: killed by SIGABRT",
    ),
}


@pytest.mark.parametrize(("changes", "reported"), ENDINGS.values(), ids=ENDINGS)
def test_what_goes_wrong_at_the_end_is_a_warning_and_loses_no_result(
    changes: list[str],
    reported: str,
    notes: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    assert not notes.exists()
    monkeypatch.setattr(supervisor, "GRACE", 0.5)
    result = cosim.run(cosim.load("lag.toml", changes), isolated=True)
    assert result.simulated_s == pytest.approx(0.05)
    assert any(message.startswith(reported) for message in caplog.messages)


def test_many_runs_close_each_plant_once(notes: Path) -> None:
    scenarios = [
        cosim.load("lag.toml", ["plant.name=hostile_plants:Notes", f"plant.pole={pole}"])
        for pole in (0.1, 0.1, 0.2)
    ]
    for workers in (1, 2):
        results = cosim.run_each(scenarios, workers=workers)
        assert all(isinstance(result, cosim.Result) for result in results)
        lines = notes.read_text().splitlines()
        notes.unlink()
        for pole in ("0.1", "0.2"):
            assert lines.count(f"built {pole}") == lines.count(f"closed {pole}") > 0


def test_a_session_that_cannot_be_opened_closes_its_plant(notes: Path) -> None:
    changes = ["plant.name=hostile_plants:Notes", "loop.substeps=3"]
    with pytest.raises(cosim.CosimError, match="do not fill"):
        cosim.Session(cosim.load("lag.toml", changes))
    assert notes.read_text() == "built 0.5\nclosed 0.5\n"
