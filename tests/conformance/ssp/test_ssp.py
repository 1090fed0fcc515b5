"""A loop as an SSP package closes in masters of others, and finds the contact where the harness finds it."""

from __future__ import annotations

import importlib.util
import io
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import pytest
from fmpy import read_model_description
from fmpy.ssp.ssd import read_ssd, read_ssv

import cosim
from cosim.errors import CosimError
from cosim.ssp.package import write
from cosim.ssp.structure import named

from ..conftest import ROOT, need

SHORT = [
    "controller.learn.settle_time=0.23",
    "controller.learn.time=0.15",
    "plant.surface_distance=4.2e-5",
    "plant.surface_spread=0.0",
    "loop.duration=0.55",
    'loop.stop_when=""',
]
"""A short approach."""
STEPS = 5400
WAY = 1e-4 * 1e-4
"""Way of one communication step at 100 um/s, m."""
EXECUTION = Path(__file__).with_name("execution.py")
LOOPS = ["centering", "deburr", "dob", "fts", "polish"]


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("ssp") / "dob.ssp"
    write("dob", SHORT, None, file)
    return file


@pytest.fixture(scope="module")
def found() -> tuple[float, float]:
    """Contact position and depth of the harness after as many steps."""
    trace = cosim.run(cosim.load("dob", SHORT), engine="native").trace
    assert trace is not None
    return float(trace["controller.contact_position"][STEPS]), float(trace["plant.depth_max"][STEPS])


@pytest.mark.client("FMPy", "validates the SSP by the schemas")
@pytest.mark.parametrize("loop", LOOPS)
def test_every_loop_is_a_package_by_the_schemas(loop: str, tmp_path: Path) -> None:
    file = tmp_path / "loop.ssp"
    scenario = write(loop, [], 5, file)
    # both readers validate the files by the schemas of SSP 1.0
    system = read_ssd(str(file)).system
    parameters = read_ssv(str(file), "resources/controller.ssv").parameters
    held = {
        signal.to.removeprefix("controller."): signal.values[0]
        for signal in scenario.signal
        if signal.to == "controller.mode" and len(signal.values) == 1
    }
    assert {parameter.name.partition("[")[0] for parameter in parameters} == {
        *scenario.controller.parameters,
        *held,
    }
    assert {(parameter.name, parameter.value) for parameter in parameters} >= set(held.items())
    assert [int(seed.value) for seed in read_ssv(str(file), "resources/plant.ssv").parameters] == [5]

    with zipfile.ZipFile(file) as archive:
        archive.extract("resources/controller.fmu", tmp_path)
        structure = ElementTree.fromstring(archive.read("SystemStructure.ssd"))
    description = read_model_description(str(tmp_path / "resources/controller.fmu"))
    controller = next(element for element in system.elements if element.name == "controller")
    # the FMUs know model exchange too, with which the loop would have another delay
    made = list(structure.iter(named("ssd:Component")))
    assert len(made) == 2
    assert {component.get("implementation") for component in made} == {"CoSimulation"}
    units = {v.name: v.unit for v in description.modelVariables if v.type == "Real"}
    texts = {v.name for v in description.modelVariables if v.type == "String"}
    connectors = {connector.name for connector in controller.connectors}
    assert connectors
    assert not connectors & texts
    reported = {
        connector.get("name"): [real.get("unit") for real in connector.iter(named("ssc:Real"))]
        for component in structure.iter(named("ssd:Component"))
        for connector in component.iter(named("ssd:Connector"))
        if component.get("name") == "controller"
    }
    assert reported == {name: [units[name]] if name in units else [] for name in connectors}
    defined = {unit.get("name") for unit in structure.iter(named("ssc:Unit"))}
    used = {unit for one in reported.values() for unit in one if unit}
    assert used
    assert used <= defined
    wired = {(c.endElement, c.endConnector) for c in system.connections}
    driven = {wire.to for wire in scenario.wire} | {signal.to for signal in scenario.signal}
    inputs = {("controller", to.removeprefix("controller.")) for to in driven if to.startswith("controller.")}
    # an enumeration that stays is a start value
    assert inputs - wired == {("controller", name) for name in held}
    # to an input that nothing drives FMPy would give the value of another
    assert {("controller", end.name) for end in controller.connectors if end.kind == "input"} <= wired


@pytest.mark.client("pyssp-standard", "checks the SSP", fmu="dob")
def test_pyssp_standard_finds_nothing_wrong(package: Path, tmp_path: Path) -> None:
    need("pyssp_standard", "pyssp_standard" if importlib.util.find_spec("pyssp_standard") else None)
    from pyssp_standard.ssp import SSP

    # it rewrites the file when it closes it
    with SSP(shutil.copy(package, tmp_path)) as ssp, ssp.system_structure as structure:
        assert structure.check_connections(unconnected_inputs=False) == []
        assert sorted(ssp.resources) == ["controller.fmu", "controller.ssv", "plant.fmu", "plant.ssv"]


