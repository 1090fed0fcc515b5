"""A cart that moves a millimeter next to a wall of a meter."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

CART = """
<mujoco model="cart">
  <option timestep="0.001" integrator="implicitfast"/>
  <worldbody>
    <geom type="box" size="0.02 0.5 0.5" pos="-0.5 0 0" rgba="0 1 0 1"/>
    <camera name="side" pos="0 -3 0" xyaxes="1 0 0 0 0 1"/>
    <body name="cart">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <geom type="box" size="0.1 0.1 0.1" mass="1" rgba="1 0 0 1"/>
    </body>
  </worldbody>
  <actuator><motor name="drive" joint="slide"/></actuator>
  <sensor><jointpos name="position" joint="slide"/></sensor>
</mujoco>
"""
SCENARIO = """
title = "A cart is pushed"
undriven = ["controller.count", "controller.flag"]
[loop]
step = 0.001
duration = 0.2
[controller]
fmu = "probe"
[controller.parameters]
gain = -1.0
bias = [0.1, 0.0]
[plant]
name = "cart.xml"
[[wire]]
from = "plant.position"
to = "controller.in"
[[wire]]
from = "controller.out"
to = "plant.drive"
[[signal]]
to = "controller.mode"
times = [0.0, 0.1]
values = ["Slow", "Fast"]
[[plot.panels]]
columns = ["plant.slide.position"]
unit = "um"
scale = 1e6
"""


@pytest.fixture
def cart(folder: Path) -> Path:
    """Scenario of the cart, with its model."""
    (folder / "cart.xml").write_text(CART)
    file = folder / "cart.toml"
    file.write_text(SCENARIO)
    return file


@pytest.fixture
def _drawing() -> None:
    """Skip where this system has nothing to draw with."""
    from cosim.errors import CosimError
    from cosim.replay import renderer

    try:
        renderer.graphics((32, 32)).free()
    except CosimError as error:
        pytest.skip(str(error))
    importlib.import_module("OpenGL")
