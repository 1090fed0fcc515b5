"""The Python of the pages runs unchanged; where its program is missing, its names are compared."""

from __future__ import annotations

import csv
import re
import subprocess
import sys
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import pytest
from fmpy import read_model_description

from cosim.ssp.package import write

from .conftest import ROOT


def python(document: str) -> dict[str, Any]:
    """Run the Python of a page; return its variables."""
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / document).read_text(encoding="utf-8"), re.DOTALL)
    variables: dict[str, Any] = {}
    exec(compile(code, document, "exec"), variables)
    return variables


def test_the_python_of_the_readme_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert python("README.md")["result"].metrics["depth"].value < 1e-6


def test_the_example_with_fmpy_detects_the_contact(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    variables = python("docs/import.md")
    items = {
        name: {item.name: int(item.value) for item in variable.declaredType.items}
        for variable in variables["description"].modelVariables
        if (name := variable.name) in ("state", "fault")
    }
    assert (variables["state"], variables["fault"]) == (items["state"]["Done"], items["fault"]["None"])
    assert variables["contact"] == pytest.approx(1e-4, abs=1e-6)


PAGES = ["docs/import.md", "docs/tutorials/import-one-fmu.md"]


def commands() -> list[str]:
    """Command lines of FMPy on the pages about import, each once."""
    texts = [(ROOT / page).read_text("utf-8") for page in PAGES]
    return list(dict.fromkeys(line for text in texts for line in re.findall(r"^fmpy .*", text, re.MULTILINE)))


@pytest.mark.parametrize("command", commands())
def test_a_command_of_fmpy_runs_without_a_warning(command: str, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    words = [*command.split(), *(["--output-file", str(out)] if "simulate" in command else [])]
    line = [sys.executable, "-m", *words]
    run = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, ""), command
    assert "WARNING" not in run.stdout
    if "simulate" in command:
        assert out.read_text("utf-8").count("\n") > 100


@pytest.mark.parametrize("fmu", sorted(ROOT.glob("target/fmu/*.fmu")), ids=lambda fmu: fmu.stem)
def test_every_fmu_runs_with_the_default_experiment(fmu: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    line = [sys.executable, "-m", "fmpy", "simulate", str(fmu), "--output-file", str(out)]
    run = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    assert "WARNING" not in run.stdout
    with out.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {row["fault"] for row in rows} == {"1"}, "no fault"
    assert len(rows) > 100


def runs_with_a_stand_in(section: str, module: str, monkeypatch: pytest.MonkeyPatch) -> MagicMock:
    """Run the Python of a section of the guide with an object in the place of a module; return the object."""
    text = (ROOT / "docs/import.md").read_text(encoding="utf-8").partition(f"\n## {section}\n")[2]
    code = text.partition("\n## ")[0].partition("```py\n")[2].partition("```")[0]
    assert code.startswith(f"from {module} import ")
    stand_in = MagicMock()
    monkeypatch.setitem(sys.modules, module, stand_in)
    monkeypatch.chdir(ROOT)
    exec(compile(code, section, "exec"), {})
    return stand_in


def test_omsimulator_gets_names_of_the_package_and_its_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = runs_with_a_stand_in("OMSimulator", "OMSimulator", monkeypatch)
    scenario = write("dob", [], None, tmp_path / "dob.ssp")
    module.SSP.assert_called_once_with("dob.ssp")
    model = module.SSP().instantiate()
    description = read_model_description(str(ROOT / f"target/fmu/{scenario.controller.fmu}.fmu"))
    variables = {variable.name: variable for variable in description.modelVariables}
    named = [call.args for call in module.CRef.call_args_list]
    assert [path[:2] for path in named] == [(scenario.name, "controller")] * 2
    written, read = (variables[path[2]] for path in named)
    assert (written.type, written.causality, read.causality) == ("String", "parameter", "output")
    model.setFixedStepSize.assert_called_once_with(scenario.loop.step)
    model.setStopTime.assert_called_once_with(scenario.loop.duration)
    calls = [name for name, _, _ in model.method_calls]
    assert (
        calls.index("setValue")
        < calls.index("initialize")
        < calls.index("simulate")
        < calls.index("getValue")
    )


def test_pyfmi_gets_names_of_the_fmu_and_its_step(monkeypatch: pytest.MonkeyPatch) -> None:
    module = runs_with_a_stand_in("PyFMI", "pyfmi", monkeypatch)
    (file,), options = module.load_fmu.call_args
    assert options == {"kind": "CS"}
    model = module.load_fmu()
    description = read_model_description(file)
    variables = {variable.name: variable for variable in description.modelVariables}
    (name, value), _ = model.set.call_args
    assert variables[name].causality == "parameter"
    assert float(variables[name].min) <= value <= float(variables[name].max)
    count = model.simulate_options().__setitem__.call_args.args
    time = model.simulate.call_args.kwargs["final_time"]
    assert count == ("ncp", round(time / float(description.defaultExperiment.stepSize)))
    (read,) = model.simulate().__getitem__.call_args.args
    assert variables[read].causality == "output"
