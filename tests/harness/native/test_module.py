"""The native module against its stub: the same names, with the same parameters and defaults."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
MADE = ("machining_native.__all__", "machining_native.machining_native")
"""Names that the build adds to the module; the stub does not declare them."""


def test_the_stub_shows_the_module_as_it_is(tmp_path: Path) -> None:
    allowed = tmp_path / "allowed.txt"
    allowed.write_text("\n".join(MADE))
    stubtest = [sys.executable, "-m", "mypy.stubtest", "machining_native", "--concise"]
    command = [*stubtest, "--allowlist", str(allowed)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
