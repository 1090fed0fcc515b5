"""`cargo xtask new` in a copy of the repository: what it makes is built, tested and run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# kept between runs, so that unchanged files are compiled once
COPY = ROOT / "target/newcomer/repository"
BUILD = ROOT / "target/newcomer/build"
# what the crates of others are compiled to for the tests of this project is good for those of the copy
SHARED = ROOT / "target"
# what Python and mypy know of modules that are the same goes with them
NOT_COPIED = shutil.ignore_patterns("target", ".git", ".venv", ".ruff_cache", ".pytest_cache")
NAME = "trial"
# what is proven does not depend on how fast it runs, and a sixth of the time went into that
QUICKLY_BUILT = {
    "CARGO_PROFILE_DEV_OPT_LEVEL": "0",
    "CARGO_PROFILE_RELEASE_OPT_LEVEL": "0",
    "CARGO_PROFILE_RELEASE_LTO": "off",
}


def xtask() -> Path:
    """Build the command of the project, as `cargo xtask` does."""
    command = ["cargo", "build", "--package", "xtask", "--locked", "--message-format=json"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    messages = (json.loads(line) for line in done.stdout.splitlines())
    return Path(next(m["executable"] for m in messages if m.get("executable")))


def copy_repository() -> None:
    """Copy all sources with their times, and the environment as a link."""
    shutil.rmtree(COPY, ignore_errors=True)
    shutil.copytree(ROOT, COPY, ignore=NOT_COPIED)
    (COPY / ".venv").symlink_to(sys.prefix, target_is_directory=True)


def run(program: str | Path, line: str, build: Path = BUILD) -> str:
    """Run a program with these words in the copy, which it must pass; what it printed."""
    environment = {
        "CARGO_NET_OFFLINE": "true",
        **os.environ,
        **QUICKLY_BUILT,
        "CARGO_TARGET_DIR": str(build),
        "COSIM_CACHE": str(BUILD / "extracted"),
        "PYTHONPATH": str(COPY),
    }
    command = [str(program), *line.split()]
    done = subprocess.run(command, cwd=COPY, env=environment, capture_output=True, text=True, check=False)
    text = done.stdout + done.stderr
    assert done.returncode == 0, f"`{' '.join(command)}` ended with {done.returncode}:\n{text}"
    return text


# consecutive with the other test that builds from the start, and both among the first
@pytest.mark.xdist_group("builds")
def test_a_new_controller_is_built_tested_and_run() -> None:
    program, python, crate = xtask(), sys.executable, f"fmu-{NAME}"
    copy_repository()
    told = run(program, f"new {NAME}")
    for command in (f"cargo xtask fmu {NAME}", f"cosim run {NAME}", f"cargo test -p {crate}"):
        assert command in told

    run(program, f"fmu {NAME}")
    assert (COPY / f"target/fmu/{crate}.fmu").is_file()
    run(python, f"-m cosim run {NAME}")

    run("cargo", f"test --package {crate} --locked", SHARED)
    run("cargo", f"fmt --package {crate} --check")
    line = f"clippy --package {crate} --no-deps --all-targets --locked -- -D warnings"
    run("cargo", line, SHARED)
    suite = f"tests/acceptance/test_{NAME}.py"
    made = f"plants/__init__.py plants/{NAME}.py plants/{NAME}_parameters.py {suite}"
    for tool in ("ruff check", "ruff format --check", "mypy"):
        run(python, f"-m {tool} {made}")
    suites = f"{suite} tests/acceptance/test_scenarios.py tests/house/test_house.py"
    run(python, f"-m pytest -q -p no:cacheprovider -k {NAME} {suites}")
    assert not (ROOT / crate).exists()
