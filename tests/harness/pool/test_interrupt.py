"""Ctrl-C and SIGTERM end `cosim` at any moment: exit code 130, one line, no partial files."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree

import pytest

import cosim

from ..conftest import DATA, END, SCENARIO, entry
from ..test_cli import cosim as cli
from . import command

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX signals")

WARNING = "nothing drives `plant.extra`"
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
        command.wait_for_line(process, WARNING)
        stdout, stderr = command.interrupted(process)
    assert (process.returncode, stdout) == (130, "")
    assert stderr.splitlines()[-1] == "error: interrupted"
    assert "Traceback" not in stderr


@pytest.mark.parametrize("more", [[], ["--in-process"]])
def test_sigterm_ends_a_run_as_ctrl_c_does(more: list[str], write: Write, folder: Path) -> None:
    write(text=UNDRIVEN)
    with command.started(command.STEPS, "--trace", "t.parquet", "-v", *more) as process:
        command.wait_for_line(process, WARNING)
        stdout, stderr = command.interrupted(process, number=signal.SIGTERM)
    assert (process.returncode, stdout) == (130, "")
    assert stderr.splitlines()[-1] == "error: interrupted"
    assert not [file for file in folder.iterdir() if "parquet" in file.name]


def test_a_program_that_uses_the_harness_keeps_its_own_sigterm(write: Write, folder: Path) -> None:
    write(text=UNDRIVEN)
    program = (
        "import cosim; print('begins', flush=True); cosim.run(cosim.load('lag.toml', ['loop.duration=1000']))"
    )
    line = [sys.executable, "-c", program]
    variables = {**os.environ, "PYTHONPATH": str(command.ROOT)}
    with subprocess.Popen(line, stdout=subprocess.PIPE, text=True, env=variables) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begins\n"
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=60) == -signal.SIGTERM


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_tests_leave_the_results_until_then(
    number: int, write: Write, folder: Path, tmp_path: Path
) -> None:
    write(END + entry("criterion", id="end", claim="ends", metric="end", maximum=9.0), name="fast.toml")
    write(END + "[plant.parameters]\nstall_at = 3\n", name="slow.toml")
    (folder / "out").mkdir()
    (folder / "out" / ".slow.0badcafe.partial.svg").write_text("of a process that was killed")
    outputs = ("--out", "out", "--junit", "j.xml", "--json", "j.json")
    line = ("test", "fast.toml", "slow.toml", "--workers", "1", *outputs)
    with command.started(command=line) as process:
        command.wait_for_line(process, "fast: 1 of 1 criteria passed")
        stdout, stderr = command.interrupted(process, number=number)
    assert process.returncode == 130
    assert stderr.splitlines()[-1] == "error: interrupted"
    assert stdout == (folder / "out" / "acceptance.txt").read_text()
    assert stdout.splitlines()[-1] == "1 of 1 criteria passed, 1 of 2 scenarios could not run"
    suites = ElementTree.parse(folder / "j.xml").getroot()
    errors = {suite.get("name"): suite.get("errors") for suite in suites}
    assert errors == {"fast": "0", "slow": "1"}
    assert [entry["passed"] for entry in json.loads((folder / "j.json").read_text())] == [True, False]
    assert sorted(file.name for file in (folder / "out").iterdir()) == [
        "acceptance.txt",
        "fast.json",
        "fast.svg",
    ]


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
        command.wait_for_line(process, WARNING)
        stdout, stderr = command.interrupted(process)
    assert (process.returncode, stdout) == (130, "")
    assert stderr.splitlines()[-1] == "error: interrupted"


def test_the_second_ctrl_c_ends_a_step_that_hangs_in_process(write: Write) -> None:
    write(text=UNDRIVEN)
    with command.started("--set", "controller.hang_at=3", "--in-process", "-v") as process:
        command.wait_for_line(process, WARNING)
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
        monkeypatch.setattr(session.fmu.messages, "receive", press)
        slave = session.fmu.fmi.slave
        compute = session.fmu.compute

        def chatty(time: float, length: float) -> bool:
            # as an FMU does that logs in a step: through the callback, from C
            session.fmu.messages.callbacks.logger(session.fmu.messages.handle, b"probe", 0, b"", b"text")
            return compute(time, length)

        monkeypatch.setattr(session.fmu, "compute", chatty)
        assert slave.component
        with pytest.raises(KeyboardInterrupt):
            session.run()
    assert pressed.is_set()


def test_a_killed_command_leaves_no_worker(write: Write, folder: Path) -> None:
    import psutil

    shutil.copy(DATA / "hostile_plants.py", folder / "hostile_plants.py")
    write(text=UNDRIVEN)
    with command.started("--set", "plant.name=hostile_plants:Hold", "-v") as process:
        command.wait_for_line(process, WARNING)
        workers = psutil.Process(process.pid).children(recursive=True)
        assert workers
        process.kill()
        _, alive = psutil.wait_procs(workers, timeout=60)
    assert not alive
