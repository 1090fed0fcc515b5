"""MJCF files with one mistake each."""

from __future__ import annotations

import functools

from ..conftest import END, SCENARIO

MODEL = """
<mujoco>
  <option timestep="0.001"/>
  <worldbody>
    <body name="cart">
      <joint name="slide" type="slide" axis="1 0 0" damping="1"/>
      <geom name="box" size="0.1" mass="1"/>
    </body>
  </worldbody>
  <actuator><motor name="drive" joint="slide"/></actuator>
  <sensor><jointpos name="position" joint="slide"/></sensor>
</mujoco>
"""
CHANGES = {
    "probe_plants:Lag": "model.xml",
    "plant.x": "plant.position",
    "plant.u": "plant.drive",
    ', "plant.extra"': "",
    'fmu = "probe"': 'fmu = "probe"\nparameters = {bias = [1.0, 0.0]}',
}
WIRED = functools.reduce(lambda text, change: text.replace(*change), CHANGES.items(), SCENARIO)
WIRED += END.replace("plant.x", "plant.slide.position")
"""Scenario of the cart."""
NAME = "`model.xml`"


def edited(old: str, new: str) -> str:
    """Model with one text replaced, which must be there."""
    assert old in MODEL, old
    return MODEL.replace(old, new, 1)


FILES: dict[str, tuple[str, tuple[str, ...]]] = {
    "no XML": ("hello", ("MuJoCo cannot load", NAME, "XML")),
    "empty": ("", ("MuJoCo cannot load", "empty file")),
    "other root": ("<a/>", ("MuJoCo cannot load", "Unrecognized XML model type", "'a'")),
    "cut off": (MODEL[:200], ("MuJoCo cannot load", NAME)),
    "unknown element": (edited("<worldbody>", "<worldbody><bdy/>"), ("MuJoCo cannot load", "'bdy'")),
    "unknown attribute": (edited('mass="1"', 'mss="1"'), ("MuJoCo cannot load", "'mss'")),
    "number is a text": (edited('mass="1"', 'mass="heavy"'), ("MuJoCo cannot load", "mass")),
    "repeated name": (
        edited("</body>", '</body><body name="cart"><geom size="0.1"/></body>'),
        ("MuJoCo cannot load", "repeated name 'cart'"),
    ),
    "no such joint": (
        edited('<motor name="drive" joint="slide"', '<motor name="drive" joint="no"'),
        ("'no'",),
    ),
    "no such sensor place": (
        edited('name="position" joint="slide"', 'name="position" joint="no"'),
        ("'no'",),
    ),
    "includes a system file": (
        edited("<worldbody>", '<include file="/etc/passwd"/><worldbody>'),
        ("Include error",),
    ),
    "includes itself": (
        edited("<worldbody>", '<include file="model.xml"/><worldbody>'),
        ("already included",),
    ),
    "includes nothing": (edited("<worldbody>", '<include file="no.xml"/><worldbody>'), ("no.xml",)),
    "mesh is a system file": (
        edited("<worldbody>", '<asset><mesh name="m" file="/etc/passwd"/></asset><worldbody>'),
        ("MuJoCo cannot load", "/etc/passwd"),
    ),
    "mesh is missing": (
        edited("<worldbody>", '<asset><mesh name="m" file="../../x.stl"/></asset><worldbody>'),
        ("MuJoCo cannot load", "x.stl"),
    ),
    "plugin": (
        edited("<worldbody>", '<extension><plugin plugin="evil.so"/></extension><worldbody>'),
        ("MuJoCo cannot load", "evil.so"),
    ),
    "mass nan": (edited('mass="1"', 'mass="nan"'), ("MuJoCo cannot load", "`model.xml`", "NaN")),
    "gravity nan": (
        edited('timestep="0.001"', 'timestep="0.001" gravity="0 0 nan"'),
        ("MuJoCo cannot load", "NaN"),
    ),
    "time step nan": (edited('timestep="0.001"', 'timestep="nan"'), ("model.xml",)),
    "time step tiny": (edited('timestep="0.001"', 'timestep="1e-300"'), ("plant steps of 1e-300 s",)),
    "time step negative": (
        edited('timestep="0.001"', 'timestep="-1"'),
        ("`model.xml`", "`timestep` is `-1.0`"),
    ),
    "time step of another loop": (edited('"0.001"', '"0.0007"'), ("`loop.substeps`", "0.0007 s")),
    "memory of a galaxy": (
        edited("<worldbody>", '<size memory="900P"/><worldbody>'),
        ("MuJoCo cannot load",),
    ),
    "very deep": (edited("<body", "<body>" * 600 + "<body"), ("MuJoCo cannot load",)),
    "no joint": (edited('<joint name="slide" type="slide" axis="1 0 0" damping="1"/>', ""), ("'slide'",)),
    "no command": (
        edited('<actuator><motor name="drive" joint="slide"/></actuator>', ""),
        ("no command `drive`",),
    ),
    "no reading": (
        edited('<sensor><jointpos name="position" joint="slide"/></sensor>', ""),
        ("no measurement `position`",),
    ),
    "nameless actuator": (edited('<motor name="drive"', "<motor"), ("no command `drive`",)),
    "no mass": (edited('size="0.1" mass="1"', 'size="0.1" mass="0"'), ("MuJoCo cannot load", "mass")),
    "explodes": (
        edited('joint="slide"/></actuator>', 'joint="slide" gear="1e300"/></actuator>'),
        ("model.xml",),
    ),
    "other integrator": (edited('timestep="0.001"', 'timestep="0.001" integrator="RK4"'), ("`RK4`",)),
}
"""Content of `model.xml`, and what the message must say."""
