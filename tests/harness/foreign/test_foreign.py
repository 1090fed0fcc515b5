"""FMUs that others or other tools made give in cosim what `fmpy.simulate_fmu` gives.

FMPy and both engines call an FMU in the same order, so the outputs are equal to the last bit. The step is a
power of 2, as FMPy computes its length as a difference of two times.
"""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

from ..conftest import entry
from . import models

STEP, COUNT = 2.0**-6, 64
ENGINES = ("reference", "native")
SAMPLE = "ramp"
"""The Python model that runs in the normal tests."""
GEMSEO = "gemseo_fmu/problems/fmu_files/linux"
REGISTRY = [
    *(("gemseo-fmu==3.1.1", f"{GEMSEO}/{name}.fmu", True) for name in (
        "MassSpringSubSystem1", "MassSpringSubSystem2", "MassSpringSystem", "Mass_Damper", "add", "ramp")),
    *(("crane-fmu==0.2.0", f"examples/{name}.fmu", False) for name in (
        "DrivingForce", "HarmonicOscillator6D", "MobileCrane", "MobileCraneStraight")),
]  # fmt: skip
"""Package, FMU, and whether it accepts any inputs."""


@dataclass(frozen=True)
class Outcome:
    """Runs of an FMU by one program, or the text of its error."""

    error: str
    runs: list[Any]


def case(fmu: Path, folder: Path, drive: bool = True) -> dict[str, Any]:
    """Choose inputs that change in every step, or none, and write a scenario with the same signals."""
    description = fmpy.read_model_description(str(fmu), validate=False)
    numeric = [variable for variable in description.modelVariables if variable.type != "String"]
    driven = [
        v for v in numeric if v.causality == "input" or (v.variability == "tunable" and v.type == "Real")
    ]
    inputs = {variable.name: values(variable, index) for index, variable in enumerate(driven)}
    moving = [v for v in numeric if v.causality == "local" and v.variability not in ("constant", "fixed")]
    recorded = [v for v in numeric if v.causality == "output"] + (moving if len(moving) <= 256 else [])
    times = [k * STEP for k in range(COUNT)]
    signals = [
        entry("signal", to=f"controller.{name}", times=times, values=found) for name, found in inputs.items()
    ]
    loop = f"[loop]\nstep = {STEP}\nduration = {COUNT * STEP}\n[controller]\nfmu = {json.dumps(str(fmu))}\n"
    scenario = folder / f"{fmu.stem}.toml"
    scenario.write_text("\n".join([f'title = "{fmu.stem}"', loop, *signals]))
    return {
        "name": fmu.stem, "fmu": str(fmu), "scenario": str(scenario), "step": STEP, "count": COUNT,
        "inputs": inputs, "kinds": {v.name: v.type for v in driven},
        "outputs": [v.name for v in recorded],
    }  # fmt: skip


def values(variable: Any, index: int) -> list[Any]:
    """Values of an input in every step."""
    steps = range(COUNT)
    match variable.type:
        case "Real":
            return [0.5 + 0.25 * float(np.sin(0.3 * k + index + 1)) for k in steps]
        case "Boolean":
            return [(k + index) // 7 % 2 == 1 for k in steps]
        case "Enumeration":
            items = [int(item.value) for item in variable.declaredType.items]
            return [items[k // 5 % len(items)] for k in steps]
    return [(k + index) // 3 % 4 for k in steps]


def outcomes(cases: list[dict[str, Any]], folder: Path) -> dict[str, dict[str, Outcome]]:
    """Outcomes by FMU and program; each program runs all cases in one process."""
    found: dict[str, dict[str, Outcome]] = {one["name"]: {} for one in cases}
    for by in ("fmpy", *ENGINES):
        task = {"by": by, "cases": [one | {"out": str(folder / f"{one['name']}.{by}.npz")} for one in cases]}
        command = [sys.executable, str(models.HERE / "runs.py")]
        done = subprocess.run(command, input=json.dumps(task), capture_output=True, text=True, cwd=folder)
        for one in cases:
            file = folder / f"{one['name']}.{by}.npz"
            assert file.exists(), f"{by} ended with {done.returncode}:\n{done.stdout}{done.stderr}"
            with np.load(file) as table:
                found[one["name"]][by] = Outcome(
                    str(table["error"]), [table[n] for n in table if n != "error"]
                )
    return found


def check(found: dict[str, Outcome]) -> None:
    """Check that the first run of both engines is that of FMPy, and the second one the same.

    An FMU that fails in FMPy, such as one that lacks a Python package, fails in both engines.
    """
    errors = {by: outcome.error for by, outcome in found.items() if outcome.error}
    if "fmpy" in errors:
        assert [errors.get(engine, "").partition(":")[0] for engine in ENGINES] == ["FmuError"] * 2, errors
        return
    assert not errors
    (expected,) = found["fmpy"].runs
    assert expected.size
    for engine in ENGINES:
        first, second = found[engine].runs
        assert np.array_equal(first, expected, equal_nan=True), f"{engine} differs from FMPy"
        assert first.tobytes() == expected.tobytes()
        assert second.tobytes() == first.tobytes(), f"the second run of {engine} differs from the first"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Outcome]]:
    """Outcomes of the C models and of one Python model."""
    folder = tmp_path_factory.mktemp("foreign")
    fmus = [*(models.c_fmu(name, folder) for name in models.C_MODELS), models.python_fmu(SAMPLE, folder)]
    return {
        name.lower(): found for name, found in outcomes([case(fmu, folder) for fmu in fmus], folder).items()
    }


@pytest.mark.parametrize("name", [*models.C_MODELS, SAMPLE])
def test_a_model_built_here_gives_what_fmpy_gives(built: dict[str, dict[str, Outcome]], name: str) -> None:
    check(built[name])


@pytest.mark.foreign
@pytest.mark.parametrize("name", models.PYTHON_MODELS)
def test_a_python_fmu_gives_what_fmpy_gives(tmp_path: Path, name: str) -> None:
    check_alone(models.python_fmu(name, tmp_path), tmp_path)


@pytest.fixture(scope="session")
def fetched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the packages of the registry."""
    return tmp_path_factory.mktemp("registry")


@pytest.mark.foreign
@pytest.mark.parametrize(
    ("package", "member", "drive"), REGISTRY, ids=[Path(member).stem for _, member, _ in REGISTRY]
)
def test_an_fmu_of_the_registry_gives_what_fmpy_gives(
    tmp_path: Path, fetched: Path, package: str, member: str, drive: bool
) -> None:
    fmu = models.registry_fmu(package, member, fetched)
    if fmu is None:
        pytest.skip(f"`{package}` cannot be fetched")
    check_alone(fmu, tmp_path, drive)


def check_alone(fmu: Path, folder: Path, drive: bool = True) -> None:
    """Check an FMU in processes of its own."""
    (found,) = outcomes([case(fmu, folder, drive)], folder).values()
    check(found)