def run(
    master: str, module: str, package: Path, steps: int, outputs: list[str], step: float = 1e-4
) -> list[float]:
    """Values of outputs in a master after a number of steps of a given length (s)."""
    need(module, module if importlib.util.find_spec(module) else None)
    # Ecos finds the library that its wheel lacks in the environment
    libraries = [str(Path(sys.prefix) / "lib"), os.environ.get("LD_LIBRARY_PATH", "")]
    environment = os.environ | {"LD_LIBRARY_PATH": os.pathsep.join(libraries)}
    command = [sys.executable, str(EXECUTION), master, str(package), str(step), str(steps), *outputs]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    values: list[float] = json.loads(done.stdout.splitlines()[-1])
    return values


def contact(master: str, module: str, package: Path) -> tuple[float, float]:
    """Contact position and depth in a master; the parameter set must have reached the controller."""
    outputs = ["controller::contact_position", "plant::plant.depth_max", "controller::learn.time"]
    position, depth, learn = run(master, module, package, STEPS, outputs)
    assert learn == pytest.approx(0.15)
    return position, depth


@pytest.mark.client("libcosim", "closes the loop of the SSP", fmu="dob")
@pytest.mark.skipif(sys.platform != "linux", reason="libcosimpy has no wheel for this platform")
def test_libcosim_closes_the_loop_bit_for_bit(package: Path, found: tuple[float, float]) -> None:
    assert contact("libcosim", "libcosimpy", package) == found


@pytest.mark.skipif(sys.platform != "linux", reason="libcosimpy has no wheel for this platform")
def test_the_noise_of_a_command_is_that_of_the_harness(tmp_path: Path) -> None:
    noisy = [*SHORT, "wire.plant.current.noise=2e-3", "wire.plant.current.delay=2"]
    trace = cosim.run(cosim.load("dob", noisy), engine="native").trace
    assert trace is not None
    write("dob", noisy, None, tmp_path / "dob.ssp")
    position, depth = contact("libcosim", "libcosimpy", tmp_path / "dob.ssp")
    assert position == trace["controller.contact_position"][STEPS]
    assert depth == trace["plant.depth_max"][STEPS]


@pytest.mark.client("Ecos", "closes the loop of the SSP", fmu="dob")
@pytest.mark.skipif(sys.platform != "linux", reason="ecospy has no wheel for this platform")
def test_ecos_closes_the_loop_bit_for_bit(package: Path, found: tuple[float, float]) -> None:
    assert contact("Ecos", "ecospy", package) == found


@pytest.mark.client("FMPy", "closes the loop of the SSP", fmu="dob")
def test_fmpy_closes_the_loop(tmp_path: Path) -> None:
    # its first step has zeros for inputs: from any other place the stage would seem to jump, a fault
    at_zero = [*SHORT, "plant.start_spread=0.0"]
    trace = cosim.run(cosim.load("dob", at_zero), engine="native").trace
    assert trace is not None
    write("dob", at_zero, None, tmp_path / "dob.ssp")
    position, depth = contact("FMPy", "fmpy", tmp_path / "dob.ssp")
    assert abs(position - trace["controller.contact_position"][STEPS]) <= WAY
    assert depth == pytest.approx(trace["plant.depth_max"][STEPS], abs=WAY)


OTHERS = {
    "centering": (1500, ["plant.ring_x", "plant.ring_y", "plant.slide_position"]),
    "polish": (1200, ["plant.ball_x", "plant.ball_z", "plant.contact_force"]),
}
"""Other loops: steps until the work has begun, and what the plant shows of it."""


class Other(NamedTuple):
    """A loop as a package, its step in s, and what the harness finds in it."""

    package: Path
    step: float
    found: list[float]


