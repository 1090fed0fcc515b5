"""A cart with a probe, wired with numbers, Booleans and integers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

Write = Callable[..., Path]
CART = """
<mujoco model="cart">
  <option timestep="0.0005" integrator="implicitfast"/>
  <worldbody>
    <body name="cart">
      <joint name="slide" type="slide" axis="1 0 0" damping="2"/>
      <geom size="0.1" mass="1"/>
    </body>
  </worldbody>
  <actuator><motor name="drive" joint="slide"/><motor name="kick" joint="slide"/></actuator>
  <sensor><jointpos name="position" joint="slide"/><jointvel name="speed" joint="slide"/></sensor>
</mujoco>
"""
SCENARIO = """
title = "Cart with a probe"
[loop]
step = 0.001
substeps = 2
duration = 0.06
[controller]
fmu = "probe"
[controller.parameters]
gain = -40.0
bias = [0.5, 0.25]
[plant]
name = "cart.xml"
[[wire]]
from = "plant.position"
to = "controller.in"
[[wire]]
from = "plant.speed"
to = "controller.flag"
[[wire]]
from = "plant.speed"
to = "controller.count"
scale = 1e3
[[wire]]
from = "controller.out"
to = "plant.drive"
[[signal]]
to = "controller.mode"
times = [0.0, 0.02]
values = ["Slow", "Fast"]
"""


@pytest.fixture
def cart(folder: Path, write: Write) -> Callable[..., Path]:
    """Write a scenario of a cart, wired with numbers, Booleans and integers, and what is added."""
    (folder / "cart.xml").write_text(CART)

    def write_cart(added: str = "") -> Path:
        return write(added, "cart.toml", SCENARIO)

    return write_cart
