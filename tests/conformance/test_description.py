"""The text side of an FMU: schema, FMPy's rules, units, structure, documentation."""

from __future__ import annotations

import csv
import ctypes
import io
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
from collections import Counter
from itertools import pairwise
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from .conftest import NAMES, PROBE, ROOT, Fmu, generated_files
from .replay import instance, put

SCHEMA = Path(fmpy.__file__).parent / "schema/fmi2/fmi2ModelDescription.xsd"
INPUTS, OUTPUTS, PARAMETERS, DESCRIPTION = 16, {"fmu-deburr": 16}, 45, 90
"""Limits of STYLE.md; an FMU that is not listed has at most 12 outputs."""


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


@pytest.mark.client("FMPy", "validates the description")
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
        # a packer adds its texts at the marks in the page of the library, and removes nothing else
        parts = re.split(r"<!-- [a-z ]+ -->\n?", text) if path.endswith(".html") else [text]
        rest = read(fmu, path)
        assert rest.startswith(parts[0])
        assert rest.endswith(parts[-1])
        for part in parts:
            assert part in rest
            rest = rest.partition(part)[2]
        if len(parts) == 1:
            assert rest == ""


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


def test_ports_and_visible_parameters_are_few(fmu: Fmu) -> None:
    names = [v.name for v in fmu.variables("parameter") if not v.name.startswith("expert.")]
    assert len(fmu.variables("input")) <= INPUTS
    assert len(fmu.variables("output")) <= OUTPUTS.get(fmu.file.stem, 12)
    assert len(names) <= PARAMETERS, names


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
        assert len(variable.description) <= DESCRIPTION, variable.name
        assert fmu.file.stem == PROBE or "`" not in variable.description, variable.name
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
        assert variable.description.replace("`", "") in cells
    # what a text of the declaration sets between backticks is code in the page
    declared = [
        cell for table in page.iter("table") if "declared" in table.get("class", "") for cell in table
    ]
    assert "`" not in "".join("".join(row.itertext()) for row in declared)
    # it needs nothing from outside of its folder
    assert not [element for element in page.iter() if element.tag in ("script", "link")]
    with zipfile.ZipFile(fmu.file) as archive:
        packed = {name.removeprefix("documentation/") for name in archive.namelist()}
    assert {element.get("src") for element in page.iter() if element.get("src")} <= packed
    ids = {element.get("id") for element in page.iter()}
    for link in page.iter("a"):
        target = link.get("href", "")
        assert not target.startswith("#") or target[1:] in ids, f"`{target}` leads nowhere"
    for category in elements(fmu, "LogCategories/Category"):
        assert category.attrib["name"] in cells
    # a struct of the declaration says what its parameters are about
    reported = {
        "".join(head.itertext()): "".join(text.itertext())
        for part in page.iter()
        for head, text in pairwise(part)
        if (head.tag, text.tag) == ("h3", "p")
    }
    assert reported.get("limits", "").endswith("."), reported


def test_the_block_shows_every_port_or_its_large_group(fmu: Fmu) -> None:
    page = ElementTree.fromstring(read(fmu, "documentation/index.html"))
    (block,) = [part for part in page.iter() if part.get("aria-label") == "Inputs and outputs"]
    _, *shown = ["".join(text.itertext()) for text in block.iter() if text.tag == "text"]
    expected: list[str] = []
    for causality in ("input", "output"):
        # an array is one port
        names = dict.fromkeys(re.sub(r"\[\d+]$", "", variable.name) for variable in fmu.variables(causality))
        groups = Counter(name.partition(".")[0] for name in names if "." in name)
        large = {group: f"{group}.* {count} {causality}s" for group, count in groups.items() if count > 4}
        expected += dict.fromkeys(large.get(name.partition(".")[0], name) for name in names)
    found = [port if ".*" in port else re.sub(r"(\[1\.\.\d+])?( .*)?$", "", port) for port in shown]
    assert found == expected


def test_the_page_names_nothing_that_is_not_in_the_fmu(fmu: Fmu) -> None:
    page = ElementTree.fromstring(read(fmu, "documentation/index.html"))
    for part in [*page.iter("pre")]:
        part.clear()
    text = "\n".join(page.itertext())
    assert "`" not in text
    found = re.findall(r"[\w*/-]+\.(?:py|rs|md)\b|\b(?:cargo|pytest|cosim|python -m) .*", text)
    assert not [name for name in found if not (fmu.folder / "documentation" / name).is_file()]
    names = [name.rstrip(".") for name in re.findall(r"[\w.*-]+(?:/[\w.*-]+)+", text)]
    folders = (ROOT, ROOT / fmu.file.stem)
    packed = [name for name in names if (fmu.folder / name).exists()]
    assert not [name for name in names if name not in packed and any([*f.glob(name)] for f in folders)]