@pytest.fixture(scope="module", params=OTHERS)
def loop(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


@pytest.fixture(scope="module")
def other(loop: str, tmp_path_factory: pytest.TempPathFactory) -> Other:
    steps, columns = OTHERS[loop]
    file = tmp_path_factory.mktemp("ssp") / "loop.ssp"
    scenario = write(loop, [], None, file)
    trace = cosim.run(scenario, engine="native").trace
    assert trace is not None
    return Other(file, scenario.loop.step, [float(trace[column][steps]) for column in columns])


def seen(master: str, module: str, loop: str, other: Other) -> list[float]:
    """Return what a master finds in another loop."""
    steps, columns = OTHERS[loop]
    return run(master, module, other.package, steps, [f"plant::{column}" for column in columns], other.step)


@pytest.mark.client("libcosim", "closes the loop of the SSP")
@pytest.mark.skipif(sys.platform != "linux", reason="libcosimpy has no wheel for this platform")
def test_libcosim_closes_other_loops_bit_for_bit(loop: str, other: Other) -> None:
    assert seen("libcosim", "libcosimpy", loop, other) == other.found


@pytest.mark.client("Ecos", "closes the loop of the SSP")
@pytest.mark.skipif(sys.platform != "linux", reason="ecospy has no wheel for this platform")
def test_ecos_closes_other_loops_bit_for_bit(loop: str, other: Other) -> None:
    assert seen("Ecos", "ecospy", loop, other) == other.found


@pytest.mark.client("FMPy", "closes the loop of the SSP")
def test_fmpy_closes_other_loops(loop: str, other: Other) -> None:
    values = seen("FMPy", "fmpy", loop, other)
    if loop == "centering":
        # its slide begins at zero, as FMPy says in its first step
        assert values == other.found
    else:
        # other first measurements change the learned values a little: hundredths of a micrometer, some 10 mN
        *place, force = other.found
        assert values == [*(pytest.approx(x, abs=5e-8) for x in place), pytest.approx(force, abs=0.05)]


@pytest.mark.client("FMPy", "closes the loop of the SSP", fmu="fts")
def test_fmpy_closes_a_loop_with_a_mode_and_a_delay(tmp_path: Path) -> None:
    # its first step has zeros for inputs, the spindle seems to jump: its speed settles before the tool moves
    late = [
        "signal.controller.enable.times=[0.0, 0.25]",
        "signal.controller.enable.values=[false, true]",
        "wire.controller.spindle_angle.delay=2",
        "loop.duration=0.46",
    ]
    steps = 4500
    trace = cosim.run(cosim.load("fts", late), engine="native").trace
    assert trace is not None
    write("fts", late, None, tmp_path / "fts.ssp")
    outputs = ["plant::plant.tip_depth", "controller::torque"]
    depth, torque = run("FMPy", "fmpy", tmp_path / "fts.ssp", steps, outputs)
    # the tool moves: the delay alone is two steps of the path
    way = abs(trace["plant.tip_depth"][steps + 1] - trace["plant.tip_depth"][steps])
    assert way > 5e-6
    assert depth == pytest.approx(trace["plant.tip_depth"][steps], abs=1e-3 * way)
    assert torque == pytest.approx(trace["controller.torque"][steps - 1], rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "reported"),
    [
        (["loop.compute_delay=0"], "`loop.compute_delay` = 0"),
        (["loop.seed=2147483648"], "the seed 2147483648"),
        (["wire.controller.position.from=plant.positon"], "no measurement `positon`"),
        (["wire.controller.position.from=plnt.position"], "`plnt"),
        (["wire.plant.current.from=contoller.current"], "`contoller"),
        (["wire.plant.current.from=plant.position"], "`plant.position`"),
    ],
)
def test_what_a_package_cannot_show_is_rejected(changes: list[str], reported: str, tmp_path: Path) -> None:
    with pytest.raises(CosimError) as caught:
        write("dob", changes, None, tmp_path / "dob.ssp")
    assert reported in caught.value.message
    assert not list(tmp_path.iterdir())


def table(section: str, **keys: object) -> str:
    """Append a table to a scenario."""
    return "".join([f"\n[[{section}]]\n", *(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())])


TWO = """
title = "Two controllers"

[loop]
step = 1e-4
substeps = 2
duration = 0.1

[plant]
name = "slide"
"""
TWO += "".join(table("fmu", name=name, fmu=fmu) for name, fmu in [("a", "fmu-dob"), ("b", "fmu-dob")])
TWO += table("wire", **{"from": "plant.position", "to": "a.position"})
TWO += table("wire", **{"from": "b.current", "to": "plant.current"})


