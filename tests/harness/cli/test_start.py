"""The command line imports large modules only when it needs them, so that it starts fast."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import cosim

ROOT = Path(__file__).resolve().parents[3]
HEAVY = {
    "numpy", "fmpy", "lxml", "mujoco", "matplotlib", "scipy", "pandas", "pyarrow", "plants", "attr",
    "av", "PIL", "OpenGL", "glfw", "jinja2", "plotly",
}  # fmt: skip
COMMANDS = {
    "import cosim": {"typer", "rich", "logging", "tomllib"},
    "import cosim.cli": {"rich"},
    "from cosim.cli import main; import sys; sys.argv = ['cosim', '--help']; main()": {
        "rich",
        "pydantic",
        "tomllib",
        "zipfile",
        "xml.etree",
        "cosim.pool.supervisor",
        "cosim.scenario.toml",
    },
    "from cosim.cli import main; import sys; sys.argv = ['cosim', 'list']; main()": {
        "rich.markdown",
        "rich.progress",
        "xml.etree",
        "cosim.pool.supervisor",
    },
}
"""Commands with the modules that they must not import, in addition to the large ones."""


@pytest.mark.parametrize("code", COMMANDS)
def test_nothing_heavy_is_imported_before_it_is_needed(code: str) -> None:
    reported = "import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr))\n"
    variables = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", reported + code]
    done = subprocess.run(command, capture_output=True, text=True, env=variables, check=True, cwd=ROOT)
    imported = set(done.stderr.split())
    assert "cosim" in imported
    assert imported & (HEAVY | COMMANDS[code]) == set()


@pytest.mark.parametrize("name", cosim.__all__)
def test_every_public_name_is_found_when_it_is_asked_for(name: str) -> None:
    assert name in dir(cosim)
    assert getattr(cosim, name).__module__.startswith("cosim.")


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="`cosim` has no attribute `runn`"):
        cosim.runn  # noqa: B018


def test_the_import_of_mujoco_starts_no_python_process_and_keeps_the_environment() -> None:
    program = (
        "import os, sys; started = []\n"
        "sys.addaudithook(lambda event, of: event == 'subprocess.Popen' and started.append(str(of[0])))\n"
        "before = dict(os.environ)\n"
        "from cosim import physics; physics.ready(); import mujoco\n"
        "assert dict(os.environ) == before\n"
        "assert mujoco.Renderer\n"
        "print([name for name in started if 'python' in name])"
    )
    variables = {name: value for name, value in os.environ.items() if not name.startswith("PYGLFW")}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, env=variables, check=True, cwd=ROOT)
    assert done.stdout == "[]\n"
