"""The Python of the documents runs as it stands there."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from .conftest import ROOT


@pytest.mark.parametrize("document", ["README.md", "docs/import.md"])
def test_the_python_of_a_document_runs(document: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / document).read_text(encoding="utf-8"), re.DOTALL)
    exec(compile(code, document, "exec"), {})


def test_the_commands_of_the_guide_to_importing_run() -> None:
    text = (ROOT / "docs/import.md").read_text(encoding="utf-8")
    commands = re.findall(r"^```\n(fmpy .*)\n```$", text, re.MULTILINE)
    assert commands
    for command in commands:
        run = subprocess.run(
            [sys.executable, "-m", *command.split()], cwd=ROOT, capture_output=True, text=True, check=False
        )
        assert (run.returncode, run.stderr) == (0, ""), command
