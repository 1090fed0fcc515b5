"""A package file: structure, parameter sets and FMUs of a scenario."""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import fmpy

from cosim import extras, paths
from cosim.check import lint
from cosim.errors import CosimError, concerning
from cosim.loop import fmus, time_series
from cosim.loop.plant import MJCF
from cosim.loop.position import Position
from cosim.loop.session import Session, located
from cosim.loop.wires.connect import PLANT
from cosim.scenario.load import load
from cosim.scenario.model import Scenario
from cosim.ssp import structure
from cosim.ssp.ports import ports_of, rejected
from cosim.writing import whole

STRUCTURE = "SystemStructure.ssd"
SCRIPT = "surroundings_of_loop"
"""Module of the FMU of the surroundings."""
MOST = 2**31 - 1
"""Maximum of an FMI Integer, the type of the seed."""


def write(
    loop: str, changes: Sequence[str], seed: int | None, file: Path, position: Position | None = None
) -> Scenario:
    """Write a scenario as an SSP package, and return it; a seed of None is the scenario's.

    `position` records whose code runs.
    """
    scenario = load(loop, changes)
    with located(scenario):
        if not scenario.plant.name:
            raise CosimError("a scenario without a plant has no connections", "Add a plant to the scenario.")
        number = scenario.loop.seed if seed is None else seed
        if not 0 <= number <= MOST:
            problem = f"the seed {number} cannot be a parameter of an SSP"
            raise rejected("loop.seed", problem, f"Use 0 to {MOST}.")
    # errors of a run are raised here, not in the master
    with Session(scenario, position=position) as session:
        lint.check(session)
    with located(scenario):
        files = fmus.open_files(scenario)
        for name, one in files.items():
            if one.version != 2:
                with concerning(f"{name}.fmu"):
                    raise CosimError(f"`{one.path.name}` is an FMI 3.0 FMU", "Use FMI 2.0 in an SSP system.")
        ports = ports_of(scenario, files)
        settings = {
            "loop": known(scenario),
            "set": [*changes, *whole_paths(scenario)],
            "seed": number,
            "driven": [port.to_json() for port in ports.driven],
            "commanding": [port.to_json() for port in ports.commanding],
        }
    with tempfile.TemporaryDirectory() as folder:
        surroundings = build(settings, Path(folder))
        described = fmpy.read_model_description(str(surroundings))
        descriptions = {name: fmpy.read_model_description(str(one.path)) for name, one in files.items()}
        members: dict[str, str | Path] = {
            STRUCTURE: structure.system(scenario, ports, descriptions, described.modelVariables),
            f"resources/{PLANT}.fmu": surroundings,
            f"resources/{PLANT}.ssv": structure.values([("seed", "Integer", settings["seed"])]),
        }
        for choice in scenario.fmus:
            own = files[choice.name]
            members[f"resources/{choice.name}.fmu"] = own.path
            members[f"resources/{choice.name}.ssv"] = structure.parameter_set(choice, own, ports)
        with whole(file) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
            for path, content in members.items():
                if isinstance(content, Path):
                    archive.write(content, path, zipfile.ZIP_STORED)
                else:
                    archive.writestr(path, content)
    return scenario


def known(scenario: Scenario) -> str:
    """File of a scenario: relative to the folder of the project's scenarios, otherwise the whole path."""
    file, own = paths.resolved(scenario.file), paths.resolved(paths.OWN_SCENARIOS)
    return file.relative_to(own).as_posix() if file.is_relative_to(own) else str(scenario.file.absolute())


def whole_paths(scenario: Scenario) -> list[str]:
    """Return overrides with absolute paths of files in the working directory."""
    names = {f"signal.{signal.to}.file": signal.file for signal in scenario.signal if signal.file}
    files = {f"signal.{to}.file": file for to, file in time_series.files(scenario).items()}
    if scenario.plant.name.endswith(MJCF):
        names["plant.name"] = scenario.plant.name
        files["plant.name"] = paths.find_mjcf(scenario.plant.name, scenario.folder)
    return [
        f"{key}={json.dumps(str(files[key].absolute()), ensure_ascii=False)}"
        for key, name in names.items()
        if files[key] != scenario.folder / paths.expanded(name)
    ]


def build(settings: dict[str, Any], folder: Path) -> Path:
    """Build the FMU of the surroundings with PythonFMU."""
    problem = "an SSP package needs PythonFMU, which is not installed"
    builder = extras.needed("pythonfmu.builder", problem, extras.hint("ssp"))
    script, stated = folder / f"{SCRIPT}.py", folder / "loop.json"
    script.write_text("from cosim.ssp.surroundings import Surroundings\n", encoding="utf-8")
    stated.write_text(json.dumps(settings), encoding="utf-8")
    try:
        made: Path = builder.FmuBuilder.build_FMU(script, dest=folder, project_files=[stated])
    finally:
        # what the builder has left in this process
        sys.modules.pop(SCRIPT, None)
        sys.path[:] = [path for path in sys.path if Path(path) != folder]
        shutil.rmtree(folder / "__pycache__", ignore_errors=True)
    return made
