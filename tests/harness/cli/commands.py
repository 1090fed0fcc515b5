"""The command line as a process."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = "import sys; from cosim.cli import main; sys.argv[0] = 'cosim'; main()"
"""What the installed script `cosim` does."""


def cosim(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the command line in the working directory."""
    variables = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    # tables have the width that they have in a file
    variables.pop("COLUMNS", None)
    command = [sys.executable, "-c", PROGRAM, *arguments]
    return subprocess.run(command, capture_output=True, text=True, env=variables, check=False, timeout=120)
