"""The parts that all plants share, on a plant as small as can be."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from machining_native import Cell, Circuit, current_loop, integrator, latch, peak, summing_junction
from plants.base.parameters import ParameterError, parameter
from plants.base.plant import Channel, Plant, PlantError

MJCF = """
<mujoco><option timestep="1e-3" gravity="0 0 0" integrator="{integrator}"><flag autoreset="disable"/></option>
  <worldbody><body><joint name="x" type="slide"/><geom size="0.1" mass="2"/></body></worldbody>
  <actuator><motor name="push" joint="x"/></actuator>
  <sensor><jointpos name="x" joint="x"/></sensor>
</mujoco>
"""


@dataclass(frozen=True)
class NoParameters:
    pass


class Ball(Plant):
    Parameters: ClassVar[type] = NoParameters
    readings = (Channel("x", "m", "Position"),)
    commands = (Channel("push", "N", "Force"),)
    truths = (Channel("v", "m/s", "Velocity"),)
    folder: ClassVar[Path]

    @classmethod
    def _mjcf(cls) -> Path:
        return cls.folder / "ball.xml"

    def shape(self, spec: Any, p: Any) -> None:
        pass

    def begin(self, steps: int) -> None:
        data = self.data
        self.connect({"x": Cell(data.sensordata)}, {"push": Cell(data.ctrl)}, {"v": Cell(data.qvel)})


def ball(folder: Path, integrator: str = "implicitfast") -> Ball:
    (folder / "ball.xml").write_text(MJCF.format(integrator=integrator))
    Ball.folder = folder
    plant = Ball()
    plant.reset(0, 1.0)
    return plant


def test_a_plant_without_elements_runs(tmp_path: Path) -> None:
    plant = ball(tmp_path)
    for _ in range(100):
        plant.sense()
        plant.command(np.array([3.0]))
        plant.advance(1)
    plant.sense()
    assert plant.truth()[0] == pytest.approx(3.0 / 2.0 * 0.1, rel=1e-12)


def test_rk4_is_rejected(tmp_path: Path) -> None:
    with pytest.raises(PlantError, match=r"`RK4`(?s:.)*hint: Use `implicitfast`"):
        ball(tmp_path, "RK4")


def test_a_plant_that_blows_up_is_an_error_with_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its log where it runs
    plant = ball(tmp_path)
    plant.sense()
    plant.command(np.array([1e300]))
    plant.advance(1)
    with pytest.raises(PlantError, match=r"at t = `0.001` s: MuJoCo warns: `mjWARN_BAD"):
        plant.sense()


def test_a_reading_that_is_not_finite_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    plant = ball(tmp_path)
    plant.reading_cells = (Cell(np.array([np.inf])),)
    with pytest.raises(PlantError, match=r"reading `x` is `inf` m"):
        plant.sense()


def test_channels_are_connected_by_name(tmp_path: Path) -> None:
    plant = ball(tmp_path)
    with pytest.raises(ValueError, match=r"channels `\['x'\]` are connected as `\['y'\]`"):
        plant.connect({"y": Cell(plant.data.sensordata)}, {}, {})


def test_a_default_outside_its_range_is_rejected_in_its_file() -> None:
    with pytest.raises(ParameterError, match=r"the default of `Mass`: value `-1` kg, limit `0` to `inf` kg"):
        parameter(-1.0, "kg", "Mass", 0.0, source="catalogue")


def test_importing_the_package_does_not_import_mujoco() -> None:
    code = "import sys, plants; assert plants.names(); sys.exit('mujoco' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


# cells and circuits


def test_a_cell_scales_offsets_and_keeps_its_array_alive() -> None:
    cell = Cell(np.array([1.0, 2.0, 3.0]), 1, scale=10.0, offset=0.5)
    assert cell.read() == 20.5
    cell.write(4.0)
    assert cell.read() == 10.0 * 40.5 + 0.5


def test_places_that_are_added_to_start_every_step_at_zero() -> None:
    force, one, two = np.array([99.0]), np.array([1.0]), np.array([2.0])
    circuit = Circuit()
    for source in (one, two):
        circuit.bind(
            "s", summing_junction(1), [Cell(source)], [Cell(force, scale=-1.0, offset=0.25, add=True)]
        )
    for _ in range(3):
        circuit.step(1e-3)
        assert force[0] == -2.5


def test_signals_advance_with_the_step_and_end() -> None:
    samples, out = np.arange(6.0), np.zeros(1)
    circuit = Circuit()
    circuit.bind("play", summing_junction(1), [Cell(samples, 1, stride=2)], [Cell(out)])
    for wanted in (1.0, 3.0, 5.0):
        circuit.step(1e-3)
        assert out[0] == wanted
    with pytest.raises(IndexError, match="element `play`: input `a` ends after `3` plant steps"):
        circuit.step(1e-3)
    circuit.reset()
    circuit.step(1e-3)
    assert out[0] == 1.0


def test_reset_brings_every_element_back_to_time_zero() -> None:
    value, integral, most = np.array([3.0]), np.zeros(1), np.zeros(1)
    circuit = Circuit()
    circuit.bind("sum", integrator(2.0), [Cell(value)], [Cell(integral)])
    circuit.bind("top", peak(), [Cell(value)], [Cell(most)])
    for _ in range(2):
        circuit.step(1e-3)
    circuit.reset()
    value[0] = -1.0
    circuit.step(1e-3)
    assert (integral[0], most[0]) == (2.0, -1.0)


def test_a_circuit_names_the_input_that_is_not_finite() -> None:
    value = np.array([np.nan])
    circuit = Circuit()
    circuit.bind("top", peak(), [Cell(value)], [Cell(np.zeros(1))])
    with pytest.raises(FloatingPointError, match="element `top`: input `value` is `NaN`"):
        circuit.step(1e-3)


def test_wrong_bindings_are_rejected() -> None:
    circuit, array = Circuit(), np.zeros(2)
    with pytest.raises(ValueError, match=r"element `loop`: `1` cells for the ports .*command.*noise"):
        circuit.bind("loop", current_loop(1.0), [Cell(array)], [Cell(array)])
    with pytest.raises(ValueError, match="cannot write to a signal"):
        circuit.bind("seen", latch(), [Cell(array)], [Cell(array, stride=1)])
    fixed = np.zeros(1)
    fixed.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        Cell(fixed).write(1.0)
    with pytest.raises(IndexError, match="cell index `2`, limit `2`"):
        Cell(array, 2)
    with pytest.raises(ValueError, match="contiguous"):
        Cell(np.zeros((4, 4))[:, 0])
    with pytest.raises(BufferError):
        Cell(np.zeros(2, dtype=np.float32))
    with pytest.raises(ValueError, match="limit `8`"):
        summing_junction(9)
    element = peak()
    circuit.bind("top", element, [Cell(array)], [Cell(array)])
    with pytest.raises(ValueError, match="element `again` is bound already"):
        circuit.bind("again", element, [Cell(array)], [Cell(array)])
