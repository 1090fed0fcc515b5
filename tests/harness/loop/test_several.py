"""Several FMUs in one loop, compared with closed forms: order and delay determine the value of a wire."""

from __future__ import annotations

import logging
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError
from cosim.fmu.instance import Instance

from ..conftest import END, SCENARIO, pack
from .several import LOOP, Write, column, fmu, run, signal, whole, wire

ROOT = Path(__file__).resolve().parents[3]
K = np.arange(20)
STEP = signal("a.in", [0.0, 0.01], [1.0, -3.0])


def series(more: str = "") -> str:
    """Write two gains in series; `more` are keys of the wire between."""
    return LOOP + fmu("a", gain=2.0) + fmu("b", gain=-4.0) + wire("a.out", "b.in", more) + STEP


def ring(delay: int) -> str:
    """Write two gains in a ring, `a.out = b.out / 2 + 1` and `b.out = a.out / 2`."""
    fmus = fmu("a", gain=0.5, bias=[1.0, 0.0]) + fmu("b", gain=0.5)
    return LOOP + fmus + wire("a.out", "b.in") + wire("b.out", "a.in", f"delay = {delay}\n")


def test_a_wire_forward_carries_the_value_of_this_step(write: Write) -> None:
    result = run(write(text=series()))
    driven = np.repeat([1.0, -3.0], 10)
    assert column(result, "a.in").tolist() == driven.tolist()
    assert column(result, "b.in").tolist() == (2.0 * driven).tolist()
    assert column(result, "b.out").tolist() == (-8.0 * driven).tolist()


@pytest.mark.parametrize("delay", [1, 3])
def test_a_delayed_wire_forward_begins_with_what_the_initialised_fmu_puts_out(
    write: Write, delay: int
) -> None:
    result = run(write(text=series(f"delay = {delay}\n")), "a.bias=[0.25, 0.0]")
    # initialized with `in` = 1
    expected = [2.25] * delay + column(result, "a.out").tolist()[:-delay]
    assert column(result, "b.in").tolist() == expected


