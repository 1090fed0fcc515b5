"""Where the system cannot supervise processes all is done in one; what cannot be kept is said."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.cli import main
from cosim.pool import limits
from cosim.pool.job import Job
from cosim.pool.limits import Limits
from cosim.pool.supervisor import Worker

from ..conftest import grid

Write = Callable[..., Path]


@pytest.fixture(autouse=True)
def windows(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the system be one that has no supervised processes, with the lag scenario."""
    write()

    class System:
        """The module `os` as another system has it."""

        name = "nt"

        def __getattr__(self, name: str) -> object:
            return getattr(os, name)

    monkeypatch.setattr(limits, "os", System())


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> object:
    """Exit code of a command line."""
    monkeypatch.setattr(sys, "argv", ["cosim", *arguments])
    with pytest.raises(SystemExit) as exited:
        main()
    return exited.value.code


def test_a_run_is_done_in_the_process_of_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "run", "lag.toml") == 0
    assert "simulated in" in capsys.readouterr().out
    assert call(monkeypatch, "show", "lag.toml") == 0


@pytest.mark.parametrize("option", ["--timeout", "--memory"])
def test_an_option_that_cannot_be_kept_is_rejected(
    option: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "run", "lag.toml", option, "100") == 2
    assert capsys.readouterr().err.splitlines() == [
        f"error: `{option}` cannot be enforced: this system has no supervised worker processes",
        f"hint: Omit `{option}`; the command then runs in its own process.",
    ]


def test_a_sweep_is_done_in_one_process_and_says_so(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "study.toml").write_text(grid(pole=[0.1, 0.2]))
    assert call(monkeypatch, "sweep", "study.toml", "--no-plots") == 0
    seen = capsys.readouterr()
    assert "2 of 2 runs" in seen.out
    reported = "warning: this system has no supervised worker processes: the runs use this process; "
    assert f"{reported}`limits.timeout` cannot be enforced" in seen.err


def test_isolation_that_is_asked_for_is_rejected() -> None:
    scenario = cosim.load("lag.toml")
    with pytest.raises(cosim.CosimError, match="cannot be isolated on this system"):
        cosim.run(scenario, isolated=True)
    # as a Dask worker on such a system does it
    with pytest.raises(cosim.CosimError, match="cannot be isolated on this system"):
        Worker(Limits()).call(Job(scenario, 1))
