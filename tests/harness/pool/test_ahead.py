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
from cosim.pool import once, supervisor
from cosim.pool.job import Job, WorkerError
from cosim.pool.limits import Limits

from ..conftest import DATA

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the system confines a process on Linux")


def ahead() -> int:
    """Process that was started ahead."""
    (worker,) = once.ahead
    assert worker.child is not None
    return worker.child.process.pid


def job(*changes: str) -> Job:
    """Run of the lag with changes."""
    return Job(cosim.load("lag.toml", set=changes), 1)


def test_the_first_place_takes_it_and_holds_it_to_its_limits(write: Write, folder: Path) -> None:
    write()
    shutil.copy(DATA / "counting.py", folder / "counting.py")
    counting = job('plant.name="counting:Counting"')
    with once.started_ahead():
        started = ahead()
        # where these stay, what takes too much ends after all
        once.ahead[0].limits = Limits(timeout=20.0)
        with once.place(Limits(memory=500e6)) as do:
            assert isinstance(do(counting), cosim.Result)
            eaten = do(job("controller.eat_at=3"))
        assert isinstance(eaten, WorkerError)
        assert eaten.status == "memory"
        assert "`500` MB" in eaten.message
        with once.place(Limits()) as do:
            assert isinstance(do(counting), cosim.Result)
    first, second = (folder / "processes").read_text().split()
    assert int(first) == started != int(second)


def test_what_hinders_it_is_reported_by_its_location(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise CosimError("no process")

    monkeypatch.setattr(supervisor, "spawn", refused)
    with once.started_ahead():
        assert not once.ahead
        with pytest.raises(CosimError, match="no process"), once.place(Limits()):
            pass


def test_it_ends_where_no_place_takes_it() -> None:
    with once.started_ahead():
        started = ahead()
        with once.place(None):
            assert psutil.pid_exists(started)
    assert not psutil.pid_exists(started)
    assert not once.ahead