@pytest.mark.parametrize("delay", [1, 2, 5])
def test_a_ring_is_closed_by_a_wire_that_is_steps_late(write: Write, delay: int) -> None:
    # x[k] = x[k - delay] / 4 + 1/2; `a` is initialized with 0, then `b` with the output 1 of `a`
    result = run(write(text=ring(delay)))
    expected = 2.0 / 3.0 * (1.0 - 0.25 ** (K // delay + 2))
    assert column(result, "b.out") == pytest.approx(expected, rel=1e-12)


def test_an_output_reaches_its_own_input_a_step_later(write: Write) -> None:
    text = LOOP + fmu("a", gain=0.5, bias=[1.0, 0.0]) + wire("a.out", "a.in", "delay = 1\n")
    # the output of the initialized FMU is 1
    result = run(write(text=text))
    assert column(result, "a.out") == pytest.approx(2.0 - 0.5 ** (K + 1), rel=1e-12)


def test_an_fmu_in_place_of_a_plant_is_controlled(write: Write) -> None:
    text = (
        LOOP
        + fmu("law", gain=-40.0, bias=[40.0, 0.0])
        + fmu("axis")
        + wire("axis.sum", "law.in", "delay = 1\n")
        + wire("law.out", "axis.in")
    )
    # y[k] = y[k-1] + h g (1 - y[k-1])
    result = run(write(text=text))
    assert column(result, "axis.sum") == pytest.approx(1.0 - 0.96 ** (K + 1), rel=1e-12)
    assert [name for name in result.units if name.startswith("plant.")] == []


def test_readings_and_commands_of_a_plant_pass_through_a_chain(write: Write) -> None:
    chain = fmu("a", gain=0.5) + fmu("b", gain=0.5) + '[plant]\nname = "probe_plants:Lag"\n'
    wires = wire("plant.x", "a.in") + wire("a.out", "b.in") + wire("b.out", "plant.u")
    for delay in (0, 1):
        change = f"loop.compute_delay={delay}"
        result = run(write(name="chain.toml", text=LOOP + chain + wires), change)
        single = run(write(), "controller.gain=0.25", "loop.duration=0.02", change)
        assert column(result, "plant.x").tobytes() == column(single, "plant.x").tobytes()


def test_a_wire_between_fmus_scales_then_quantises_and_limits(write: Write) -> None:
    shaped = "scale = 10.0\noffset = 1.0\nquantum = 5.0\nmaximum = 12.0\n"
    text = series(shaped)
    result = run(write(text=text))
    assert set(column(result, "b.in")) == {12.0, -60.0}
    noisy = run(write(text=text), "wire.b.in.noise=3.0", "wire.b.in.quantum=0", "wire.b.in.maximum=inf")
    assert 1.0 < np.std(column(noisy, "b.in")[:10]) < 5.0
    assert np.mean(column(noisy, "b.in")[:10]) == pytest.approx(21.0, abs=4.0)


def test_an_fmu_with_a_longer_step_holds_its_outputs(write: Write) -> None:
    slow = "step = 0.004\n"
    text = (
        LOOP + fmu("a") + fmu("b", slow) + wire("a.out", "b.in") + wire("b.calls", "a.count", "delay = 1\n")
    )
    ramp = '[[signal]]\nto = "a.in"\ntimes = [0.0, 0.02]\nvalues = [0.0, 20.0]\ninterpolation = "linear"\n'
    result = run(write(text=text + ramp))
    assert column(result, "b.out") == pytest.approx(K // 4 * 4.0)
    assert column(result, "b.calls").tolist() == (K // 4 + 1).tolist()
    assert column(result, "b.clock.time") == pytest.approx(K // 4 * 0.004)
    # its integral takes its own step
    assert column(result, "b.sum")[-1] == pytest.approx(0.004 * (0 + 4 + 8 + 12 + 16))
    assert column(result, "a.count").tolist() == [0.0, *(K[:-1] // 4 + 1.0)]


def several(text: str) -> str:
    """Write the table `[controller]` of a scenario as the only one of a list."""
    table = '[[fmu]]\nname = "controller"'
    return text.replace("[controller]", table).replace("[controller.parameters]", "[fmu.parameters]")


def test_the_two_forms_give_the_same_bytes(write: Write) -> None:
    file = write(END)
    noisy = ("wire.controller.in.noise=0.1", "controller.gain=0.7", "controller.bias=[0.1, 0.2]")
    traces = [whole(run(path, *noisy)) for path in (file, write(END, "many.toml", several(SCENARIO)))]
    assert traces[0].dtype == traces[1].dtype
    assert traces[0].tobytes() == traces[1].tobytes()


def test_a_scenario_of_the_project_gives_the_same_bytes_in_both_forms(tmp_path: Path) -> None:
    (tmp_path / "many.toml").write_text(several((ROOT / "scenarios" / "dob.toml").read_text()))
    short = "loop.duration=0.03"
    traces = [whole(run(file, short)) for file in (Path("dob"), tmp_path / "many.toml")]
    assert traces[0].dtype == traces[1].dtype
    assert len(traces[0]) == 300
    assert traces[0].tobytes() == traces[1].tobytes()


def test_runs_repeat_and_the_native_engine_leaves_it_to_the_reference_loop(
    write: Write, caplog: pytest.LogCaptureFixture
) -> None:
    scenario = cosim.load(write(name="ring.toml", text=ring(1)))
    with cosim.Session(scenario) as session:
        first, again = session.run(), session.run()
    with caplog.at_level(logging.INFO, "cosim"):
        result = cosim.run(scenario)
    assert result.engine == "reference"
    reported = [record.getMessage() for record in caplog.records if "reference engine" in record.getMessage()]
    assert reported == ["`ring` runs in the reference engine: the native engine requires a `[controller]`"]
    assert whole(first).tobytes() == whole(again).tobytes() == whole(result).tobytes()


def test_a_session_takes_over_the_instances_that_fit(write: Write) -> None:
    scenario = cosim.load(write(text=ring(1)))
    first = cosim.Session(scenario)
    old = {instance.name: instance for instance in first.fmus}
    more = write(name="more.toml", text=ring(1) + signal("b.count", [0.0], [1.0]))
    with cosim.Session(cosim.load(more, set=["a.gain=0.25"]), previous=first) as second:
        assert second.fmus[0] is old["a"]
        assert second.fmus[1] is not old["b"]
        assert old["b"].closed
        # `b` is initialized with the output 1 of `a`
        first_out = 1.0 + 0.25 * 0.5
        assert column(second.run(), "a.out")[:2].tolist() == [first_out, 1.0 + 0.25 * 0.5 * first_out]
    assert old["a"].closed


def test_an_fmu_is_reported_by_the_name_that_the_scenario_gives_it(write: Write) -> None:
    file = write()
    first = cosim.Session(cosim.load(file))
    with cosim.Session(cosim.load(file, set=["controller.fmu=./probe.fmu"]), previous=first) as second:
        assert second.run().fmus == {"./probe.fmu": "probe-guid"}


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[Instance]:
    """Note every instance that is made."""
    made: list[Instance] = []
    opening = Instance.__init__

    def noted(instance: Instance, *arguments: Any) -> None:
        opening(instance, *arguments)
        made.append(instance)

    monkeypatch.setattr(Instance, "__init__", noted)
    return made


def test_a_scenario_that_cannot_run_leaves_nothing_open(write: Write, opened: list[Instance]) -> None:
    scenario = cosim.load(write(text=ring(1)), set=["loop.stop_when=c.out > 1"])
    with pytest.raises(CosimError, match=r"names `c\.out`"):
        cosim.Session(scenario)
    assert [instance.closed for instance in opened] == [True, True]


def test_an_fmu_that_cannot_be_instantiated_leaves_none_open(
    write: Write, folder: Path, opened: list[Instance]
) -> None:
    with zipfile.ZipFile(folder / "probe.fmu") as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    description = parts.pop("modelDescription.xml").decode().replace("probe-guid", "another")
    pack(folder / "wrong.fmu", description, parts)
    with pytest.raises(CosimError, match="cannot instantiate the FMU `b`: wrong GUID"):
        run(write(text=ring(1)), "b.fmu=wrong")
    assert [(instance.name, instance.closed) for instance in opened] == [("a", True)]
