"""The command line `cosim`: data on stdout, progress and messages on stderr, exit codes for scripts."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import sys
from pathlib import Path
from typing import NoReturn

from cosim import interrupts

ISOLATED = ("run", "show", "check")
"""Commands that do most of their work in a worker process."""
OTHERWISE = ("--in-process", "--seeds", "--help", "-h")
"""Prefixes of options that need no worker process, or several."""


def main() -> NoReturn:
    """Run the command line and exit; Ctrl-C and SIGTERM end it at any time, also during imports."""
    # replace a stream that the caller closed by one that discards everything
    sys.stdout = sys.stdout or Path(os.devnull).open("w")  # noqa: SIM115
    sys.stderr = sys.stderr or Path(os.devnull).open("w")  # noqa: SIM115
    with contextlib.ExitStack() as stack:
        stack.enter_context(interrupts.handled_by(interrupts.quit_at_once, signal.SIG_DFL))
        if isolated(sys.argv[1:]):
            from cosim.pool import single_task

            stack.enter_context(single_task.started_ahead())
        from cosim.cli.app import app, status_of

        replace_unsupported_characters()
        if len(sys.argv) == 1:
            sys.argv.append("--help")
        status = status_of(app)
    sys.exit(status)


def isolated(arguments: list[str]) -> bool:
    """Whether a command needs a worker process, estimated from its unparsed arguments."""
    command = next((entry for entry in arguments if not entry.startswith("-")), "")
    return command in ISOLATED and not any(entry.startswith(OTHERWISE) for entry in arguments)


def replace_unsupported_characters() -> None:
    """Make stdout print `?` for unsupported characters instead of failing; JSON is ASCII in any case."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
