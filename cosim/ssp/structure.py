"""The texts of a package: `SystemStructure.ssd`, and the parameter sets of its components."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, register_namespace, tostring

from cosim.fmu.description import FmuFile
from cosim.fmu.values import expand
from cosim.loop.wires.connect import PLANT
from cosim.scenario.model import FmuChoice, Scenario
from cosim.ssp.ports import Ports

SPACES = {
    kind: f"http://ssp-standard.org/SSP1/SystemStructure{name}"
    for kind, name in [("ssd", "Description"), ("ssc", "Common"), ("ssv", "ParameterValues")]
} | {
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
}
FMU_TYPE = "application/x-fmu-sharedlibrary"
SET = "initialValues"
"""Name of the parameter sets, which selects them in Ecos."""
BASE = dict.fromkeys(("kg", "m", "s", "A", "K", "mol", "cd", "rad"), 0) | {"factor": 1.0, "offset": 0.0}
"""Attributes of a base unit, and their defaults."""


def system(
    scenario: Scenario, ports: Ports, descriptions: Mapping[str, Any], surroundings: Iterable[Any]
) -> str:
    """Return the system structure description.

    `descriptions` are the model descriptions of the FMUs by their names in the scenario, `surroundings` the
    variables of the FMU of the surroundings, the component `plant`.
    """
    name = scenario.name.replace("/", "_") or "loop"
    root = Element(named("ssd:SystemStructureDescription"), {"version": "1.0", "name": name})
    top = sub(root, "ssd:System", name=name, description=scenario.title)
    elements = sub(top, "ssd:Elements")
    component(elements, PLANT, surroundings)
    connectors = {
        choice.name: [v for v in descriptions[choice.name].modelVariables if connects(choice.name, v, ports)]
        for choice in scenario.fmus
    }
    for owner, variables in connectors.items():
        component(elements, owner, variables)
    connect(sub(top, "ssd:Connections"), ports)
    # the step, as OMSimulator keeps it
    oms = sub(sub(sub(top, "ssd:Annotations"), "ssc:Annotation", type="org.openmodelica"), "oms:Annotations")
    oms = sub(oms, "oms:SimulationInformation")
    sub(oms, "oms:FixedStepMaster", description="oms-ma", stepSize=scenario.loop.step)
    enumerate_items(root, connectors)
    define_units(root, descriptions.values())
    experiment = sub(root, "ssd:DefaultExperiment", startTime=0.0, stopTime=scenario.loop.duration)
    # in SSP 1.0 the step is only an annotation; this is that of libcosim
    osp = sub(sub(experiment, "ssd:Annotations"), "ssc:Annotation", type="com.opensimulationplatform")
    sub(sub(osp, "osp:Algorithm"), "osp:FixedStepAlgorithm", baseStepSize=scenario.loop.step)
    return text(root)


def connects(owner: str, variable: Any, ports: Ports) -> bool:
    """Whether a variable of an FMU has a connector.

    Texts have none: masters cannot connect them, and OMSimulator rejects the file. Inputs and enumerations
    have one only if connected: FMPy gives an undriven input the value of another input, libcosim ends the
    process at an enumeration, and Ecos does not support them.
    """
    if variable.causality not in ("input", "output") or variable.type == "String":
        return False
    if variable.causality == "output" and variable.type != "Enumeration":
        return True
    ends = {port.name for port in (*ports.driven, *ports.commanding)}
    ends |= {end for wire in ports.direct for end in (wire.source, wire.to)}
    return f"{owner}.{variable.name}" in ends


def component(parent: Element, name: str, variables: Iterable[Any]) -> None:
    """Append a component with a connector for each of these inputs and outputs, and its parameter set."""
    made = sub(parent, "ssd:Component", name=name, type=FMU_TYPE, source=f"resources/{name}.fmu")
    # by events a command would act a step sooner than `io_delay` says
    made.set("implementation", "CoSimulation")
    connectors = sub(made, "ssd:Connectors")
    for variable in variables:
        if variable.causality not in ("input", "output"):
            continue
        end = sub(connectors, "ssd:Connector", name=variable.name, kind=variable.causality)
        made_type = sub(end, f"ssc:{variable.type}")
        if variable.type == "Real" and variable.unit:
            made_type.set("unit", variable.unit)
        if variable.type == "Enumeration":
            made_type.set("name", f"{name}.{variable.declaredType.name}")
    bindings = sub(made, "ssd:ParameterBindings")
    sub(bindings, "ssd:ParameterBinding", source=f"resources/{name}.ssv")


def connect(connections: Element, ports: Ports) -> None:
    """Append the connections."""

    def add(start: tuple[str, str], end: tuple[str, str]) -> Element:
        ends = {"startElement": start[0], "startConnector": start[1]}
        return sub(connections, "ssd:Connection", **ends, endElement=end[0], endConnector=end[1])

    for port in ports.driven:
        add((PLANT, port.name), (port.owner, port.variable.name))
    for port in ports.commanding:
        add((port.owner, port.variable.name), (PLANT, port.name))
    for wire in ports.direct:
        (source, _, output), (target, _, taken) = wire.source.partition("."), wire.to.partition(".")
        made = add((source, output), (target, taken))
        # as in the harness: a value is passed as its number
        made.set("suppressUnitConversion", "true")
        if (wire.scale, wire.offset) != (1.0, 0.0):
            sub(made, "ssc:LinearTransformation", factor=wire.scale, offset=wire.offset)


def enumerate_items(root: Element, connectors: Mapping[str, Iterable[Any]]) -> None:
    """Append the enumerations of the connectors, under the names of their FMUs."""
    used = {
        f"{name}.{variable.declaredType.name}": variable.declaredType.items
        for name, variables in connectors.items()
        for variable in variables
        if variable.type == "Enumeration"
    }
    if used:
        made = sub(root, "ssd:Enumerations")
        for name, items in used.items():
            enumeration = sub(made, "ssc:Enumeration", name=name)
            for item in items:
                sub(enumeration, "ssc:Item", name=item.name, value=item.value)


def define_units(root: Element, descriptions: Iterable[Any]) -> None:
    """Append the units of the FMUs."""
    known = {unit.name: unit.baseUnit for one in descriptions for unit in one.unitDefinitions}
    if known:
        made = sub(root, "ssd:Units")
        for name, base in known.items():
            given = {key: getattr(base, key, None) for key in BASE}
            kept = {key: value for key, value in given.items() if value not in (None, BASE[key])}
            sub(sub(made, "ssc:Unit", name=name), "ssc:BaseUnit", **kept)


def parameter_set(choice: FmuChoice, file: FmuFile, ports: Ports) -> str:
    """Return the parameter set of an FMU: parameters of the scenario and constant inputs."""
    given = expand(file.variables, choice.parameters | ports.starts(choice.name))
    # the items of enumerations by name
    items: dict[Any, str] = {(one.name, number): item for one, _ in given for item, number in one.items}
    return values((one.name, one.kind, items.get((one.name, value)) or value) for one, value in given)


def values(parameters: Iterable[tuple[str, str, Any]]) -> str:
    """Return a parameter set: names, types and values."""
    root = Element(named("ssv:ParameterSet"), {"version": "1.0", "name": SET})
    made = sub(root, "ssv:Parameters")
    for parameter, kind, value in parameters:
        shown = str(value).lower() if kind == "Boolean" else value
        sub(sub(made, "ssv:Parameter", name=parameter), f"ssv:{kind}", value=shown)
    return text(root)


def named(tag: str) -> str:
    """Name of a tag with its name space."""
    space, _, name = tag.partition(":")
    return f"{{{SPACES[space]}}}{name}"


def sub(parent: Element, tag: str, **attributes: Any) -> Element:
    """Append an element."""
    return SubElement(parent, named(tag), {key: str(value) for key, value in attributes.items()})


def text(root: Element) -> str:
    """Return a document as text."""
    for prefix, space in SPACES.items():
        register_namespace(prefix, space)
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'
