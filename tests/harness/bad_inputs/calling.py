"""The command line called in this process, and the checks of every rejection."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import NamedTuple

import pytest

from cosim.cli import main

IN_PROCESS: tuple[str, ...] = ("--in-process",)
"""Options that keep a command in this process, where it is fast."""


class Case(NamedTuple):
    """A bad command line, and the names, values and locations that its message must contain."""

    arguments: tuple[str, ...]
    words: tuple[str, ...]


Refuse = Callable[[Case], None]
"""The fixture that checks a rejection."""


def given(*arguments: str) -> tuple[str, ...]:
    """Arguments of a case."""
    return arguments


def call(arguments: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> object:
    """Exit code of a command line."""
    extra = IN_PROCESS if arguments[0] in ("run", "show", "check", "new") else ()
    monkeypatch.setattr(sys, "argv", ["cosim", *arguments, *extra])
    with pytest.raises(SystemExit) as exited:
        main()
    return exited.value.code


def refused(case: Case, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Check that a bad input is one error that names the thing, with exit code 2 and without traceback."""
    code = call(case.arguments, monkeypatch)
    check_refusal(case.words, code, *capsys.readouterr())


def check_refusal(words: tuple[str, ...], code: object, stdout: str, stderr: str) -> None:
    """Check exit code, streams and message of a rejection."""
    assert "Traceback" not in stdout + stderr
    assert code == 2, stdout + stderr
    assert stdout == ""
    errors = [line for line in stderr.splitlines() if line.startswith("error: ")]
    assert len(errors) == 1, stderr
    assert len(errors[0]) < 3000
    assert "\x1b" not in stderr
    for word in words:
        assert word in stderr, stderr
