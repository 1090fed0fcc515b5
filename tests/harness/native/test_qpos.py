"""`loop.record_qpos`: MuJoCo's coordinates in the trace, from which a run can be shown again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import cosim
from cosim.errors import CosimError
from cosim.loop import plant as plants

Cart = Callable[..., Path]

LOOSE = """
<mujoco>
  <option timestep="0.0005" integrator="implicitfast"/>
  <worldbody>
    <body><freejoint name="part"/><geom size="0.1" mass="1"/></body>
    <body><joint type="hinge"/><geom size="0.1" pos="0.3 0 0" mass="1"/></body>
    <body><joint name="wrist" type="ball"/><geom size="0.1" pos="0.3 0 0" mass="1"/></body>
  </worldbody>
</mujoco>
"""


def test_the_coordinates_of_a_row_give_its_sensors_again(cart: Cart) -> None:
    scenario = cosim.load(cart(), ["loop.record_qpos=true"])
    runs = [cosim.run(scenario, engine=engine) for engine in ("reference", "native")]
    trace, native = (run.trace for run in runs)
    assert trace is not None
    assert native is not None
    assert trace.tobytes() == native.tobytes()
    assert runs[0].units["plant.qpos.slide"] == "m"
    assert np.ptp(trace["plant.qpos.slide"]) > 0.0
    model = mujoco.MjModel.from_xml_path("cart.xml")
    data = mujoco.MjData(model)
    for row in trace[[0, 31, -1]]:
        data.qpos[:] = [row[f"plant.qpos.{model.joint(i).name}"] for i in range(model.njnt)]
        mujoco.mj_forward(model, data)
        assert data.sensor("position").data[0] == row["plant.position"]


def test_what_is_not_asked_for_changes_nothing(cart: Cart) -> None:
    changes: tuple[list[str], ...] = ([], ["loop.record_qpos=true"])
    plain, more = (cosim.run(cosim.load(cart(), change)).trace for change in changes)
    assert plain is not None
    assert more is not None
    names = list(plain.dtype.names or ())
    assert [name for name in more.dtype.names or () if name not in names] == ["plant.qpos.slide"]
    assert all(plain[name].tobytes() == more[name].tobytes() for name in names)


def test_joints_of_several_numbers_and_without_a_name(folder: Path) -> None:
    (folder / "loose.xml").write_text(LOOSE)
    plant: Any = plants.build("loose.xml", {}, folder)
    before = [truth.name for truth in plant.truths]
    plants.record_qpos(plant, "loose.xml")
    plants.record_qpos(plant, "loose.xml")
    added = {truth.name: truth.unit for truth in plant.truths if truth.name not in before}
    free = {f"qpos.part[{i}]": "m" if i < 3 else "1" for i in range(7)}
    assert added == {**free, "qpos[7]": "rad", **{f"qpos.wrist[{i}]": "1" for i in range(4)}}
    plant.reset(0, 0.01)
    plant.sense()
    values = dict(zip((truth.name for truth in plant.truths), plant.truth(), strict=True))
    assert [values[name] for name in added] == plant.data.qpos.tolist()


def test_a_plant_without_mujoco_has_none(write: Callable[..., Path]) -> None:
    scenario = cosim.load(write("", "lag.toml"), ["loop.record_qpos=true"])
    with pytest.raises(CosimError, match="the plant `probe_plants:Lag` has no `qpos`"):
        cosim.run(scenario)