def test_the_page_shows_how_to_wire_and_to_set_up(fmu: Fmu) -> None:
    if fmu.file.stem == PROBE:
        pytest.skip("the probe has no guide")
    page = ElementTree.fromstring(read(fmu, "documentation/index.html"))
    titles = ["".join(title.itertext()) for title in page.iter("h2")]
    assert {"Before anything moves", "On the machine"} <= set(titles)
    (wires,) = [
        [[*row] for row in table.iter("tr")]
        for table in page.iter("table")
        if [cell.text for cell in table.iter("th")] == ["port", "on the machine", "unit", "delay"]
    ]
    known = {v.name: v.unit or "-" for v in [*fmu.variables("input"), *fmu.variables("output")]}
    named = set()
    for name, _, unit, _ in (row for row in wires if row[0].tag == "td"):
        ports = ["".join(port.itertext()) for port in name.iter("code")]
        units = [known.get(port) for port in ports]
        # a unit of several ports may be given once
        assert (unit.text or "").split(", ") in (units, [*dict.fromkeys(units)]), ports
        named |= set(ports)
    assert {*(v.name for v in fmu.variables("input")), "drive_enable"} <= named


def test_paths_in_the_file_are_plain(fmu: Fmu) -> None:
    with zipfile.ZipFile(fmu.file) as archive:
        assert archive.testzip() is None
        for entry in archive.infolist():
            assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
            assert not set("\\:") & set(entry.orig_filename)
            assert ".." not in entry.orig_filename


FMI3_SCHEMAS = Path(fmpy.__file__).parent / "schema/fmi3"


def packed(fmu: Fmu) -> None:
    """Skip what only the packer adds for the probe, which is packed here."""
    if fmu.file.stem == PROBE:
        pytest.skip("the probe is packed without pictures and runs")


def test_terminals_hold_every_input_and_output_once_and_the_icon_is_there(fmu: Fmu) -> None:
    packed(fmu)
    text = read(fmu, "terminalsAndIcons/terminalsAndIcons.xml").encode()
    etree.XMLSchema(etree.parse(FMI3_SCHEMAS / "fmi3TerminalsAndIcons.xsd")).assertValid(
        etree.fromstring(text)
    )
    terminals = ElementTree.fromstring(text).findall("Terminals/Terminal")
    members = [member.attrib["variableName"] for terminal in terminals for member in terminal]
    ports = [v.name for v in fmu.variables() if v.causality in ("input", "output")]
    assert sorted(members) == sorted(ports)
    assert len({terminal.attrib["name"] for terminal in terminals}) == len(terminals)
    with zipfile.ZipFile(fmu.file) as archive:
        picture = archive.read("model.png")
        assert picture == archive.read("terminalsAndIcons/icon.png")
    assert picture.startswith(b"\x89PNG\r\n")


# pattern of the schema of FMI-LS-REF 1.0.0-alpha.1
ROLE = re.compile(
    "document|requirement|specification|model|parameter|system|testcase"
    "|experiment(/(smoke-test|validation|uncertainty-analysis))?|result|method|rationale|report|request"
    "|delivery|configuration|signature|serialized-state(/.*)?|meta-data|other"
)


def test_the_reference_run_gives_what_it_says(fmu: Fmu) -> None:
    packed(fmu)
    folder = "extra/org.fmi-standard.fmi-ls-ref"
    related = ElementTree.fromstring(read(fmu, f"{folder}/fmi-ls-manifest.xml")).findall("Related")
    assert all(ROLE.fullmatch(element.attrib["role"]) for element in related)
    (file,) = (e.attrib["source"] for e in related if e.attrib["role"] == "experiment/smoke-test")
    (experiment,) = ElementTree.fromstring(read(fmu, f"{folder}/{file}")).findall("Experiment")
    sources = [element.attrib["source"] for element in experiment]
    assert [element.tag for element in experiment] == ["Stimuli", "References"]
    assert {element.attrib["source"] for element in related} == {file, *sources}
    stimuli, wanted = (list(csv.DictReader(io.StringIO(read(fmu, f"{folder}/{name}")))) for name in sources)
    step = float(experiment.attrib["stepSize"])
    assert len(stimuli) == len(wanted) == round(float(experiment.attrib["stopTime"]) / step) >= 100

    variables = {variable.name: variable for variable in fmu.variables()}
    bound = {
        name: float(experiment.attrib["tolerance"]) * max(abs(float(row[name])) for row in wanted)
        if variables[name].type == "Real"
        else 0.0
        for name in wanted[0].keys() - {"time"}
    }
    assert float(experiment.attrib["tolerance"]) <= 1e-8
    slave = instance(fmu.description, str(fmu.folder), {})
    for k, (row, results) in enumerate(zip(stimuli, wanted, strict=True)):
        for name in row.keys() - {"time"}:
            put(slave, variables[name], float(row[name]))
        slave.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
        for name in results.keys() - {"time"}:
            variable = variables[name]
            get = {"Real": slave.getReal, "Boolean": slave.getBoolean}.get(variable.type, slave.getInteger)
            got = get([variable.valueReference])[0]
            assert abs(got - float(results[name])) <= bound[name], (k, name)
    slave.freeInstance()
    # the run leaves the first state
    assert len({row["state"] for row in wanted}) > 1
