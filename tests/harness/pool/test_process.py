"""State of the whole process: working directory, number of usable processors, unexpected errors."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.cli import main
from cosim.pool.limits import processors, quota

Write = Callable[..., Path]


def test_sessions_opened_in_several_threads_leave_the_working_directory(
    write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = cosim.load(write())
    change = os.chdir

    def slow(place: str) -> None:
        change(place)
        time.sleep(0.002)

    monkeypatch.setattr(os, "chdir", slow)

    def open_some() -> None:
        for _ in range(5):
            cosim.Session(scenario).close()

    threads = [threading.Thread(target=open_some) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    here = Path.cwd()
    change(folder)
    assert here == folder


@pytest.mark.parametrize("error", [TypeError("what\nnow"), SystemExit(0), RecursionError(), MemoryError()])
def test_an_unexpected_error_is_one_line_and_exit_code_2(
    error: BaseException, write: Write, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object) -> None:
        raise error

    write()
    monkeypatch.setattr("cosim.scenario.load.build", fail)
    for verbose in ((), ("-v",)):
        monkeypatch.setattr(sys, "argv", ["cosim", "show", "lag.toml", "--in-process", *verbose])
        with pytest.raises(SystemExit) as exited:
            main()
        out, err = capsys.readouterr()
        assert (exited.value.code, out) == (2, "")
        assert f"error: unexpected error: {type(error).__name__}: " in err
        assert ("Traceback" in err) == bool(verbose)


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="affinity of Linux")
def test_workers_are_as_many_as_the_process_may_use() -> None:
    before = os.sched_getaffinity(0)
    assert processors() <= len(before)
    try:
        os.sched_setaffinity(0, {min(before)})
        assert processors() == 1
    finally:
        os.sched_setaffinity(0, before)


def test_control_groups_grant_processors(tmp_path: Path) -> None:
    group = tmp_path / "fs" / "user" / "job"
    group.mkdir(parents=True)
    membership = tmp_path / "cgroup"
    membership.write_text("0::/user/job\n")
    assert quota(tmp_path / "fs", membership) == float("inf")
    (group / "cpu.max").write_text("max 100000\n")
    (group.parent / "cpu.max").write_text("150000 100000\n")
    assert quota(tmp_path / "fs", membership) == 1.5
    (tmp_path / "fs" / "cpu.max").write_text("50000 100000\n")
    assert quota(tmp_path / "fs", membership) == 0.5
