"""Draft of a scenario: opens FMU and plant, matches ports, chooses the steps."""

from __future__ import annotations

import os
from pathlib import Path

import fmpy

from cosim import paths
from cosim.errors import FmuError
from cosim.fmu.archive import FmuFile, open_fmu
from cosim.loop import plant
from cosim.loop.place import Place, Stage
from cosim.new.ends import channels, variables
from cosim.new.match import match
from cosim.new.write import Draft

DEFAULT_STEP, LONGEST = 0.01, 1.0
"""Default communication step, and duration of the first run, s."""


def draft(fmu: str, plant_name: str, folder: Path, place: Place) -> Draft:
    """Draft of a scenario in a folder; `place` records whose code runs.

    Raises
    ------
    CosimError
        The FMU or the plant cannot be opened.
    """
    if fmu.endswith(plant.MJCF):
        hint = f"Give the FMU first: `cosim new {plant_name or 'FMU'} {fmu}`."
        raise FmuError(f"`{paths.brief(fmu)}` is not an FMU", hint)
    file = open_fmu(paths.find_fmu(fmu, Path.cwd()))
    place.begin(file.name, plant_name, 0, 0.0)
    place.at(Stage.BUILD_PLANT)
    required: dict[str, tuple[str, str]] = {}
    driven = None
    try:
        if plant_name:
            # the plants of MJCF files with RK4 have a value for `integrator`
            required = getattr(plant.plant_class(plant_name, Path.cwd()), "required", {})
            values = {name: value for name, (value, _) in required.items()}
            driven = plant.build(plant_name, values, Path.cwd())
    except SystemExit as error:
        raise plant.exited(plant_name, error) from error
    sensed, commanded = (
        channels(driven.readings if driven else ()),
        channels(driven.commands if driven else ()),
    )
    inputs, outputs = variables(file, "input"), variables(file, "output")
    step, substeps = steps(wanted_step(file), driven.timestep if driven else 0.0)
    if driven is not None:
        place.at(Stage.CLOSE_PLANT)
        plant.close(driven, plant_name)
    place.at(Stage.NONE)
    return Draft(
        title=f"{file.name} and {Path(plant_name).stem}" if plant_name else f"{file.name} alone",
        fmu=relative_name(fmu, file.path, folder),
        plant=relative_name(plant_name, paths.expanded(plant_name), folder),
        parameters=required,
        step=step,
        substeps=substeps,
        steps=max(1, round(LONGEST / step)),
        readings=match([one.end for one in sensed], [one.end for one in inputs]),
        commands=match([one.end for one in outputs], [one.end for one in commanded]),
        inputs=inputs,
        outputs=outputs,
        sensed=sensed,
        commanded=commanded,
    )


def wanted_step(file: FmuFile) -> float:
    """Step that the description of an FMU proposes."""
    experiment = fmpy.read_model_description(str(file.path), validate=False).defaultExperiment
    step = float(experiment.stepSize or 0.0) if experiment is not None else 0.0
    return step if step > 0.0 else DEFAULT_STEP


def steps(wanted: float, timestep: float) -> tuple[float, int]:
    """Communication step nearest to the requested one, and the number of plant steps in it."""
    if timestep <= 0.0:
        return wanted, 1
    substeps = max(1, round(wanted / timestep))
    return float(f"{substeps * timestep:.12g}"), substeps


def relative_name(name: str, file: Path, folder: Path) -> str:
    """Name in the scenario: a path is relative to its folder."""
    if name.endswith((".fmu", *plant.MJCF)) or os.sep in name:
        return Path(os.path.relpath(file.resolve(), folder.resolve())).as_posix()
    return name
