"""The text side of an FMU: schema, FMPy's rules, units, structure, documentation."""

from __future__ import annotations

import ctypes
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from .conftest import NAMES, ROOT, Fmu, generated_files

SCHEMA = Path(fmpy.__file__).parent / "schema/fmi2/fmi2ModelDescription.xsd"


def read(fmu: Fmu, path: str) -> str:
    with zipfile.ZipFile(fmu.file) as archive:
        return archive.read(path).decode()


def elements(fmu: Fmu, path: str) -> list[ElementTree.Element]:
    return ElementTree.fromstring(read(fmu, "modelDescription.xml")).findall(path)


def test_every_controller_is_packed() -> None:
    controllers = {folder.parent.name for folder in ROOT.glob("fmu-*/Cargo.toml")}
    missing = sorted(controllers - set(NAMES))
    assert not missing, f"no FMU of {missing} under target/fmu\nhint: run `cargo xtask fmu`"


def test_the_description_follows_the_schema(fmu: Fmu) -> None:
    schema = etree.XMLSchema(etree.parse(SCHEMA))
    schema.assertValid(etree.fromstring(read(fmu, "modelDescription.xml").encode()))


def test_a_broken_description_does_not_follow_the_schema(fmu: Fmu) -> None:
    schema = etree.XMLSchema(etree.parse(SCHEMA))
    text = read(fmu, "modelDescription.xml")
    for change in [('fmiVersion="2.0"', ""), ("<ModelVariables>", '<ModelVariables wrong="1">')]:
        assert change[0] in text
        assert not schema.validate(etree.fromstring(text.replace(*change).encode()))


def test_fmpy_finds_no_problem(fmu: Fmu) -> None:
    assert validate_fmu(str(fmu.file)) == []
    command = [sys.executable, "-m", "fmpy", "validate", str(fmu.file)]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "No problems found" in run.stdout
    assert run.stderr == ""


def test_binary_and_file_hold_the_same_texts(fmu: Fmu) -> None:
    texts = generated_files(fmu.library)
    assert set(texts) == {"modelDescription.xml", "documentation/index.html"}
    for path, text in texts.items():
        assert read(fmu, path) == text


def test_the_guid_is_accepted_by_the_binary_and_fit_for_a_folder_name(fmu: Fmu) -> None:
    assert re.fullmatch(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", fmu.description.guid)
    library = ctypes.CDLL(str(fmu.library))
    library.fmi2Instantiate.restype = ctypes.c_void_p
    library.fmi2FreeInstance.argtypes = [ctypes.c_void_p]
    for guid, accepted in [(fmu.description.guid, True), (f"{{{fmu.description.guid}}}", False)]:
        instance = library.fmi2Instantiate(b"a", 1, guid.encode(), None, None, 0, 0)
        assert (instance is not None) == accepted
        library.fmi2FreeInstance(instance)


def test_capabilities_are_those_of_the_library(fmu: Fmu) -> None:
    (flags,) = elements(fmu, "CoSimulation")
    assert {key: value for key, value in flags.items() if value in ("true", "false")} == {
        "needsExecutionTool": "false",
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "canRunAsynchronuously": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "false",
    }


def test_the_default_experiment_is_complete(fmu: Fmu) -> None:
    (experiment,) = elements(fmu, "DefaultExperiment")
    assert set(experiment.keys()) == {"startTime", "stopTime", "tolerance", "stepSize"}
    assert float(experiment.attrib["stopTime"]) >= 10 * float(experiment.attrib["stepSize"]) > 0


def test_real_inputs_are_continuous(fmu: Fmu) -> None:
    """FMPy's `simulate_fmu(input=...)` is quadratic in the samples of discrete ones."""
    assert fmu.variables("input", "Real")
    assert {variable.variability for variable in fmu.variables("input", "Real")} == {"continuous"}


def test_what_is_set_has_a_start_value(fmu: Fmu) -> None:
    for variable in fmu.variables():
        if variable.causality == "calculatedParameter":
            assert (variable.start, variable.initial) == (None, "calculated"), variable.name
        else:
            assert variable.start is not None, variable.name


def test_every_unit_is_defined_with_its_display_unit(fmu: Fmu) -> None:
    units = {unit.attrib["name"]: unit for unit in elements(fmu, "UnitDefinitions/Unit")}
    used = [variable for variable in fmu.variables(kind="Real") if variable.unit is not None]
    assert used
    for variable in used:
        shown = {display.attrib["name"] for display in units[variable.unit].iter("DisplayUnit")}
        assert variable.displayUnit is None or variable.displayUnit in shown, variable.name
    for unit in units.values():
        assert unit.find("BaseUnit") is not None
        assert all(float(display.attrib["factor"]) != 0 for display in unit.iter("DisplayUnit"))


def test_every_variable_is_described(fmu: Fmu) -> None:
    for variable in fmu.variables():
        assert variable.description, variable.name
        if variable.type == "Enumeration":
            assert [int(item.value) for item in variable.declaredType.items] == list(
                range(1, len(variable.declaredType.items) + 1)
            )


@pytest.mark.parametrize(
    ("group", "causality"), [("Outputs", "output"), ("InitialUnknowns", "calculatedParameter")]
)
def test_the_structure_is_complete(fmu: Fmu, group: str, causality: str) -> None:
    names = [variable.name for variable in fmu.variables()]
    listed = [
        names[int(unknown.attrib["index"]) - 1]
        for unknown in elements(fmu, f"ModelStructure/{group}/Unknown")
    ]
    assert listed == [variable.name for variable in fmu.variables(causality)]


def test_the_documentation_is_well_formed_and_lists_every_variable(fmu: Fmu) -> None:
    page = ElementTree.fromstring(read(fmu, "documentation/index.html"))
    cells = {"".join(cell.itertext()) for cell in page.iter("td")}
    for variable in fmu.variables():
        array = re.sub(r"\[\d+]$", "", variable.name)
        listed = variable.name in cells or any(
            re.fullmatch(rf"{re.escape(array)}\[1\.\.\d+]", cell) for cell in cells
        )
        assert listed, f"`{variable.name}` is not in the documentation"
        assert variable.description in cells
    for category in elements(fmu, "LogCategories/Category"):
        assert category.attrib["name"] in cells


def test_paths_in_the_file_are_plain(fmu: Fmu) -> None:
    with zipfile.ZipFile(fmu.file) as archive:
        assert archive.testzip() is None
        for entry in archive.infolist():
            assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
            assert not set("\\:") & set(entry.orig_filename)
            assert ".." not in entry.orig_filename
