"""The wheel: one `pip install` brings harness, plants, FMUs, scenarios and studies."""

from __future__ import annotations

import base64
import csv
import hashlib
import os
import shutil
import struct
import subprocess
import sys
import venv
import zipfile
from functools import cache
from pathlib import Path

import pytest

import cosim

ROOT = Path(__file__).resolve().parents[2]
PLATFORMS = ROOT / "target/platforms"
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


def holds_all_files(wheel: Path) -> None:
    """Check that a wheel has FMUs, scenarios and studies, and lists each file with its hash."""
    with zipfile.ZipFile(wheel) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    for controller in (file.parent.name for file in ROOT.glob("fmu-*/Cargo.toml")):
        assert f"cosim/packed/fmu/{controller}.fmu" in contents
    for folder in ("scenarios", "studies"):
        for file in (ROOT / folder).glob("**/*.toml"):
            assert f"cosim/packed/{file.relative_to(ROOT).as_posix()}" in contents
    (record,) = (name for name in contents if name.endswith(".dist-info/RECORD"))
    rows = {row[0]: row[1] for row in csv.reader(contents[record].decode().splitlines())}
    assert rows.keys() == contents.keys()
    for name, data in contents.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")
        assert rows[name] == ("" if name == record else f"sha256={digest}"), name


@pytest.mark.full
def test_the_wheel_runs_in_a_fresh_environment(tmp_path: Path) -> None:
    subprocess.run(["cargo", "xtask", "wheel"], cwd=ROOT, check=True)
    (wheel,) = (ROOT / "target" / "wheel").glob("*.whl")
    holds_all_files(wheel)

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


@cache
def wheel_for(platform: str) -> Path:
    """Build a wheel for a platform; the first one takes minutes, because it builds the release set."""
    subprocess.run(["cargo", "xtask", "wheel", "--platform", platform], cwd=ROOT, check=True)
    (wheel,) = (ROOT / "target" / "wheel-set" / platform).glob("*.whl")
    return wheel


def processor(module: bytes) -> tuple[str, int]:
    """Return the format of a library, and the number of its processor in this format."""
    if module.startswith(b"\x7fELF"):
        return "ELF", struct.unpack_from("<H", module, 18)[0]
    assert module.startswith(b"MZ")
    header = struct.unpack_from("<I", module, 60)[0]
    assert module[header : header + 4] == b"PE\0\0"
    return "PE", struct.unpack_from("<H", module, header + 4)[0]


@pytest.mark.full
@pytest.mark.parametrize(
    ("platform", "tag", "ending", "expected"),
    [
        ("win64", "win_amd64", ".pyd", ("PE", 0x8664)),
        ("aarch64-linux", "manylinux_2_17_aarch64", ".so", ("ELF", 183)),
    ],
)
def test_a_wheel_for_a_platform_holds_its_module_and_its_fmus(
    platform: str, tag: str, ending: str, expected: tuple[str, int]
) -> None:
    wheel = wheel_for(platform)
    holds_all_files(wheel)
    assert "-cp311-abi3-" in wheel.name
    assert tag in wheel.name
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        (facts,) = (name for name in names if name.endswith(".dist-info/WHEEL"))
        assert f"Tag: cp311-abi3-{tag}" in archive.read(facts).decode()
        (module,) = (name for name in names if name.endswith((".pyd", ".so")))
        assert module.startswith("machining_native")
        assert module.endswith(ending)
        assert processor(archive.read(module)) == expected
        for name in (name for name in names if name.endswith(".fmu")):
            with archive.open(name) as file, zipfile.ZipFile(file) as fmu:
                assert any(path.startswith(f"binaries/{platform}/") for path in fmu.namelist()), name


@pytest.mark.full
def test_the_module_for_windows_needs_only_python_and_windows(tmp_path: Path) -> None:
    # compiled only: no Python for Windows runs on this machine
    dump = PLATFORMS / "mingw/usr/bin/x86_64-w64-mingw32-objdump"
    with zipfile.ZipFile(wheel_for("win64")) as archive:
        (module,) = (name for name in archive.namelist() if name.endswith(".pyd"))
        file = archive.extract(module, tmp_path)
    libraries = {"LD_LIBRARY_PATH": str(PLATFORMS / "mingw/usr/lib/x86_64-linux-gnu")}
    shown = run([dump, "-p", file], tmp_path, **libraries).stdout
    assert "PyInit_machining_native" in shown
    needed = {line.split()[-1].lower() for line in shown.splitlines() if "DLL Name:" in line}
    assert "python3.dll" in needed
    # the standard library of Rust and MinGW need these, which every Windows has
    system = {"python3.dll", "bcryptprimitives.dll", "kernel32.dll", "msvcrt.dll", "ntdll.dll", "userenv.dll"}
    assert not {name for name in needed - system if not name.startswith("api-ms-win-")}


@pytest.mark.full
def test_the_module_for_arm_linux_is_imported_under_qemu(tmp_path: Path) -> None:
    emulator, system = PLATFORMS / "qemu/usr/bin/qemu-aarch64", PLATFORMS / "aarch64"
    python = system / "usr/bin/python3"
    if not (emulator.exists() and python.exists()):
        pytest.skip("`cargo xtask test --platforms` fetches QEMU and the Python of ARM Linux")
    with zipfile.ZipFile(wheel_for("aarch64-linux")) as archive:
        archive.extractall(tmp_path)
    code = "import machining_native as m, platform; m.Circuit().reset(); print(platform.machine(), *vars(m))"
    libraries = str(PLATFORMS / "qemu/usr/lib/x86_64-linux-gnu")
    options: list[str | Path] = ["-U", "LD_LIBRARY_PATH", "-L", system, python.resolve(), "-c", code]
    done = run([emulator, *options], tmp_path, LD_LIBRARY_PATH=libraries, PYTHONPATH=str(tmp_path))
    assert done.stdout.startswith("aarch64 "), done.stderr
    assert {"Circuit", "Stepper", "low_pass"} <= set(done.stdout.split())
