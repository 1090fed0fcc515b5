"""A worker process that is started before anybody says what it may take."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest

import cosim
from cosim.errors import CosimError
from cosim.pool import single_task, supervisor
from cosim.pool.job import Job, WorkerError
from cosim.pool.limits import Limits

from ..conftest import DATA

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the system confines a process on Linux")


def ahead() -> int:
    """Process that was started ahead."""
    (worker,) = single_task.ahead
    assert worker.handle is not None
    return worker.handle.process.pid


def job(*changes: str) -> Job:
    """Run of the lag with changes."""
    return Job(cosim.load("lag.toml", set=changes), 1)


def test_the_first_place_takes_it_and_holds_it_to_its_limits(write: Write, folder: Path) -> None:
    write()
    shutil.copy(DATA / "counting.py", folder / "counting.py")
    counting = job('plant.name="counting:Counting"')
    with single_task.started_ahead():
        started = ahead()
        # where these stay, what takes too much ends after all
        single_task.ahead[0].limits = Limits(timeout=20.0)
        with single_task.executor(Limits(memory=500e6)) as do:
            assert isinstance(do(counting), cosim.Result)
            eaten = do(job("controller.eat_at=3"))
        assert isinstance(eaten, WorkerError)
        assert eaten.status == "memory"
        assert "`500` MB" in eaten.message
        with single_task.executor(Limits()) as do:
            assert isinstance(do(counting), cosim.Result)
    first, second = (folder / "processes").read_text().split()
    assert int(first) == started != int(second)


def test_what_hinders_it_is_reported_by_its_location(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise CosimError("no process")

    monkeypatch.setattr(supervisor, "spawn", refused)
    with single_task.started_ahead():
        assert not single_task.ahead
        with pytest.raises(CosimError, match="no process"), single_task.executor(Limits()):
            pass


def test_it_ends_where_no_place_takes_it() -> None:
    with single_task.started_ahead():
        started = ahead()
        with single_task.executor(None):
            assert psutil.pid_exists(started)
    assert not psutil.pid_exists(started)
    assert not single_task.ahead
