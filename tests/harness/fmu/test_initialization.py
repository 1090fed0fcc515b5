"""The first step of a run: experiment, inputs in the initialization mode, and status values."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest

import cosim
from cosim.errors import FmuError
from cosim.loop.engines import ENGINES, Engine

from ..bad_inputs import fmus
from ..conftest import entry
from ..loop.several import LOOP, column, fmu, run, signal, wire
from ..native.conftest import CART
from ..native.conftest import SCENARIO as WIRED

Write = Callable[..., Path]
ALONE = 'title = "Alone"\nloop = {step = 0.001, duration = 0.02}\n[controller]\nfmu = "probe"\n'
EXPERIMENT = '<DefaultExperiment startTime="10" tolerance="1e-5"/><ModelVariables>'
INIT = "controller.parameters.bias=[0.5, 0.25]"


@pytest.fixture
def defect(folder: Path, broken_library: bytes) -> Callable[..., str]:
    """FMU with a defect of `defects.c`, and texts of its model description replaced."""

    def build(name: str, *edits: tuple[str, str]) -> str:
        fmus.edited(("probe-guid", f"defect:{name}"), *edits)(folder / f"{name}.fmu", broken_library)
        return f"controller.fmu={name}.fmu"

    return build


@pytest.fixture
def cart(folder: Path, write: Write) -> Path:
    """Scenario with a wired cart that the native engine can run."""
    (folder / "cart.xml").write_text(CART)
    return write(name="cart.toml", text=WIRED)


@pytest.mark.parametrize("engine", ENGINES)
def test_the_first_command_follows_from_the_measurements_at_zero(cart: Path, engine: Engine) -> None:
    # `out` = gain * in + bias, the first command is that of the initialized FMU; the position is 0 + offset
    changes = ["loop.compute_delay=1", "wire.controller.in.offset=0.01"]
    result = cosim.run(cosim.load(cart, set=changes), engine=engine)
    assert result.engine == engine
    assert column(result, "plant.drive.command")[0] == pytest.approx(0.75 - 40.0 * 0.01)


def test_signals_have_their_values_in_the_initialization_mode_as_in_fmpy(write: Write, folder: Path) -> None:
    text = LOOP + fmu("a", gain=2.0) + fmu("b") + wire("a.out", "b.in", "delay = 1\n")
    result = run(write(text=text + signal("a.in", [0.0], [5.0])))
    given = np.array([(0.0, 5.0), (1.0, 5.0)], dtype=[("time", float), ("in", float)])
    theirs = fmpy.simulate_fmu(
        str(folder / "probe.fmu"),
        stop_time=0.02,
        output_interval=0.001,
        input=given,
        start_values={"gain": 2.0},
    )
    # the delay begins with the output of the initialized FMU
    assert column(result, "b.in")[0] == theirs["out"][0] == 10.0


def test_a_delay_starts_with_the_output_of_the_initialized_fmu(write: Write) -> None:
    text = LOOP + fmu("a") + fmu("b") + wire("a.sum", "b.in", "delay = 2\n") + signal("a.in", [0.0], [5.0])
    # the sum is 0 until the end of the first step
    assert column(run(write(text=text)), "b.in")[:4].tolist() == [0.0, 0.0, 0.005, 0.01]


def test_an_injection_from_the_start_is_there_in_the_initialization_mode(write: Write) -> None:
    text = LOOP + fmu("a", gain=2.0) + fmu("b") + wire("a.out", "b.in", "delay = 1\n")
    fault = entry("inject", to="a.in", from_time=0.0, to_time=0.01, offset=3.0)
    # nothing else drives the input: its start value is held
    result = run(write(text=text + fault), "a.in=4")
    assert column(result, "a.in").tolist() == [7.0] * 10 + [4.0] * 10
    assert column(result, "b.in")[0] == 14.0


def test_an_input_from_an_fmu_that_is_initialized_later_keeps_its_start_value(write: Write) -> None:
    text = (
        LOOP
        + fmu("a")
        + fmu("b", bias=[5.0, 0.0])
        + wire("a.out", "b.in")
        + wire("b.out", "a.in", "delay = 1\n")
    )
    result = run(write(text=text), "a.in=2")
    # `a` is initialized with 2, then `b` with 2
    assert column(result, "a.in")[:3].tolist() == [7.0, 12.0, 17.0]


def test_the_experiment_has_stop_time_and_tolerance(
    write: Write, defect: Callable[..., str], caplog: pytest.LogCaptureFixture
) -> None:
    chosen = defect("setup", ("<ModelVariables>", EXPERIMENT))
    with caplog.at_level(logging.WARNING, "cosim"):
        result = run(write(text=ALONE), chosen, "controller.parameters.gain=0")
    assert column(result, "controller.out")[-1] == 1e-5 + 0.02
    assert "the FMU: its `DefaultExperiment` starts at 10 s, this run at 0 s" in caplog.messages


def test_the_stop_time_includes_the_last_step_of_a_slower_fmu(
    write: Write, defect: Callable[..., str]
) -> None:
    defect("setup")
    text = LOOP + fmu("a") + fmu("b", "step = 0.007\n") + wire("a.out", "b.in")
    text = text.replace('fmu = "probe"', 'fmu = "setup.fmu"')
    result = run(write(text=text), "a.gain=0", "b.gain=0")
    # no tolerance is -1
    assert column(result, "a.out")[-1] == -1.0 + 0.02
    assert column(result, "b.out")[-1] == pytest.approx(-1.0 + 0.021)


STATUS = {
    "step_terminates": (
        4,
        " ended the run in the step at t = 0.003 s: `fmi2DoStep` returned fmi2Discard with fmi2Terminated",
    ),
    "warning": (60, ": `fmi2DoStep` returned fmi2Warning at t = 0.003 s"),
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", STATUS)
def test_the_end_of_a_run_and_the_first_warning_are_reported(
    cart: Path, defect: Callable[..., str], engine: Engine, name: str, caplog: pytest.LogCaptureFixture
) -> None:
    rows, message = STATUS[name]
    with caplog.at_level(logging.WARNING, "cosim"):
        result = cosim.run(cosim.load(cart, set=[defect(name)]), engine=engine)
    assert (result.engine, len(column(result, "time")), result.simulated_s) == (engine, rows, rows * 0.001)
    assert [text for text in caplog.messages if "fmi2" in text] == [f"the FMU{message}"]


def test_both_engines_give_the_same_bytes_up_to_the_end(cart: Path, defect: Callable[..., str]) -> None:
    scenario = cosim.load(cart, set=[defect("step_terminates"), "loop.record_every=2"])
    traces = [cosim.run(scenario, engine=engine).trace for engine in ENGINES]
    assert traces[0].tobytes() == traces[1].tobytes()  # type: ignore[union-attr]


def test_the_reason_of_a_failed_instantiation_is_fetched_with_logging(
    write: Write, defect: Callable[..., str]
) -> None:
    chosen = defect("instantiate_null_quietly")
    with pytest.raises(FmuError, match="cannot instantiate the FMU `Probe`: no module `law`"):
        run(write(text=ALONE), chosen)


LIMITS = {
    "controller.gain=6": ["`controller.gain` = `6.0` is above its maximum `5`"],
    "controller.gain=5": [],
    "controller.count=-3": ["`controller.count` = `-3` is below its minimum `-2`"],
    "controller.count=-2": [],
}


@pytest.mark.parametrize("change", LIMITS)
def test_a_value_beyond_the_limits_of_the_fmu_is_reported(
    write: Write, folder: Path, change: str, broken_library: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    count = 'name="count" valueReference="0" causality="input" variability="discrete"><Integer'
    # the FMU itself accepts 6
    limit = ('<Real start="1" max="10"/>', '<Real start="1" max="5"/>')
    fmus.edited((count, f'{count} min="-2"'), limit)(folder / "limited.fmu", broken_library)
    with caplog.at_level(logging.WARNING, "cosim"):
        run(write(text=ALONE.replace("probe", "limited.fmu")), change)
    assert [text for text in caplog.messages if " its m" in text] == LIMITS[change]
