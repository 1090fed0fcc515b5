"""The command line as a process, and in this one, where it is fast."""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

from cosim.cli import main

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = "import sys; from cosim.cli import main; sys.argv[0] = 'cosim'; main()"
"""Python code that does the same as the installed script `cosim`."""
ISOLATED = ("run", "show", "check", "new", "video", "view")
"""Commands that open an FMU or a plant in a separate process, unless `--in-process` is given."""


def cosim(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the command line in the working directory."""
    variables = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    # tables have the width that they have in a file
    variables.pop("COLUMNS", None)
    command = [sys.executable, "-c", PROGRAM, *arguments]
    return subprocess.run(command, capture_output=True, text=True, env=variables, check=False, timeout=120)


def called(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the command line in this process: for what it says and writes, not for what it is as a process."""
    inside = (
        ["--in-process"] if set(arguments[:2]) & set(ISOLATED) and "--in-process" not in arguments else []
    )
    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["cosim", *arguments, *inside])
        patch.delenv("COLUMNS", raising=False)
        for name, text in environment.items():
            patch.setenv(name, text)
        with (
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            pytest.raises(SystemExit) as ended,
        ):
            main()
    return subprocess.CompletedProcess(arguments, int(ended.value.code or 0), out.getvalue(), err.getvalue())
