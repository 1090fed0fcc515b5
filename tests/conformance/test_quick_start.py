"""The quick start of each controller completes its cycle and draws the picture of the page."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from fmpy import read_model_description

from .conftest import ROOT

CRATES = sorted(file.parent.name for file in ROOT.glob("fmu-*/Cargo.toml"))
COMPLETE = ("Done", "Centered")
"""States in which a cycle is complete."""
PICTURE_BYTES = 60_000


def program(crate: str) -> Path:
    return ROOT / crate / "doc/quick_start.py"


def module(crate: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"quick_start_{crate[4:]}", program(crate))
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def states(fmu: Path) -> dict[int, str]:
    """Numbers and names of the items of the output `state`."""
    (state,) = (v for v in read_model_description(str(fmu)).modelVariables if v.name == "state")
    return {int(item.value): item.name for item in state.declaredType.items}


@pytest.mark.parametrize("crate", CRATES)
def test_a_quick_start_completes_its_cycle_in_the_same_way_each_time(crate: str) -> None:
    fmu = ROOT / f"target/fmu/{crate}.fmu"
    run = module(crate).run
    found, again = run(fmu), run(fmu)
    assert states(fmu)[int(found["state"][-1])] in COMPLETE
    assert all(np.array_equal(values, again[name], equal_nan=True) for name, values in found.items())
    assert all(np.isfinite(values).all() for values in found.values())


@pytest.mark.parametrize("crate", CRATES)
def test_a_quick_start_runs_from_any_folder_and_draws(crate: str, tmp_path: Path) -> None:
    fmu, picture = ROOT / f"target/fmu/{crate}.fmu", tmp_path / "run.svg"
    drawing = program(crate).with_name("plot_run.py")
    for line in ([str(program(crate)), str(fmu)], [str(drawing), str(fmu), str(picture)]):
        done = subprocess.run(
            [sys.executable, *line], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, "")
        assert bool(done.stdout.strip()) == (line[0] == str(program(crate)))
    assert 0 < picture.stat().st_size <= PICTURE_BYTES


@pytest.mark.parametrize("crate", CRATES)
def test_a_landing_page_shows_the_picture_and_the_commands_of_its_quick_start(crate: str) -> None:
    page = (ROOT / crate / "README.md").read_text("utf-8")
    assert "](doc/run.svg)" in page
    assert f"cargo xtask fmu {crate[4:]}" in page
    assert f"{crate}/doc/quick_start.py" in page
    assert (ROOT / crate / "doc/run.svg").stat().st_size <= PICTURE_BYTES


@pytest.mark.parametrize("crate", CRATES)
def test_the_page_of_an_fmu_shows_the_quick_start_before_the_ports(crate: str) -> None:
    with zipfile.ZipFile(ROOT / f"target/fmu/{crate}.fmu") as archive:
        for name in ("quick_start.py", "run.svg"):
            assert archive.read(f"documentation/{name}") == (ROOT / crate / "doc" / name).read_bytes()
        page = archive.read("documentation/index.html").decode()
    first = ("Block", "Quick start", "Inputs", "Outputs", "Essential parameters")
    titles = (*first, "Timing and delay", "Faults")
    positions = [page.index(f">{title}</h2>") for title in titles]
    assert positions == sorted(positions)
    assert '<img src="run.svg"' in page
