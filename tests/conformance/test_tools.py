"""FMUs in the checkers and masters of others."""

from __future__ import annotations

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest

from .conftest import PROBE, Fmu, need


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.client("fmutool", "checks it")
def test_fmutool_finds_it_compliant(fmu: Fmu) -> None:
    program = need("fmutool", shutil.which("fmutool", path=Path(sys.executable).parent))
    result = run(program, "-input", str(fmu.file), "-check")
    reported = result.stdout + result.stderr
    assert result.returncode == 0, reported
    assert "This FMU seems to be compliant with FMI-2.0." in reported
    assert "No semantic error against the FMI-2 standard." in reported


@pytest.mark.client("libcosim", "runs it alone")
@pytest.mark.skipif(sys.platform != "linux", reason="libcosimpy has no wheel for this platform")
def test_libcosim_runs_it(fmu: Fmu) -> None:
    need("libcosimpy", "libcosimpy" if importlib.util.find_spec("libcosimpy") else None)
    result = run(sys.executable, str(Path(__file__).with_name("cosim_execution.py")), str(fmu.file))
    assert result.returncode == 0, result.stderr
    seen = json.loads(result.stdout)
    assert (seen["stepped"], seen["time"]) == (True, 10**9)
    # libcosim leaves out enumerations
    assert seen["variables"] == [v.name for v in fmu.variables() if v.type != "Enumeration"]
    starts = {v.name: float(v.start) for v in fmu.variables("parameter", "Real")}
    assert {name: seen["reals"][name] for name in starts} == starts
    if fmu.description.modelName.lower() == PROBE:
        assert (seen["reals"]["force"], seen["reals"]["sum"]) == (1.5, pytest.approx(1500.0))


@pytest.mark.client("fmucontainer", "packs it into an FMU that FMPy simulates")
def test_a_container_of_it_is_an_fmu(fmu: Fmu, tmp_path: Path) -> None:
    program = need("fmucontainer", shutil.which("fmucontainer", path=Path(sys.executable).parent))
    shutil.copy(fmu.file, tmp_path / "inside.fmu")
    step, wanted = float(fmu.description.defaultExperiment.stepSize), fmu.variables("output", "Real")[0]
    lines = [
        "rule;from_fmu;from_port;to_fmu;to_port",
        "FMU;inside.fmu;;;",
        f"OUTPUT;inside.fmu;{wanted.name};;y",
    ]
    (tmp_path / "around.csv").write_text("\n".join(lines) + "\n")
    result = run(program, "-fmu-directory", str(tmp_path), "-container", f"around.csv:{step!r}", "-fmi", "2")
    assert result.returncode == 0, result.stdout + result.stderr
    seen = fmpy.simulate_fmu(str(tmp_path / "around.fmu"), stop_time=100 * step, output_interval=step)
    alone = fmpy.simulate_fmu(
        str(fmu.file),
        fmi_type="CoSimulation",
        stop_time=100 * step,
        output_interval=step,
        output=[wanted.name],
    )
    assert seen["y"].tolist() == alone[wanted.name].tolist()
