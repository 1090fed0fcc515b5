"""FMUs of FMI 3.0: arrays, types of numbers, status values and the end of a run, compared with FMPy."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

import cosim
from cosim.errors import CosimError, FmuError
from cosim.fmu.archive import open_fmu
from cosim.schema.filled import settable_variables

from .. import test_cli
from ..conftest import DATA, compiled, entry, pack

Write = Callable[..., Path]
LIBRARY = f"binaries/{fmpy.platform_tuple}/vector{fmpy.sharedLibraryExtension}"
SCENARIO = """
title = "Vector"
undriven = ["controller.single_in", "controller.flag[1]", "controller.flag[2]", "controller.mode"]
loop = {step = 0.001, duration = 0.02}
[controller]
fmu = "vector"
"""
DRIVEN = "\n".join(
    entry("signal", to=f"controller.x[{index}]", times=[0.0, 0.01], values=values, interpolation="linear")
    for index, values in ((1, [0.0, 0.3]), (2, [1.0, -0.7]), (3, [0.1, 0.2]))
)


@pytest.fixture(scope="session")
def vector_library(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return compiled(tmp_path_factory.mktemp("vector"), DATA / "vector.c")


@pytest.fixture
def vector(folder: Path, vector_library: bytes) -> Callable[..., Path]:
    """Pack `vector.fmu`, with texts of its model description replaced."""

    def build(*edits: tuple[str, str]) -> Path:
        text = (DATA / "vector.xml").read_text()
        for old, new in edits:
            assert old in text, old
            text = text.replace(old, new)
        return pack(folder / "vector.fmu", text, {LIBRARY: vector_library})

    return build


@pytest.fixture
def loop(vector: Callable[..., Path], write: Write) -> Path:
    """Scenario of the unchanged FMU."""
    vector()
    return write(text=SCENARIO, name="vector.toml")


def run(file: Path, *changes: str, **options: Any) -> dict[str, Any]:
    trace = cosim.run(cosim.load(file, set=changes), **options).trace
    assert trace is not None
    return {name.removeprefix("controller."): trace[name] for name in trace.dtype.names or ()}


def theirs(folder: Path, names: list[str], **options: Any) -> Any:
    """Run FMPy; the row of step `k` holds the outputs after it, as in the harness."""
    found = fmpy.simulate_fmu(
        str(folder / "vector.fmu"),
        stop_time=0.02,
        output_interval=0.001,
        relative_tolerance=1e-5,
        output=names,
        **options,
    )
    return found[1:]


def test_arrays_are_elements_and_are_set_by_list_element_and_signal_as_in_fmpy(
    loop: Path, write: Write, folder: Path
) -> None:
    given = {"gain": 3.0, "m": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]}
    file = write(text=SCENARIO + DRIVEN, name="vector.toml")
    ours = run(file, "controller.gain=3", "controller.m=[[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]]")
    kind = [("time", float), ("x", float, (3,))]
    times = np.arange(21) * 0.001
    driven = [(time, [ours[f"x[{i}]"][min(k, 19)] for i in (1, 2, 3)]) for k, time in enumerate(times)]
    found = theirs(folder, ["y", "sum"], start_values=given, input=np.array(driven, kind))
    for index in range(3):
        assert ours[f"y[{index + 1}]"].tobytes() == np.ascontiguousarray(found["y"][:, index]).tobytes()
    assert ours["sum"][0] == found["sum"][0]
    assert ours["y[2]"][0] == 3.0 * 1.0 + 0.2


def test_elements_that_nothing_sets_keep_their_start_values(loop: Path, write: Write) -> None:
    text = SCENARIO + entry("signal", to="controller.x[2]", times=[0.0], values=[1.0])
    ours = run(write(text=text, name="vector.toml"), "controller.x[3]=7", "controller.m[2,1]=4")
    assert [ours[f"x[{index}]"][0] for index in (1, 2, 3)] == [0.0, 1.0, 7.0]
    # `m[1,2]` is 0.5 in the model description
    assert [ours[f"y[{index}]"][-1] for index in (1, 2, 3)] == [0.5, 1.5, 7.5]


LARGE = {
    **{f"int{bits}": 2 ** (bits - 1) - 100 for bits in (8, 16, 32)},
    **{f"uint{bits}": 2**bits - 100 for bits in (8, 16, 32)},
    "int64": 2**53 - 100,
    "uint64": 2**53 - 100,
}
LOWEST = {f"int{bits}": -(2 ** (bits - 1)) for bits in (8, 16, 32, 64)}


@pytest.mark.parametrize("numbers", [LARGE, LOWEST], ids=["large", "lowest"])
def test_every_type_of_number_is_moved_as_in_fmpy(loop: Path, folder: Path, numbers: dict[str, int]) -> None:
    names = [f"{name}_out" for name in numbers]
    changes = [f"controller.{name}={value}" for name, value in numbers.items()]
    changes += ["controller.single_in=0.1", "controller.flag=[true, false]", "controller.mode=Far"]
    ours = run(loop, *changes)
    found = theirs(folder, [*names, "single"], start_values={**numbers, "single_in": 0.1})
    for name in [*names, "single"]:
        assert ours[name].tolist() == found[name].astype(float).tolist(), name
    assert ours["single"][0] == float(np.float32(0.1))
    assert (ours["mode_out"][0], ours["flag_out[1]"][0], ours["flag_out[2]"][0]) == (5e9, 0.0, 1.0)


def test_a_number_of_32_bits_may_be_infinite(loop: Path) -> None:
    assert run(loop, "controller.single_in=inf")["single"][0] == np.inf


def test_the_experiment_has_tolerance_and_stop_time(loop: Path) -> None:
    ours = run(loop)
    assert (ours["tolerance"][0], ours["stop"][0]) == (1e-5, 0.02)


BAD = {
    "controller.int8=128": "`controller.int8` is `128`, it must be an integer of 8 bits",
    "controller.uint16=-1": "`controller.uint16` is `-1`, it must be an integer of 16 bits without a sign",
    "controller.single_in=1e39": "`controller.single_in` is `1e+39`, it must be a number of 32 bits",
    "controller.mode=Near": "it must be one of `Off`, `Far`",
    "controller.m=[1, 2]": "`controller.m` has 2 values instead of 6",
    "controller.x=[1, 2, 3, 4]": "`controller.x` has 4 values instead of 3",
    'controller.label="a\\u0000"': "it must be a text without NUL characters",
    "controller.n=4": "`controller.n` is a structural parameter and cannot be set",
    "controller.blob=1": "`controller.blob` is a variable of type `Binary` and cannot be set",
    "controller.gain=11": "the FMU rejected `controller.gain` = `11.0`: `gain` is above its limit",
    "controller.x[4]=1": "the FMU has no variable `x[4]`",
}


@pytest.mark.parametrize("change", BAD)
def test_a_value_that_does_not_fit_is_rejected(loop: Path, change: str) -> None:
    with pytest.raises(CosimError, match=re.escape(BAD[change])):
        run(loop, change)


def test_an_array_of_texts_cannot_be_set(vector: Callable[..., Path], write: Write) -> None:
    vector(('<Start value="hello"/>', '<Dimension start="2"/><Start value="hello"/>'))
    problem = r"`controller.label\[1\]` is an array of type `String` and cannot be set"
    with pytest.raises(FmuError, match=problem):
        run(write(text=SCENARIO, name="vector.toml"), "controller.label[1]=a")


@pytest.mark.parametrize(
    ("what", "problem"),
    [
        (2, r"`fmi3DoStep` of `Vector` returned early, at t = 0.0035 s, .*at t = 0.003 s \(step 3\)"),
        (
            3,
            r"`Vector` needs the Event Mode \(`eventHandlingNeeded`\), which is not supported at t = 0.003 s",
        ),
        (5, r"the FMU failed at t = 0.003 s \(step 3\): on request \(fmi3DoStep returned fmi3Discard\)"),
        (6, r"the FMU failed at t = 0.003 s \(step 3\): on request \(fmi3DoStep returned fmi3Error\)"),
        (7, r"the FMU failed at t = 0.003 s \(step 3\): on request \(fmi3DoStep returned fmi3Fatal\)"),
    ],
)
def test_a_step_that_fails_is_explained(loop: Path, what: int, problem: str) -> None:
    with pytest.raises(FmuError, match=problem):
        run(loop, "controller.at=3", f"controller.what={what}")


@pytest.mark.parametrize(
    ("what", "rows", "message"),
    [
        (1, 4, "ended the run in the step at t = 0.003 s: `fmi3DoStep` returned `terminateSimulation`"),
        (4, 20, ": `fmi3DoStep` returned fmi3Warning at t = 0.003 s"),
    ],
)
def test_the_end_of_a_run_and_the_first_warning_are_reported(
    loop: Path, folder: Path, what: int, rows: int, message: str, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING, "cosim"):
        ours = run(loop, "controller.at=3", f"controller.what={what}")
    assert any(message in record.getMessage() for record in caplog.records)
    found = theirs(folder, ["sum"], start_values={"at": 3, "what": what})
    assert len(ours["time"]) == len(found) == rows
    assert ours["sum"].tobytes() == np.ascontiguousarray(found["sum"]).tobytes()


def test_runs_are_repeatable_with_reset_and_with_new_instances(
    loop: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with cosim.Session(cosim.load(loop)) as session:
        traces = [session.run(seed).trace for seed in (1, 2, 3)]
    assert len({trace.tobytes() for trace in traces if trace is not None}) == 1
    with (
        caplog.at_level(logging.WARNING, "cosim"),
        cosim.Session(cosim.load(loop, set=["controller.what=8"])) as session,
    ):
        session.run(1)
        session.run(2)
    warning = "the FMU: every run gets a new instance, because it cannot be reset: no reset"
    warning += " (fmi3Reset returned"
    assert any(warning in record.getMessage() for record in caplog.records)


def test_a_reused_instance_ends_and_warns_only_in_its_own_run(
    loop: Path, caplog: pytest.LogCaptureFixture
) -> None:
    loops = [
        cosim.load(loop, set=[f"controller.what={what}", f"controller.at={at}"])
        for what, at in ((4, 3), (4, 5), (1, 6), (0, 0))
    ]
    runs = cosim.run_each(loops, workers=1)
    assert [one.simulated_s for one in runs if isinstance(one, cosim.Result)] == [0.02, 0.02, 0.007, 0.02]
    texts = [text.rpartition("returned ")[2] for text in caplog.messages if "fmi3Warning" in text]
    assert texts == [f"fmi3Warning at t = {at} s" for at in (0.003, 0.005)]


def test_a_reset_that_keeps_values_is_found(vector: Callable[..., Path], write: Write) -> None:
    # a file of its own, because what holds for a file is checked once in a process
    vector(("FMI 3.0 for the tests", "FMI 3.0 with a bad reset for the tests"))
    text = SCENARIO + entry("signal", to="controller.x[1]", times=[0.0], values=[1.0])
    file = write(text=text, name="vector.toml")
    with cosim.Session(cosim.load(file, set=["controller.what=9"])) as session:
        session.run(1)
        with pytest.raises(FmuError, match="keeps state"):
            session.run(2)


def test_the_native_engine_leaves_it_to_the_reference_engine(
    loop: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO, "cosim"):
        assert cosim.run(cosim.load(loop), engine="native").engine == "reference"
    assert "the native engine requires FMI 2.0" in caplog.text


EDITS = {
    "offers only ModelExchange and ScheduledExecution": (
        '<CoSimulation modelIdentifier="vector" canHandleVariableCommunicationStepSize="true"/>',
        '<ModelExchange modelIdentifier="vector"/><ScheduledExecution modelIdentifier="vector"/>',
    ),
    "`m` has 5 start values for 6 elements": ('start="0 0.5 0 0 0 0"', 'start="0 0.5 0 0 0"'),
    "'0 0,5 0 0 0 0'": ('start="0 0.5 0 0 0 0"', 'start="0 0,5 0 0 0 0"'),
    'name "y" (line': ('<Alias name="z" displayUnit="1/m"/>', '<Alias name="y"/>'),
    "no `instantiationToken`": ('instantiationToken="vector-token"', ""),
}


@pytest.mark.parametrize("problem", EDITS)
def test_a_description_that_cannot_be_used_is_rejected(vector: Callable[..., Path], problem: str) -> None:
    with pytest.raises(FmuError, match=re.escape(problem)):
        open_fmu(vector(EDITS[problem]))


def test_an_fmu_that_does_not_instantiate_or_fit_the_platform_says_why(
    vector: Callable[..., Path], folder: Path, write: Write
) -> None:
    vector(("vector-token", "another"))
    with pytest.raises(FmuError, match="cannot instantiate the FMU `Vector`: wrong token"):
        run(write(text=SCENARIO, name="vector.toml"))
    text = (DATA / "vector.xml").read_text()
    pack(folder / "vector.fmu", text, {f"binaries/{fmpy.platform}/vector.so": b""})
    with pytest.raises(FmuError, match=f"no binary for this platform, `{fmpy.platform_tuple}`"):
        open_fmu(folder / "vector.fmu")


def test_elements_have_units_display_units_and_start_values(vector: Callable[..., Path]) -> None:
    variables = open_fmu(vector()).variables
    element = variables["x[2]"]
    assert (element.unit, element.display and element.display.name, element.start) == ("m", "mm", "0")
    # a reciprocal is no factor, and an alias of an input no second input
    assert (variables["z[2]"].display, variables["z[2]"].causality) == (None, "local")
    assert [variables[f"m[1,{column}]"].start for column in (1, 2)] == ["0", "0.5"]
    entries = settable_variables(variables.values())
    assert entries["x"]["maxItems"] == 3
    assert entries["m"]["items"] == {"type": "array", "items": entries["m[1,1]"]}
    assert "n" not in entries


def test_commands_work_with_it(loop: Path, folder: Path) -> None:
    study = 'scenario = "vector.toml"\n[design]\nkind = "grid"\n'
    (folder / "study.toml").write_text(study + entry("vary", key="controller.m[1,2]", values=[1.0, 2.0]))
    for command in (
        ("show", "vector.toml"),
        ("check", "vector.toml"),
        ("list",),
        ("run", "vector.toml", "--seeds", "1..3"),
        ("new", "vector.fmu", "--out", "drafted.toml"),
        ("sweep", "study.toml", "--no-plots"),
    ):
        done = test_cli.cosim(*command)
        assert done.returncode == 0, done.stderr


def test_an_ssp_system_requires_fmi_2(loop: Path, write: Write) -> None:
    wire = entry("wire", **{"from": "plant.x"}, to="controller.x[1]")
    write(text=SCENARIO + '[plant]\nname = "probe_plants:Lag"\n' + wire, name="vector.toml")
    done = test_cli.cosim("ssp", "vector.toml", "-o", "vector.ssp")
    assert (done.returncode, "`vector.fmu` is an FMI 3.0 FMU" in done.stderr) == (2, True), done.stderr
