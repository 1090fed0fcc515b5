"""The command line `cosim`: data on stdout, progress and messages on stderr, exit codes for scripts."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from pathlib import Path
from typing import NoReturn

from cosim import interrupts

ISOLATED = [["run"], ["show"], ["check"]]
"""Commands of which a worker process does the most."""
OTHERWISE = ("--in-process", "--seeds", "--help", "-h")
"""How options begin with which they do without it, or have several."""


def main() -> NoReturn:
    """Run the command line and exit; Ctrl-C ends it at any moment, the imports included."""
    # a stream that the caller has closed takes everything and shows nothing
    sys.stdout = sys.stdout or Path(os.devnull).open("w")  # noqa: SIM115
    sys.stderr = sys.stderr or Path(os.devnull).open("w")  # noqa: SIM115
    with contextlib.ExitStack() as stack:
        stack.enter_context(interrupts.handled_by(interrupts.quit_at_once))
        if isolated(sys.argv[1:]):
            from cosim.pool import once

            stack.enter_context(once.started_ahead())
        from cosim.cli.app import app, status_of

        replace_what_cannot_be_written()
        if len(sys.argv) == 1:
            sys.argv.append("--help")
        status = status_of(app)
    sys.exit(status)


def isolated(words: list[str]) -> bool:
    """Whether a command will want a worker process, as far as its words tell before they are parsed."""
    return words[:1] in ISOLATED and not any(word.startswith(OTHERWISE) for word in words)


def replace_what_cannot_be_written() -> None:
    """Let stdout show `?` for characters that it has not, instead of ending the run; JSON is ASCII anyway."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