def between(**keys: object) -> str:
    """Wire between the two FMUs."""
    return table("wire", **{"from": "a.contact_position", "to": "b.position", "delay": 1} | keys)


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        (TWO + between(delay=0), "`delay` = 0"),
        (TWO + between(delay=2), "`delay` = 2"),
        (TWO.replace('"fmu-dob"', '"fmu-dob"\nstep = 2e-4', 1) + between(), "the step 0.0002 s of `a`"),
        (TWO + between(noise=1e-9), "noise, quantum and limits"),
        (TWO + between(**{"from": "a.contact", "to": "b.enable", "scale": 2.0}), "`a.contact`, a Boolean"),
        (TWO + between(**{"from": "a.contact"}), "`a.contact` is a Boolean and `b.position` a Real"),
        (TWO + between(**{"from": "a.reference.position"}), "has causality `local`"),
        (TWO + between(to="b.contact.bias"), "has causality `parameter`"),
        (
            TWO.replace("fmu-dob", "fmu-deburr", 1).replace("a.position", "a.axis6.position")
            + between(**{"from": "a.bank.message"}),
            "`a.bank.message` is not a numeric output",
        ),
        (
            TWO + between() + table("inject", to="a.position", offset=1e-6, from_time=0.01, duration=0.01),
            "the injection at `a.position`",
        ),
        (TWO.partition("[plant]")[0] + '[controller]\nfmu = "fmu-dob"\n', "without a plant"),
    ],
)
def test_what_no_connection_can_be_is_rejected(text: str, reported: str, tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(text)
    with pytest.raises(CosimError) as caught:
        write(str(tmp_path / "two.toml"), [], None, tmp_path / "two.ssp")
    assert reported in caught.value.message
    assert [file.name for file in tmp_path.iterdir()] == ["two.toml"]


def test_two_fmus_are_connected_as_the_harness_does_and_the_scenario_by_its_path(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(TWO + between(scale=2.0))
    write(str(tmp_path / "two.toml"), [], None, tmp_path / "two.ssp")
    with zipfile.ZipFile(tmp_path / "two.ssp") as archive:
        structure = ElementTree.fromstring(archive.read("SystemStructure.ssd"))
        plant = io.BytesIO(archive.read("resources/plant.fmu"))
    (wire,) = [
        connection
        for connection in structure.iter(named("ssd:Connection"))
        if (connection.get("startElement"), connection.get("endElement")) == ("a", "b")
    ]
    assert wire.get("suppressUnitConversion") == "true"
    (scaled,) = wire
    assert (scaled.tag, scaled.get("factor")) == (named("ssc:LinearTransformation"), "2.0")
    with zipfile.ZipFile(plant) as archive:
        settings = json.loads(archive.read("resources/loop.json"))
    assert Path(settings["loop"]) == tmp_path / "two.toml"


PLANT_ALONE = """
import os, sys
import fmpy
steps = {"stop_time": 3e-4, "step_size": 1e-4, "output_interval": 1e-4}
rows = fmpy.simulate_fmu(sys.argv[1], output=["controller.enable"], **steps)
print([bool(row) for row in rows["controller.enable"]], flush=True)
os._exit(0)
"""


def test_a_plant_needs_neither_the_fmu_nor_the_folder_of_who_wrote_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    (here / "build").mkdir(parents=True)
    there.mkdir()
    shutil.copy(ROOT / "target/fmu/fmu-dob.fmu", here / "build/own.fmu")
    (here / "enable.csv").write_text("time,enable\n0,0\n2e-4,1\n")
    monkeypatch.chdir(here)
    changes = [f"signal.controller.enable.{key}=[]" for key in ("times", "values")]
    changes += ["controller.fmu=build/own.fmu", "signal.controller.enable.file=enable.csv"]
    write("dob", changes, None, there / "dob.ssp")
    shutil.rmtree(here / "build")
    with zipfile.ZipFile(there / "dob.ssp") as archive:
        archive.extract("resources/plant.fmu", there)
    command = [sys.executable, "-c", PLANT_ALONE, str(there / "resources/plant.fmu")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    done = subprocess.run(command, cwd=there, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[-1].lower()) == [False, False, True, True]


@pytest.mark.parametrize("loop", LOOPS)
def test_the_files_of_a_package_are_valid_by_the_schemas_of_ssp_2(loop: str, tmp_path: Path) -> None:
    need("pyssp_standard", "pyssp_standard" if importlib.util.find_spec("pyssp_standard") else None)
    import pyssp_standard
    from lxml import etree

    write(loop, [], None, tmp_path / "loop.ssp")
    schemas = Path(pyssp_standard.__file__).parent / "resources/ssp2"
    kinds = {".ssd": "SystemStructureDescription.xsd", ".ssv": "SystemStructureParameterValues.xsd"}
    with zipfile.ZipFile(tmp_path / "loop.ssp") as archive:
        files = [name for name in archive.namelist() if Path(name).suffix in kinds]
        assert sorted(Path(name).name for name in files) == [
            "SystemStructure.ssd",
            "controller.ssv",
            "plant.ssv",
        ]
        for name in files:
            schema = etree.XMLSchema(file=str(schemas / kinds[Path(name).suffix]))
            document = etree.fromstring(archive.read(name))
            assert schema.validate(document), schema.error_log
            document.set("version", "2.1")
            assert not schema.validate(document)


def test_a_scenario_of_the_project_is_named_by_its_place_there(package: Path) -> None:
    with (
        zipfile.ZipFile(package) as archive,
        zipfile.ZipFile(io.BytesIO(archive.read("resources/plant.fmu"))) as plant,
    ):
        assert json.loads(plant.read("resources/loop.json"))["loop"] == "dob.toml"
