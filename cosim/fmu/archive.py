"""FMU files: checks, model description and extraction."""

from __future__ import annotations

import contextlib
import functools
import itertools
import lzma
import re
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import fmpy
from fmpy.validation import validate_model_description

from cosim import paths, renamed, units
from cosim.errors import FmuError
from cosim.fmu import members
from cosim.fmu.cache import extracted
from cosim.warned import warn_once

INTEGERS = ("Integer", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
BASE = {
    **dict.fromkeys(("Real", "Float32", "Float64"), "Real"),
    **dict.fromkeys((*INTEGERS, "Enumeration"), "Integer"),
    "Boolean": "Boolean",
    **dict.fromkeys(("String", "Binary", "Clock"), ""),
}
"""Kind of number of each type of FMI 2.0 and 3.0; empty for those that are no numbers."""
NUMBERS: dict[str, Callable[[str], object]] = {"Real": float, "Integer": int}
"""What reads start values and limits."""
MAX_PROBLEMS = 20
"""Maximum number of reported problems; a fault of the tool repeats for every variable."""


@dataclass(frozen=True)
class DisplayUnit:
    """Display unit: `factor` times the value in the unit of the variable, plus `offset`.

    A variable that is a difference (`relativeQuantity` of its declared type) has no offset.
    """

    name: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Variable:
    """One scalar variable of an FMU, or one element of an array of FMI 3.0.

    `kind` is the FMI type, such as Real, Float64 or Enumeration; `items` are the names and numbers of an
    enumeration. Texts are those of the model description, empty if not given. `settable` states whether it
    accepts a start value. `element` is its index in `array` in row-major order.
    """

    name: str
    reference: int
    kind: str
    causality: str
    variability: str
    description: str
    start: str
    unit: str
    minimum: str
    maximum: str
    items: tuple[tuple[str, int], ...] = ()
    display: DisplayUnit | None = None
    settable: bool = True
    array: str = ""
    element: int = 0

    @property
    def base(self) -> str:
        """Kind of number: Real, Integer or Boolean; empty if it is none."""
        return BASE[self.kind]


@dataclass(frozen=True)
class FmuFile:
    """A checked co-simulation FMU for this platform; `version` is the major version of FMI.

    `once` states that a process can instantiate it only once. `start_time` (s), `step_size` (s) and
    `tolerance` are those of its default experiment. `warning` names flaws of the model description.
    """

    path: Path
    folder: Path
    guid: str
    identifier: str
    name: str
    description: str
    variables: dict[str, Variable]
    version: int = 2
    once: bool = False
    start_time: float = 0.0
    step_size: float = 0.0
    tolerance: float | None = None
    warning: str = ""

    def named(self, causality: str) -> list[Variable]:
        """Return the variables of one causality in the order of the model description."""
        return [variable for variable in self.variables.values() if variable.causality == causality]

    def whole(self, variables: list[Variable]) -> list[Variable]:
        """Return variables with the other elements of their arrays, which FMI 3.0 transfers as a whole."""
        arrays = {variable.array for variable in variables} - {""}
        if not arrays:
            return variables
        names = {variable.name for variable in variables}
        return [one for one in self.variables.values() if one.name in names or one.array in arrays]


def open_fmu(path: Path) -> FmuFile:
    """Check an FMU file, read its description and extract it; each file is opened once in a process."""
    try:
        stat = path.stat()
    except OSError as error:
        raise unreadable(path, error) from None
    file = opened(path, stat.st_mtime_ns, stat.st_size, paths.cache_folder())
    if not file.folder.is_dir():
        opened.cache_clear()
        return open_fmu(path)
    if file.warning:
        warn_once(file.warning)
    return file


@functools.lru_cache(16)
def opened(path: Path, changed: int, size: int, cache: Path) -> FmuFile:
    """Open an FMU that was `changed` at this time."""
    shown = paths.shown(path)
    try:
        sizes = members.sizes(path)
        root = root_of(path, shown)
        version = check_interface(shown, root)
        check_platform(shown, version, sizes)
        description, warning = described(shown, path, root)
        drop_inverse(description, root)
        check_identifier(shown, description.coSimulation.modelIdentifier)
        folder = extracted(path, sizes, functools.partial(unpack, path))
        renamed.learn(folder)
    except OSError as error:
        raise unreadable(path, error) from None
    try:
        return replace(describe(path, folder, description), version=version, warning=warning)
    except (TypeError, ValueError) as error:  # a number that is none
        raise invalid(shown, *schema_flaws(root), *problems(error)) from None


def unreadable(path: Path, error: OSError) -> FmuError:
    """Error of a file that cannot be read."""
    problem = f"cannot read the FMU `{paths.shown(path)}`: {error.strerror or error}"
    return FmuError(problem, "Check the file and its permissions.")


@contextlib.contextmanager
def unpacking(path: Path, what: str) -> Iterator[zipfile.ZipFile]:
    """Open an FMU, and report the part of it that cannot be unpacked."""
    try:
        with zipfile.ZipFile(path) as archive:
            yield archive
    except (zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError, NotImplementedError) as error:
        problem = f"`{paths.shown(path)}` is damaged: {what} cannot be unpacked: {error}"
        raise FmuError(problem, members.AGAIN) from None


def unpack(path: Path, target: Path) -> None:
    """Unpack an FMU into a folder."""
    with unpacking(path, "a file in it") as archive:
        archive.extractall(target)


def root_of(path: Path, shown: str) -> Any:
    """Root of the model description of an FMU."""
    from lxml import etree

    with unpacking(path, f"`{members.DESCRIPTION}`") as archive:
        content = archive.read(members.DESCRIPTION)
    try:
        return etree.fromstring(content)
    except etree.XMLSyntaxError as error:
        raise invalid(shown, error.msg) from None


def check_interface(shown: str, root: Any) -> int:
    """Check that an FMU supports co-simulation; return the major version of FMI."""
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        what = f"its root is `{root.tag}`" + ("" if version else " without `fmiVersion`")
        raise FmuError(
            f"`{shown}` is not an FMU: its `{members.DESCRIPTION}` is not a model description, {what}",
            members.AGAIN,
        )
    if not re.fullmatch(r"2\.0|3\.\d+(\.\d+)?", version):
        problem = f"`{shown}` is an FMI {version} FMU, only FMI 2.0 and 3.0 are supported"
        raise FmuError(problem, "Export it as FMI 2.0 or 3.0.")
    interfaces = ("CoSimulation", "ModelExchange", "ScheduledExecution")
    kinds = [kind for kind in interfaces if root.find(kind) is not None]
    if "CoSimulation" not in kinds:
        raise FmuError(
            f"`{shown}` offers only {' and '.join(kinds) or 'nothing'}, not co-simulation",
            "Export it as a co-simulation FMU.",
        )
    return int(version[0])


def described(shown: str, path: Path, root: Any) -> tuple[Any, str]:
    """FMPy's model description, and a warning of flaws in what no run needs."""
    flaws = schema_flaws(root)
    try:
        with path.open("rb") as file:
            description = fmpy.read_model_description(file, validate=False)
    except OSError:
        raise
    except Exception as error:  # FMPy raises bare exceptions for a broken model description
        raise invalid(shown, *flaws, *problems(error)) from None
    try:
        flaws += validate_model_description(description, validate_model_structure=True)
    except Exception as error:  # FMPy fails at some flaws
        flaws += problems(error)
    if needed := missing(root):
        raise invalid(shown, *flaws, *needed)
    warning = f"the model description of `{shown}` has flaws that no run needs:{lines(flaws)}"
    return description, warning if flaws else ""


def drop_inverse(description: Any, root: Any) -> None:
    """Remove display units of FMI 3.0 that show the reciprocal of a value; FMPy does not distinguish them."""
    inverse = root.findall("UnitDefinitions/Unit/DisplayUnit[@inverse='true']")
    names = {(one.getparent().get("name"), one.get("name")) for one in inverse}
    for unit in description.unitDefinitions:
        unit.displayUnits = [one for one in unit.displayUnits if (unit.name, one.name) not in names]


@functools.cache
def schema(version: str) -> Any:
    """Return the XML schema of a major version of FMI."""
    from lxml import etree

    file = f"schema/fmi{version}/fmi{version}ModelDescription.xsd"
    return etree.XMLSchema(file=str(Path(fmpy.__file__).parent / file))


def schema_flaws(root: Any) -> list[str]:
    """Violations of the XML schema, as FMPy reports them."""
    rules = schema(root.get("fmiVersion")[0])
    rules.validate(root)
    return [
        f"{error.level_name} (line {error.line}, column {error.column}): {error.message}"
        for error in rules.error_log
    ]


def missing(root: Any) -> list[str]:
    """Flaws in what a run needs: identifiers, and name, reference, type and numbers of each variable."""
    found, names = [], set[str]()
    token = "guid" if root.get("fmiVersion") == "2.0" else "instantiationToken"
    if root.get(token) is None or root.find("CoSimulation").get("modelIdentifier") is None:
        found.append(f"It has no `{token}` or no `modelIdentifier`.")
    for variable in root.iterfind("ModelVariables/*"):
        name, reference = variable.get("name"), variable.get("valueReference", "")
        # the type is an element inside the variable in FMI 2.0, and the variable itself in FMI 3.0
        types = [one for one in (variable, *variable) if one.tag in BASE]
        for known in (name, *(alias.get("name") for alias in variable.iterfind("Alias"))):
            if not known or known in names:
                found.append(f'The variable name "{known}" (line {variable.sourceline}) is not unique.')
            names.add(known)
        if not (reference.isdecimal() and int(reference) < 2**32):
            found.append(f'The variable "{name}" has the value reference "{reference}".')
        if len(types) != 1:
            found.append(f'The variable "{name}" ({variable.tag}) has {len(types)} types.')
        texts = [(key, one.get(key)) for one in types for key in ("start", "min", "max") if one.get(key)]
        for key, text in texts:
            try:
                for number in text.split() if variable is types[0] else [text]:
                    NUMBERS.get(BASE[types[0].tag], str)(number)
            except ValueError:
                found.append(f"The variable \"{name}\" has the {key} '{text}'.")
    return found


def lines(found: Iterable[object]) -> str:
    """Problems in a line each; the first `MAX_PROBLEMS` of them."""
    texts = [f"\n  {problem}" for problem in dict.fromkeys(found)]
    more = len(texts) - MAX_PROBLEMS
    return "".join(texts[:MAX_PROBLEMS]) + (f"\n  and {more} more" if more > 0 else "")


def invalid(shown: str, *found: object) -> FmuError:
    """Error of a model description, with all messages of the parser or of FMPy."""
    return FmuError(
        f"the model description of `{shown}` is not valid:{lines(found)}",
        f"List all problems with `fmpy validate {shown}`.",
    )


def check_identifier(shown: str, identifier: str) -> None:
    """Check that the name of the library is a plain name without a path."""
    if not re.fullmatch(r"[^\\/:\x00-\x1f]+", identifier) or identifier.startswith("."):
        raise FmuError(
            f"`{shown}`: its `modelIdentifier` is `{paths.brief(identifier)}`, "
            "it must be the plain name of a library",
            members.AGAIN,
        )


def binaries(version: int) -> str:
    """Folder of the libraries for this machine in an FMU of a major version of FMI."""
    return f"binaries/{fmpy.platform if version == 2 else fmpy.platform_tuple}"


def check_platform(shown: str, version: int, files: Iterable[str]) -> None:
    """Check that there is a binary for this machine."""
    wanted, folders = binaries(version), {name.rpartition("/")[0] for name in files}
    if wanted not in folders:
        platforms = sorted(name.partition("/")[2] for name in folders if re.fullmatch("binaries/[^/]+", name))
        sources = ["c-code"] if any(re.fullmatch(r"sources/[^/]+\.c", name) for name in files) else []
        has = ", ".join(f"`{name}`" for name in sources + platforms) or "none at all"
        raise FmuError(
            f"`{shown}` has no binary for this platform, `{wanted.partition('/')[2]}`; it has {has}",
            "Build it on this machine, or request an FMU for this platform.",
        )


def describe(path: Path, folder: Path, description: Any) -> FmuFile:
    """Extract the required data of FMPy's model description."""
    displays = {
        (unit.name, display.name): DisplayUnit(display.name, float(display.factor), float(display.offset))
        for unit in description.unitDefinitions
        for display in unit.displayUnits
    }

    def experiment(name: str) -> float | None:
        text = getattr(description.defaultExperiment, name, None)
        return None if text is None else float(text)

    known = units.of_fmu(description.unitDefinitions)
    variables = [one for found in description.modelVariables for one in scalars(found, displays, known)]
    return FmuFile(
        path=path,
        folder=folder,
        guid=description.guid,
        identifier=description.coSimulation.modelIdentifier,
        name=description.modelName,
        description=description.description or "",
        variables={variable.name: variable for variable in variables},
        once=bool(description.coSimulation.canBeInstantiatedOnlyOncePerProcess),
        start_time=experiment("startTime") or 0.0,
        step_size=experiment("stepSize") or 0.0,
        tolerance=experiment("tolerance"),
    )


def scalars(
    variable: Any, displays: dict[tuple[str, str], DisplayUnit], known: dict[str, units.Definition]
) -> Iterator[Variable]:
    """Variable from that of FMPy, or the elements of an array; its type can be a declared type."""
    declared = variable.declaredType

    def attribute(name: str) -> str:
        own = getattr(variable, name)
        return str(own or (getattr(declared, name, None) if declared else None) or "")

    display = displays.get((attribute("unit"), attribute("displayUnit")))
    if attribute("relativeQuantity"):
        display = display and replace(display, offset=0.0)
        known = units.relative(known)
    exact = variable.variability != "constant" and variable.initial in ("exact", "approx")
    # a size is set in Configuration Mode, which is not used; FMPy reads only the first text of an array
    texts = variable.type == "String" and variable.shape
    unsupported = texts or variable.causality == "structuralParameter" or variable.type in ("Binary", "Clock")
    whole = Variable(
        name=variable.name,
        reference=variable.valueReference,
        kind=variable.type,
        # an alias of an input is no other input to drive
        causality="local" if variable.alias and variable.causality == "input" else variable.causality,
        variability=variable.variability or "continuous",
        description=variable.description or "",
        start=variable.start or "",
        unit=units.Unit(attribute("unit"), known),
        minimum=attribute("min"),
        maximum=attribute("max"),
        items=items_of(variable.name, declared),
        display=display,
        settable=exact and not unsupported,
    )
    if not variable.shape:
        yield whole
        return
    indices = list(itertools.product(*(range(1, size + 1) for size in variable.shape)))
    starts = whole.start.split() if whole.base else [whole.start]
    if len(starts) <= 1:
        # one value is that of all elements
        starts = (starts or [""]) * len(indices)
    if len(starts) != len(indices):
        problem = f"`{variable.name}` has {len(starts)} start values for {len(indices)} elements"
        raise FmuError(f"the model description is not valid: {problem}", members.AGAIN)
    for element, (index, start) in enumerate(zip(indices, starts, strict=True)):
        name = f"{variable.name}[{','.join(map(str, index))}]"
        yield replace(whole, name=name, start=start, array=variable.name, element=element)


def items_of(name: str, declared: Any) -> tuple[tuple[str, int], ...]:
    """Names and numbers of an enumeration, without duplicates."""
    items = tuple((item.name, int(item.value)) for item in (declared.items if declared else ()))
    for column in zip(*items, strict=True):
        twice = [entry for entry in column if column.count(entry) > 1]
        if twice:
            problem = f"the enumeration of `{name}` has the item `{twice[0]}` twice"
            raise FmuError(f"the model description is not valid: {problem}", members.AGAIN)
    return items


def problems(error: Exception) -> list[str]:
    """Problems in a model description found by FMPy or the parser, one line each."""
    found = getattr(error, "problems", None) or str(error).splitlines()
    if not found or (type(error).__module__ == "builtins" and type(error) is not Exception):
        # what Python itself says is no sentence without the name of the error
        found = [f"{type(error).__name__}: {error}"]
    return [str(problem) for problem in found]
