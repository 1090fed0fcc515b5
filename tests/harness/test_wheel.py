"""The wheel: one `pip install` brings harness, plants, FMUs, scenarios and studies."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

import cosim

ROOT = Path(__file__).resolve().parents[2]
STUDY = """
scenario = "dob"
[design]
kind = "grid"
repeats = 2
[set]
"loop.duration" = 0.5
[[vary]]
key = "plant.stiffness"
values = [1e5, 1e6]
"""


def run(command: list[str | Path], folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a command as a user without this checkout does."""
    kept = {name: text for name, text in os.environ.items() if not name.startswith(("COSIM_", "PYTHON"))}
    environment = {**kept, "COSIM_CACHE": str(folder / "cache"), **variables}
    return subprocess.run(
        [str(part) for part in command],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_what_is_packed_into_the_package_is_found(tmp_path: Path) -> None:
    package = tmp_path / "site" / "cosim"
    shutil.copytree(Path(cosim.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "packed" / "scenarios").mkdir(parents=True)
    (package / "packed" / "fmu").mkdir()
    (package / "packed" / "scenarios" / "packed-one.toml").write_text('title = "From the wheel"\n')
    (package / "packed" / "studies").mkdir()
    (package / "packed" / "studies" / "one.toml").write_text('scenario = "packed-one"\n')
    found = "paths.fmu_folders()[-1], *dict(paths.list_scenarios()), paths.find_study('studies/one.toml')"
    done = run(
        [sys.executable, "-c", f"from cosim import paths; print({found})"],
        tmp_path,
        PYTHONPATH=str(package.parent),
    )
    packed = package / "packed"
    assert done.stdout.split() == [str(packed / "fmu"), "packed-one", str(packed / "studies" / "one.toml")], (
        done.stderr
    )


@pytest.mark.full
def test_the_wheel_runs_in_a_fresh_environment(tmp_path: Path) -> None:
    subprocess.run(["cargo", "xtask", "wheel"], cwd=ROOT, check=True)
    (wheel,) = (ROOT / "target" / "wheel").glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    for controller in (file.parent.name for file in ROOT.glob("fmu-*/Cargo.toml")):
        assert f"cosim/packed/fmu/{controller}.fmu" in names
    for folder in ("scenarios", "studies"):
        for file in (ROOT / folder).glob("**/*.toml"):
            assert f"cosim/packed/{file.relative_to(ROOT).as_posix()}" in names

    venv.create(tmp_path / "env", with_pip=True)
    programs = tmp_path / "env" / ("Scripts" if sys.platform == "win32" else "bin")
    installed = run([programs / "python", "-m", "pip", "install", "--quiet", wheel], tmp_path)
    assert installed.returncode == 0, installed.stderr

    listed = run([programs / "cosim", "list"], tmp_path)
    assert "dob/paper" in listed.stdout
    once = run([programs / "cosim", "run", "dob"], tmp_path)
    assert once.returncode == 0, once.stdout + once.stderr
    assert "7 of 7 criteria passed" in once.stdout
    (tmp_path / "study.toml").write_text(STUDY)
    # half a second is over before the contact: the runs are done, but their criteria passed
    sweep = run([programs / "cosim", "sweep", "study.toml"], tmp_path)
    assert sweep.returncode == 1, sweep.stdout + sweep.stderr
    assert "4 of 4 runs" in sweep.stdout
