"""An FMU or plant that crashes, hangs or exits is one clear line of `cosim run` and exit code 2."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError
from cosim.pool.job import WorkerError
from cosim.pool.limits import Limits

from ..cli.commands import called
from ..conftest import DATA
from . import command

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="signals and limits of Linux")


@pytest.fixture
def lag(write: Write, folder: Path) -> Path:
    """Write the lag scenario and hostile plants."""
    for name in ("hostile_plants.py", "exiting.py"):
        shutil.copy(DATA / name, folder / name)
    return write()


AT = "at t = 0.003 s (step 3)"
DEATHS = {
    "SIGSEGV": (["controller.crash_at=3"], f"the FMU `probe` crashed {AT}: killed by SIGSEGV"),
    "SIGABRT": (["controller.raise_at=3"], f"the FMU `probe` crashed {AT}: killed by SIGABRT"),
    "SIGBUS": (
        ["controller.raise_at=3", "controller.raised=7"],
        f"the FMU `probe` crashed {AT}: killed by SIGBUS",
    ),
    "real-time signal": (
        ["controller.raise_at=3", "controller.raised=40"],
        f"the FMU `probe` crashed {AT}: killed by signal 40",
    ),
    "exit": (
        ["controller.exit_at=3"],
        f"the FMU `probe` crashed {AT}: it ended the process with exit code 0",
    ),
    "exit in initialization": (
        ["controller.exit_at=-2"],
        "the FMU `probe` crashed while it was initialized: it ended the process with exit code 0",
    ),
    "sys.exit on import": (
        ["plant.name=exiting:Any"],
        "the plant `exiting:Any` ended the process: `sys.exit(0)`",
    ),
    "sys.exit in init": (
        ["plant.name=hostile_plants:ExitInInit"],
        "the plant `hostile_plants:ExitInInit` ended the process: `sys.exit(0)`",
    ),
    "sys.exit in reset": (
        ["plant.name=hostile_plants:ExitInReset"],
        "the plant `hostile_plants:ExitInReset` cannot be reset: SystemExit: 0",
    ),
    "sys.exit in a step": (
        ["plant.name=hostile_plants:ExitInStep"],
        "the plant `hostile_plants:ExitInStep` failed at t = 0.004 s (step 4): SystemExit: 0",
    ),
    "panic in init": (
        ["plant.name=hostile_plants:PanicsInInit"],
        "the plant `hostile_plants:PanicsInInit` cannot be built: at the first line",
    ),
    "panic in a step": (
        ["plant.name=hostile_plants:PanicsInStep"],
        "the plant `hostile_plants:PanicsInStep` failed at t = 0 s (step 0): Panic: at the first line",
    ),
    "a child that lives on": (
        ["plant.name=hostile_plants:Parent"],
        "the plant `hostile_plants:Parent` crashed at t = 0 s (step 0): killed by SIGABRT",
    ),
    "_exit": (
        ["plant.name=hostile_plants:Vanish"],
        "the plant `hostile_plants:Vanish` crashed at t = 0 s (step 0): it ended the process with exit",
    ),
}


@pytest.mark.parametrize(("changes", "line"), DEATHS.values(), ids=DEATHS.keys())
@pytest.mark.usefixtures("lag")
def test_a_death_is_one_line_and_exit_code_2(changes: list[str], line: str, folder: Path) -> None:
    options = [word for change in changes for word in ("--set", change)]
    done = command.finished(*options, "--json", "result.json")
    own = [text for text in done.stderr.splitlines() if text != "about to write to nowhere"]
    assert (done.returncode, done.stdout) == (2, "")
    assert own[0].startswith(f"error: {line}")
    assert all(text.startswith("hint: ") for text in own[1:])
    assert not (folder / "result.json").exists()
    if (folder / "child").exists():
        os.kill(int((folder / "child").read_text()), signal.SIGKILL)


@pytest.mark.usefixtures("lag")
@pytest.mark.parametrize("place", ["cosim.loop.session.Session.run", "cosim.pool.single_task.executor"])
def test_a_panic_of_anything_is_exit_code_2_in_this_process_too(
    place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def panic(*_: object, **__: object) -> None:
        raise GeneratorExit

    monkeypatch.setattr(place, panic)
    done = called("run", "lag.toml", "--in-process")
    assert done.returncode == 2
    assert done.stderr.startswith("error: unexpected error: GeneratorExit")


@pytest.mark.parametrize("engine", ["reference", "native"])
@pytest.mark.usefixtures("lag")
def test_a_hang_ends_with_the_timeout(engine: str) -> None:
    done = command.finished("--set", "controller.hang_at=3", "--timeout", "2", "--engine", engine, "-q")
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        f"error: no result within `--timeout` = `2` s: the FMU `probe` did not return {AT}",
        "hint: Increase `--timeout`, or check the scenario for a hang.",
    ]


@pytest.mark.usefixtures("lag")
def test_a_run_within_its_limits_is_as_without_them() -> None:
    free = command.finished("--json", "-", "--set", "wire.plant.u.noise=0.1")
    held = command.finished("--json", "-", "--set", "wire.plant.u.noise=0.1", "--timeout=60", "--memory=500")
    inside = command.finished("--json", "-", "--set", "wire.plant.u.noise=0.1", "--in-process")
    assert (free.returncode, held.returncode, inside.returncode) == (0, 0, 0)
    results = [json.loads(done.stdout) for done in (free, held, inside)]
    for result in results:
        result.pop("wall_s")
    assert results[0] == results[1] == results[2]


@pytest.mark.parametrize(
    ("megabytes", "line"),
    [
        (
            "300",
            f"MB of memory are more than `--memory` = `300` MB, used by the FMU `probe` {AT}",
        ),
        ("1", "MB of memory, which a run needs before its start, exceed its limit of `1` MB"),
    ],
)
@pytest.mark.usefixtures("lag")
def test_too_much_memory_is_one_line(megabytes: str, line: str) -> None:
    done = command.finished("--set", "controller.eat_at=3", "--memory", megabytes)
    assert done.returncode == 2
    assert line in done.stderr.splitlines()[0]


@pytest.mark.usefixtures("lag")
def test_a_trace_that_is_too_large_for_the_limit_is_rejected_immediately() -> None:
    done = command.finished("--duration", "5000", "--memory", "300")
    assert done.returncode == 2
    assert done.stderr.startswith("error: a run of `loop.duration` = `5000` s does not fit into memory")


@pytest.mark.parametrize("option", ["--timeout", "--memory"])
@pytest.mark.usefixtures("lag")
def test_a_limit_must_be_positive_and_needs_a_process(option: str) -> None:
    for words in ([option, "0"], [option, "nan"], [option, "5", "--in-process"]):
        done = command.finished(*words)
        assert done.returncode == 2
        assert f"`{option}`" in done.stderr


@pytest.mark.usefixtures("lag")
def test_what_the_fmu_logs_and_prints_reaches_stderr() -> None:
    done = command.finished("--set", "controller.fail_at=3", "-v")
    assert "debug: Probe [logStatusError] failed on request at 0.003 s" in done.stderr
    printed = command.finished("--set", "controller.crash_at=3")
    assert "about to write to nowhere" in printed.stderr


def test_a_large_trace_returns_whole(lag: Path) -> None:
    changes = ["loop.step=0.001", "loop.duration=30", "wire.plant.u.noise=0.1"]
    scenario = cosim.load(lag, changes)
    here, there = cosim.run(scenario), cosim.run(scenario, isolated=True)
    assert here.trace is not None
    assert there.trace is not None
    assert there.trace.dtype == here.trace.dtype
    assert np.array_equal(here.trace, there.trace)


def test_an_isolated_run_from_python(lag: Path) -> None:
    with pytest.raises(WorkerError, match=re.escape(f"the FMU `probe` crashed {AT}")):
        cosim.run(cosim.load(lag, ["controller.exit_at=3"]), isolated=True)
    hanging = cosim.load(lag, ["controller.hang_at=3"])
    with pytest.raises(WorkerError, match=re.escape("no result within `timeout` = `0.5` s")):
        cosim.run(hanging, isolated=True, limits=Limits(0.5, keys=("timeout", "memory")))
    reported: list[tuple[int, int]] = []
    scenario = cosim.load(lag, ["loop.duration=20"])
    result = cosim.run(scenario, progress=lambda *steps: reported.append(steps), isolated=True)
    assert result.metrics == cosim.run(scenario).metrics
    assert reported
    assert all(0 <= done <= steps == 20_000 for done, steps in reported)


def test_a_closed_session_rejects_to_run(lag: Path) -> None:
    session = cosim.Session(cosim.load(lag))
    session.run()
    session.close()
    session.close()
    with pytest.raises(CosimError, match="is closed"):
        session.run()


def test_limits_of_a_run_in_this_process_are_rejected(lag: Path) -> None:
    with pytest.raises(CosimError, match="`limits` apply only to isolated runs\nhint: Set `isolated=True`"):
        cosim.run(lag, limits=Limits(timeout=1.0))
