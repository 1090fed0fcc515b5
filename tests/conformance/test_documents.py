"""The Python of the documents runs as it stands there; without its program, its names are right."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from unittest.mock import MagicMock

import pytest
from fmpy import read_model_description

from cosim.ssp.package import write

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


def test_omsimulator_is_told_names_of_the_package_and_its_step(
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
    told, asked = (variables[path[2]] for path in named)
    assert (told.type, told.causality, asked.causality) == ("String", "parameter", "output")
    model.setFixedStepSize.assert_called_once_with(scenario.loop.step)
    model.setStopTime.assert_called_once_with(scenario.loop.duration)
    calls = [name for name, _, _ in model.method_calls]
    assert (
        calls.index("setValue")
        < calls.index("initialize")
        < calls.index("simulate")
        < calls.index("getValue")
    )


def test_pyfmi_is_told_names_of_the_fmu_and_its_step(monkeypatch: pytest.MonkeyPatch) -> None:
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
