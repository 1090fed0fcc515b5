"""Ctrl-C ends `cosim run` at any moment: exit code 130, one line, no remains."""

from __future__ import annotations

import os
import shutil
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import cosim

from ..conftest import DATA, SCENARIO
from ..test_cli import cosim as cli
from . import command

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX signals")

TOLD = "nothing drives `plant.extra`"
"""Part of a warning that a run logs when its FMU and plant are open, before the first step."""
UNDRIVEN = SCENARIO.replace(', "plant.extra"]', "]")
BUSY = {
    "in the loop": [command.STEPS],
    "in a step that hangs": ["--set", "controller.hang_at=3"],
    "in a step that logs for ever": ["--set", "controller.chat_at=3"],
    "in a plant that keeps the GIL": ["--set", "plant.name=hostile_plants:Hold"],
}


@pytest.fixture
def heard() -> Iterator[None]:
    """Ctrl-C raises in this process, also where the tests were started with it ignored (`nohup`, `&`)."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("arguments", BUSY.values(), ids=BUSY.keys())
def test_ctrl_c_ends_a_run(arguments: list[str], write: Write, folder: Path) -> None:
    shutil.copy(DATA / "hostile_plants.py", folder / "hostile_plants.py")
    write(text=UNDRIVEN)
    with command.started(*arguments, "-v", "--json", "-") as process:
        command.wait_for_line(process, TOLD)
        stdout, stderr = command.interrupted(process)
    assert (process.returncode, stdout) == (130, "")
    assert stderr.splitlines()[-1] == "error: interrupted"
    assert "Traceback" not in stderr


def test_ctrl_c_that_a_module_in_c_turned_into_another_error(write: Write, folder: Path) -> None:
    # as pybind11 does it
    (folder / "own.py").write_text(
        "try:\n    raise KeyboardInterrupt\n"
        "except BaseException as error:\n    raise ImportError('initialization failed') from error\n"
    )
    write()
    done = cli("run", "lag.toml", "--in-process", "--set", "plant.name=own:Plant")
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "error: interrupted\n")


@pytest.mark.parametrize("imported", ["typer", "rich.console", "cosim.pool.supervisor"])
def test_ctrl_c_during_the_imports(imported: str, write: Write, folder: Path) -> None:
    write()
    # the interpreter runs this before anything else; the signal comes in the middle of an import
    (folder / "sitecustomize.py").write_text(
        "import os, signal, sys\n"
        "class Press:\n"
        "    def find_spec(self, name, path, target=None):\n"
        f"        if name == {imported!r} and 'cosim' in sys.modules and os.getpid() != os.getsid(0):\n"
        "            os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Press())\n"
    )
    done = command.finished(command.STEPS, path=folder)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "error: interrupted\n")


@pytest.mark.parametrize("engine", ["reference", "native"])
def test_ctrl_c_in_process(engine: str, write: Write) -> None:
    write(text=UNDRIVEN)
    with command.started(command.STEPS, "--in-process", "-v", "--engine", engine) as process:
        command.wait_for_line(process, TOLD)
        stdout, stderr = command.interrupted(process)
    assert (process.returncode, stdout) == (130, "")
    assert stderr.splitlines()[-1] == "error: interrupted"


def test_the_second_ctrl_c_ends_a_step_that_hangs_in_process(write: Write) -> None:
    write(text=UNDRIVEN)
    with command.started("--set", "controller.hang_at=3", "--in-process", "-v") as process:
        command.wait_for_line(process, TOLD)
        stdout, stderr = command.interrupted(process, presses=2)
    assert (process.returncode, stdout) == (130, "")
    assert stderr.splitlines()[-1] == "error: interrupted"


@pytest.mark.usefixtures("heard")
def test_ctrl_c_within_a_callback_of_the_fmu_is_not_lost(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = cosim.load(write(), ["loop.duration=1000"])
    pressed = threading.Event()

    def press(*_: object) -> None:
        if not pressed.is_set():
            pressed.set()
            os.kill(os.getpid(), signal.SIGINT)

    with cosim.Session(scenario, log_events=True) as session:
        monkeypatch.setattr(session.fmu.messages, "add", press)
        slave = session.fmu.slave
        step = session.fmu.step

        def chatty(time: float, length: float) -> None:
            # as an FMU does that logs in a step: through the callback, from C
            session.fmu.messages.callbacks.logger(session.fmu.messages.handle, b"probe", 0, b"", b"text")
            step(time, length)

        monkeypatch.setattr(session.fmu, "step", chatty)
        assert slave.component
        with pytest.raises(KeyboardInterrupt):
            session.run()
    assert pressed.is_set()


def test_a_killed_command_leaves_no_worker(write: Write, folder: Path) -> None:
    import psutil

    shutil.copy(DATA / "hostile_plants.py", folder / "hostile_plants.py")
    write(text=UNDRIVEN)
    with command.started("--set", "plant.name=hostile_plants:Hold", "-v") as process:
        command.wait_for_line(process, TOLD)
        workers = psutil.Process(process.pid).children(recursive=True)
        assert workers
        process.kill()
        _, alive = psutil.wait_procs(workers, timeout=60)
    assert not alive
