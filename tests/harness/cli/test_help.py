"""Help of the commands in a terminal of 80 columns."""

from __future__ import annotations

import inspect

import pytest
import typer

from cosim.cli.app import app

from .commands import called

COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", [name for name, command in COMMANDS.items() if not command.hidden])
def test_every_example_has_its_own_line(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERMINAL_WIDTH", "80")
    help_text = called(name, "--help").stdout
    assert "\b" not in help_text
    assert max(map(len, help_text.splitlines())) <= 80
    shown = [line.strip() for line in help_text.splitlines()]
    text = inspect.cleandoc(COMMANDS[name].callback.__doc__ or "").replace("\b", "")
    examples = [line.strip() for line in text.splitlines() if line.startswith("    ")]
    assert [line for line in examples if line not in shown] == []
