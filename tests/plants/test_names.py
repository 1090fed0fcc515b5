"""A wrong name in a new plant gives an error with the most similar name."""

from dataclasses import make_dataclass
from pathlib import Path
from typing import Any, ClassVar

import pytest

import machining_native as _native
import plants
from plants.base.names import UnknownNameError
from plants.base.plant import Plant

MJCF = """
<mujoco><option timestep="1e-3" integrator="implicitfast"/>
  <worldbody><body name="rotor"><joint name="x" type="slide"/><geom size="0.1" mass="2"/></body></worldbody>
</mujoco>
"""


class Bearing(Plant):
    """A plant that calls something in `shape` or in `begin`."""

    Parameters: ClassVar[type] = make_dataclass("NoParameters", ())
    wires = ("current", "force")
    readings = commands = truths = ()
    folder: ClassVar[Path]

    @classmethod
    def _mjcf(cls) -> Path:
        return cls.folder / "bearing.xml"

    def shape(self, spec: Any, p: Any) -> None:
        self.shaped(spec)

    def begin(self, steps: int) -> None:
        self.begun()
        self.connect({}, {}, {})

    def shaped(self, spec: Any) -> None:
        pass

    def begun(self) -> None:
        pass


@pytest.fixture
def bearing(tmp_path: Path) -> type[Bearing]:
    (tmp_path / "bearing.xml").write_text(MJCF)
    return type("MyBearing", (Bearing,), {"folder": tmp_path})


def test_a_wire_by_a_wrong_name(bearing: type[Bearing], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bearing, "begun", lambda plant: plant.wire("curent"))
    expected = r"^there is no wire in `MyBearing.wires` named `curent`\nhint: Use `current`.$"
    with pytest.raises(UnknownNameError, match=expected):
        bearing().reset(1, 0.1)


@pytest.mark.parametrize(
    ("thing", "name", "hint"),
    [
        ("body", "rotr", r"Use `rotor`."),
        ("joint", "spindle", r"Known names: `x`."),
        ("actuator", "drive", ""),
    ],
)
def test_an_element_of_the_mjcf_by_a_wrong_name(
    bearing: type[Bearing], monkeypatch: pytest.MonkeyPatch, thing: str, name: str, hint: str
) -> None:
    monkeypatch.setattr(bearing, "shaped", lambda plant, spec: getattr(spec, thing)(name))
    expected = rf"^there is no {thing} in `bearing.xml` named `{name}`" + (
        rf"\nhint: {hint}$" if hint else "$"
    )
    with pytest.raises(UnknownNameError, match=expected):
        bearing()


def test_what_is_there_is_changed_as_before(bearing: type[Bearing], monkeypatch: pytest.MonkeyPatch) -> None:
    def shaped(_plant: Bearing, spec: Any) -> None:
        spec.body("rotor").add_geom(size=[0.1, 0, 0], mass=3.0)
        spec.option.timestep = 2e-3
        spec.modelname = "turned"

    monkeypatch.setattr(bearing, "shaped", shaped)
    plant = bearing()
    assert (plant.timestep, plant.model.body("rotor").mass[0]) == (2e-3, 5.0)
    assert plant.model.names.startswith(b"turned\0")


def test_a_native_element_that_is_not_there(bearing: type[Bearing], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bearing, "begun", lambda plant: getattr(_native, "curent_loop")(1.0))  # noqa: B009
    expected = (
        r"^there is no native element `curent_loop`\nhint: Use `current_loop`. "
        r"Build a new one with `cargo xtask setup`.$"
    )
    with pytest.raises(UnknownNameError, match=expected):
        bearing().reset(1, 0.1)


def test_another_attribute_that_is_missing_stays_what_it_is(
    bearing: type[Bearing], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bearing, "begun", lambda plant: plant.nothing)
    with pytest.raises(AttributeError, match="'MyBearing' object has no attribute 'nothing'"):
        bearing().reset(1, 0.1)


def test_a_wrong_class_in_the_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(plants.PLANTS, "slide", "Slid")
    expected = r"^there is no class for `PLANTS` in `plants/slide.py` named `Slid`\nhint: Use `Slide`.$"
    with pytest.raises(UnknownNameError, match=expected):
        plants.load("slide")
