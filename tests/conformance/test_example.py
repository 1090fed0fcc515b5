"""A crate outside the workspace becomes an FMU by `cargo fmu` alone."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

from .conftest import ROOT

EXAMPLE = ROOT / "examples/spring"
# kept between runs, so that the dependencies are compiled once
FOLDER = ROOT / "target/examples"
PUBLISHED = ("cargo-fmu", "fmi2-export", "fmi2-export-macros")
INTERVAL = 1e-2
SPRING = """
#include <stdio.h>
#include "spring.h"
int main(void) {
    spring_parameters p;
    spring_inputs in;
    spring_outputs out;
    spring_start_parameters(&p);
    spring_start_inputs(&in);
    p.stiffness = 200.0;
    in.position = 1e-3;
    spring *one = spring_new(&p, NULL, NULL, NULL);
    if (one == NULL || !spring_step(one, &in, &out)) return 1;
    printf("%.17g\\n", out.force);
    spring_free(one);
    return 0;
}
"""


def test_the_readme_shows_the_example() -> None:
    readme = (ROOT / "fmi2-export/README.md").read_text()
    source = (EXAMPLE / "src/lib.rs").read_text()
    # the crate's own first line says what it is
    assert source.partition("\n\n")[2] in readme


def build_cargo_fmu() -> Path:
    """Build the subcommand with the features of `cargo test --workspace`."""
    command = ["cargo", "build", "--workspace", "--bin", "cargo-fmu", "--locked", "--message-format=json"]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, f"`{' '.join(command)}` failed:\n{run.stderr}"
    messages = (json.loads(line) for line in run.stdout.splitlines())
    built = [m for m in messages if m["reason"] == "compiler-artifact" and m["target"]["name"] == "cargo-fmu"]
    return Path(built[0]["executable"])


def strangers_copy(folder: Path = FOLDER / "spring") -> Path:
    """Copy the example to where no workspace is around it, with the versions of this project's lock file."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(EXAMPLE, folder, ignore=shutil.ignore_patterns("target", "Cargo.lock"))
    manifest = folder / "Cargo.toml"
    text = manifest.read_text()
    path = (ROOT / "fmi2-export").as_posix()
    assert "../../fmi2-export" in text
    manifest.write_text(text.replace("../../fmi2-export", path))
    shutil.copy(ROOT / "Cargo.lock", folder)
    return folder


def cargo_fmu(program: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the subcommand as `cargo` does, without the programs of this project's environment."""
    paths = [path for path in os.environ["PATH"].split(os.pathsep) if not Path(path).is_relative_to(ROOT)]
    environment = os.environ | {"PATH": os.pathsep.join(paths), "CARGO_NET_OFFLINE": "true"}
    command = [str(program), "fmu", *words]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def press(file: Path, speed: float, stiffness: float) -> np.ndarray:
    """Simulate half a second in which the spring is pressed with a constant speed."""
    path = [(time, speed * time) for time in np.linspace(0.0, 0.5, 51)]
    position = np.array(path, dtype=[("time", float), ("position", float)])
    start = {"stiffness": stiffness}
    result: np.ndarray = fmpy.simulate_fmu(
        str(file), stop_time=0.5, output_interval=INTERVAL, start_values=start, input=position
    )
    return result


def test_the_crates_for_others_are_packaged_without_a_warning() -> None:
    command = ["cargo", "package", "--offline", "--allow-dirty", "--no-verify"]
    packages = [word for name in PUBLISHED for word in ("--package", name)]
    run = subprocess.run([*command, *packages], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert "warning" not in run.stderr
    for name in PUBLISHED:
        crates = (ROOT / "target/package").glob(f"{name}-[0-9]*.crate")
        with tarfile.open(max(crates, key=lambda crate: crate.stat().st_mtime)) as archive:
            files = {member.name.split("/", 1)[1] for member in archive.getmembers()}
        assert {"README.md", "LICENSE-MIT", "LICENSE-APACHE", "src/lib.rs"} <= files


@pytest.mark.platforms
def test_two_folders_give_equal_bytes(tmp_path: Path) -> None:
    program = build_cargo_fmu()
    found = []
    for place in ("here", "some/where/else"):
        folder = strangers_copy(tmp_path / place / "spring")
        file = folder / "spring.fmu"
        run = cargo_fmu(
            program, folder, "--target-dir", str(tmp_path / place / "build"), "--output", str(file)
        )
        assert run.returncode == 0, run.stderr
        found.append(file.read_bytes())
    assert found[0] == found[1]


@pytest.mark.xdist_group("builds")
def test_a_crate_elsewhere_is_packed_validated_and_simulated() -> None:
    program, folder = build_cargo_fmu(), strangers_copy()
    file = folder / "spring.fmu"
    run = cargo_fmu(program, folder, "--target-dir", str(FOLDER / "build"), "--output", str(file))
    assert run.returncode == 0, run.stderr
    assert run.stdout == f"{file}\n"
    assert "warning" not in run.stderr

    with zipfile.ZipFile(file) as archive:
        names = archive.namelist()
        notices = archive.read("documentation/licenses/third-party.txt").decode()
    assert f"binaries/{fmpy.platform}/spring{fmpy.sharedLibraryExtension}" in names
    # the example has no licence file of its own; the texts are those of its dependencies
    for part in ("- fmi2-export ", "- postcard ", "Permission is hereby granted", "Apache License"):
        assert part in notices

    command = [sys.executable, "-m", "fmpy", "validate", str(file)]
    validated = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "No problems found" in validated.stdout

    result = press(file, speed=2e-3, stiffness=200.0)
    assert result["force"][-1] < -0.19
    np.testing.assert_allclose(result["force"], -0.4 * result["time"], atol=0.4 * 1.1 * INTERVAL)

    seen = cargo_fmu(program, folder, "inspect", str(file))
    assert seen.returncode == 0, seen.stdout + seen.stderr
    assert "3 variables: 1 input, 1 output, 1 parameter" in seen.stdout
    assert not any(str(place) in seen.stdout for place in (ROOT, Path.home()))

    # and a library for C of it
    plain = cargo_fmu(program, folder, "--plain-c", "--target-dir", str(FOLDER / "build"))
    assert plain.returncode == 0, plain.stderr
    library, header = map(Path, plain.stdout.splitlines())
    source = folder / "spring.c"
    source.write_text(SPRING)
    command = ["cc", "-Wall", "-Wextra", "-Werror", f"-I{header.parent}", str(source), str(library), "-lm"]
    subprocess.run([*command, "-o", str(folder / "plain")], check=True)
    pressed = subprocess.run([str(folder / "plain")], capture_output=True, text=True, check=True)
    assert float(pressed.stdout) == pytest.approx(-200.0 * 1e-3)

    # a local variable is an output on request
    model = folder / "src/lib.rs"
    declared = "#[var(unit = NEWTON)]"
    assert declared in model.read_text()
    model.write_text(model.read_text().replace(declared, "#[var(unit = NEWTON, local)]"))
    words = ("--outputs", "all", "--target-dir", str(FOLDER / "all"), "--output", str(file))
    every = cargo_fmu(program, folder, *words)
    assert every.returncode == 0, every.stderr
    assert [v.causality for v in fmpy.read_model_description(file).modelVariables] == [
        "input",
        "output",
        "parameter",
    ]
