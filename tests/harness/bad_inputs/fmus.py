"""FMU files with one defect each, built around the probe."""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy

from ..conftest import DATA

Build = Callable[[Path, bytes], None]
"""Writes an FMU, given the library with the defects."""

PLATFORM = f"binaries/{fmpy.platform}"
LIBRARY = f"{PLATFORM}/probe{fmpy.sharedLibraryExtension}"
XML = "modelDescription.xml"
UNIX = 3


def description(*edits: tuple[str, str]) -> str:
    """Model description of the probe with texts replaced, each of which must be there."""
    text = (DATA / "probe.xml").read_text()
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new)
    return text


def write(target: Path, members: dict[str, bytes | str]) -> None:
    """Write a zip file."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)


def edited(*edits: tuple[str, str]) -> Build:
    """FMU whose model description has another text in a place."""
    return lambda target, library: write(target, {XML: description(*edits), LIBRARY: library})


def described(content: bytes | str) -> Build:
    """FMU with this model description."""
    return lambda target, library: write(target, {XML: content, LIBRARY: library})


def defect(name: str) -> Build:
    """FMU whose library has a defect, see `defects.c`."""
    return edited(("probe-guid", f"defect:{name}"))


def holding(members: dict[str, bytes | str]) -> Build:
    """FMU with additional files."""
    return lambda target, library: write(target, {XML: description(), LIBRARY: library, **members})


def files(members: dict[str, bytes | str]) -> Build:
    """Zip file with these files alone."""
    return lambda target, library: write(target, members)


def raw(content: bytes) -> Build:
    """File that is no zip file."""

    def build(target: Path, library: bytes) -> None:
        target.write_bytes(content)

    return build


def patched(change: Callable[[bytes], bytes]) -> Build:
    """Sound FMU whose bytes are changed afterwards."""

    def build(target: Path, library: bytes) -> None:
        write(target, {XML: description(), LIBRARY: library})
        target.write_bytes(change(target.read_bytes()))

    return build


def with_library(change: Callable[[bytes], bytes]) -> Build:
    """FMU whose library is changed."""
    return lambda target, library: write(target, {XML: description(), LIBRARY: change(library)})


def flagged(flags: int, method: int = 0) -> Build:
    """FMU whose list of files claims other flags and another compression of the model description."""

    def change(content: bytes) -> bytes:
        changed = bytearray(content)
        for signature, place in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
            at = content.index(signature) + place
            old_flags, old_method = struct.unpack_from("<HH", content, at)
            struct.pack_into("<HH", changed, at, old_flags | flags, method or old_method)
        return bytes(changed)

    return patched(change)


def flipped(content: bytes) -> bytes:
    """Content with wrong bytes in the middle of the compressed model description."""
    start = content.index(XML.encode()) + len(XML) + 200
    return content[:start] + bytes(255 - byte for byte in content[start : start + 60]) + content[start + 60 :]


def linked(target: Path, library: bytes) -> None:
    """FMU with a symbolic link out of it."""
    link = zipfile.ZipInfo("resources/link")
    link.create_system, link.external_attr = UNIX, 0o120777 << 16
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr(XML, description())
        archive.writestr(LIBRARY, library)
        archive.writestr(link, "/etc")


def bomb(target: Path, library: bytes) -> None:
    """FMU that unpacks to 300 times its size."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(XML, description())
        archive.writestr(LIBRARY, library)
        with archive.open("resources/zeros", "w", force_zip64=True) as file:
            for _ in range(300):
                file.write(bytes(1_000_000))


LAUGHS = (
    '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa">'
    + "".join(
        f'<!ENTITY {name} "{f"&{inner};" * 40}">' for inner, name in zip("abcdef", "bcdefg", strict=True)
    )
    + ']><fmiModelDescription fmiVersion="2.0">&g;</fmiModelDescription>'
)
OUTSIDE = '<!DOCTYPE x [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
HEAD = '<?xml version="1.0" encoding="UTF-8"?>'
GAIN = '<Real start="1" max="10"/>'
OUTPUT = '<ScalarVariable name="sum" valueReference="5" causality="output"><Real/></ScalarVariable>'
IN_ORDER = description()[
    description().index("  <ModelVariables>") : description().index("  <ModelStructure>")
]


def identifier(name: str) -> Build:
    """FMU that asks for a library of this name."""
    return edited(('modelIdentifier="probe"', f'modelIdentifier="{name}"'))


FILES: dict[str, tuple[Build, tuple[str, ...]]] = {
    # the reference defects: files
    "no binary": (
        files({XML: description(), "sources/a.c": ""}),
        ("no binary for this platform", "`c-code`"),
    ),
    "XML not well-formed": (described(description()[:-30]), ("not valid", "line ")),
    "duplicate names": (edited(('name="sum"', 'name="out"')), ("not valid", '"out"', "is not unique")),
    "wrong identifier": (identifier("Nope"), (f"`{PLATFORM}/Nope.so`", "`probe.so`")),
    "no model description": (files({LIBRARY: b""}), ("holds no `modelDescription.xml`", LIBRARY)),
    "library cut off": (with_library(lambda b: b[: len(b) // 2]), (LIBRARY, "is truncated")),
    "not a zip": (raw(b"hello, this is a text"), ("is not an FMU", "not a zip file")),
    # the reference defects: calls
    "wrong GUID": (edited(("probe-guid", "other")), ("cannot instantiate", "wrong GUID")),
    "step error": (defect("step_error"), ("step 3", "doStep failed on purpose", "fmi2Error")),
    "instantiate gives nothing": (defect("instantiate_null"), ("cannot instantiate", "`Probe`")),
    "NaN": (defect("nan"), ("`controller.out` is `nan`", "step 3")),
    "initialization error": (defect("init_error"), ("init failed on purpose", "fmi2ExitInitializationMode")),
    "step discard": (defect("step_discard"), ("step 3", "fmi2DoStep returned fmi2Discard")),
    "step fatal": (defect("step_fatal"), ("step 3", "fmi2DoStep returned fmi2Fatal")),
    # zip files
    "empty file": (raw(b""), ("is not an FMU", "it is empty")),
    "empty zip": (files({}), ("holds no `modelDescription.xml`", "it is empty")),
    "zip cut off": (patched(lambda b: b[:-200]), ("is not an FMU", "truncated")),
    "bad sum": (patched(flipped), ("is damaged", "`modelDescription.xml` cannot be unpacked")),
    "encrypted": (flagged(1), ("`modelDescription.xml`", "is encrypted")),
    "other method": (flagged(0, 99), ("`modelDescription.xml`", "method 99")),
    "path upwards": (holding({"../../x": "x"}), ("`../../x`", "leaves the folder of the FMU")),
    "absolute path": (holding({"/tmp_x": "x"}), ("`/tmp_x`", "absolute path")),
    "drive": (holding({"C:x": "x"}), ("`C:x`", "absolute path")),
    "backslash": (holding({"a\\b": "x"}), ("backslash", "forward slashes")),
    "control character": (holding({"a\x1b[31mb": "x"}), ("control character",)),
    "symbolic link": (linked, ("`resources/link`", "symbolic link")),
    "file and folder": (holding({"binaries": "x"}), ("`binaries`", "both a file and a folder")),
    "bomb": (bomb, ("unpacks to 300 MB", "the limit is 100 times")),
    "two FMUs in one": (
        files({"a.fmu/modelDescription.xml": "x", "b.fmu/x": ""}),
        ("holds no `modelDescription.xml`", "`a.fmu/modelDescription.xml`"),
    ),
    # model descriptions
    "not UTF-8": (
        described(description().encode().replace(b"Probe for", b"\xff\xfe\xff for")),
        ("not valid",),
    ),
    "billion laughs": (described(LAUGHS), ("not valid",)),
    "external entity": (
        described(description((HEAD, HEAD + OUTSIDE), ("hello", "&x;"))),
        ("not valid", "'x'"),
    ),
    "other root": (described("<fmiBuildDescription fmiVersion='2.0'/>"), ("`fmiBuildDescription`",)),
    "no version": (edited((' fmiVersion="2.0"', "")), ("without `fmiVersion`",)),
    "FMI 1": (edited(('fmiVersion="2.0"', 'fmiVersion="1.0"')), ("FMI 1.0 FMU", "only FMI 2.0")),
    "FMI 4": (
        edited(('fmiVersion="2.0"', 'fmiVersion="4.0"')),
        ("FMI 4.0 FMU", "Export it as FMI 2.0 or 3.0."),
    ),
    "FMI 3 in name only": (edited(('fmiVersion="2.0"', 'fmiVersion="3.0"')), ("no binary", "x86_64")),
    "model exchange": (
        edited(("<CoSimulation", "<ModelExchange"), ('canHandleVariableCommunicationStepSize="true"', "")),
        ("offers only ModelExchange",),
    ),
    "duplicate item": (edited(('name="Slow" value="2"', 'name="Off" value="2"')), ("not valid", "Off")),
    "no such type": (edited(('declaredType="Mode" start', 'declaredType="No" start')), ("not valid", '"No"')),
    "start is not a number": (edited((GAIN, '<Real start="abc"/>')), ("not valid", "'abc'")),
    "reference too big": (
        edited(('"clock.time" valueReference="6"', '"clock.time" valueReference="99999999999"')),
        ("not valid", "99999999999"),
    ),
    "reference negative": (
        edited(('"clock.time" valueReference="6"', '"clock.time" valueReference="-1"')),
        ("not valid", "-1"),
    ),
    "bad causality": (edited(('causality="parameter"', 'causality="parametr"')), ("'parametr'",)),
    "bad combination": (
        edited(('causality="parameter" variability="tunable"', 'causality="parameter"')),
        ("not valid", '"gain"', "illegal combination"),
    ),
    "no type": (edited((OUTPUT, OUTPUT.replace("<Real/>", ""))), ("not valid", "ScalarVariable")),
    "identifier upwards": (identifier("../../../x"), ("`modelIdentifier` is `../../../x`",)),
    "identifier absolute": (identifier("/tmp/x"), ("`modelIdentifier` is `/tmp/x`",)),
    "identifier backslash": (identifier("..\\x"), ("`modelIdentifier` is `..\\x`",)),
    "identifier dots": (identifier(".."), ("`modelIdentifier` is `..`",)),
    # libraries
    "library empty": (with_library(lambda b: b""), (LIBRARY, "is empty")),
    "library is a text": (with_library(lambda b: b"x" * 5000), (LIBRARY, "is not a Linux library")),
    "library header only": (with_library(lambda b: b[:64]), (LIBRARY, "is truncated")),
    "library without last page": (with_library(lambda b: b[: len(b) * 3 // 5]), (LIBRARY, "is truncated")),
    "library of another machine": (
        with_library(lambda b: b[:18] + struct.pack("<H", 183) + b[20:]),
        ("cannot load the library", "probe.so"),
    ),
    "step pending": (defect("step_pending"), ("fmi2DoStep returned fmi2Pending",)),
    "status unknown": (defect("step_77"), ("fmi2DoStep returned 77",)),
    "message of bytes": (defect("log_bytes"), ("100%", "red [/red]", "end (fmi2DoStep")),
    "message of a megabyte": (defect("log_long"), ("AAAA...", "fmi2DoStep")),
    "output not known": (
        edited(('"clock.time" valueReference="6"', '"clock.time" valueReference="77"')),
        ("cannot read the outputs of the FMU: there is no such value reference", "fmi2GetReal"),
    ),
}
"""Each defect: how it is made, and what the message must say."""
WARNED: dict[str, tuple[Build, tuple[str, ...]]] = {
    "bad attribute": (edited(("<Real/>", '<Real wrong="1"/>')), ("no run needs", "'wrong'", "not allowed")),
    "wrong order": (
        edited((IN_ORDER, ""), ("</ModelStructure>", f"</ModelStructure>{IN_ORDER}")),
        ("no run needs", "ModelStructure", "ModelVariables"),
    ),
    "missing start": (edited((GAIN, '<Real max="10"/>')), ('"gain"', "has no start value")),
    "undefined unit": (
        edited((GAIN, '<Real unit="furlong" displayUnit="mile" start="1"/>')),
        ("no run needs", "furlong"),
    ),
    "start of a result": (
        edited((OUTPUT, OUTPUT.replace("<Real/>", '<Real start="0"/>'))),
        ("no run needs", '"sum"', 'initial="calculated" but provides a start value'),
    ),
    "start of the independent variable": (
        edited((OUTPUT, OUTPUT.replace("output", "independent").replace("<Real/>", '<Real start="0"/>'))),
        ("no run needs", '"sum"', "provides a start value"),
    ),
    "date": (
        edited((' guid="probe', ' generationDateAndTime="1.2.2026" guid="probe')),
        ("no run needs", "generationDateAndTime"),
    ),
    "output not in structure": (edited(('<Unknown index="6"/>', "")), ("ModelStructure", "Outputs")),
    "parameter not known": (
        edited(('name="bias[2]" valueReference="3"', 'name="bias[2]" valueReference="99"')),
        ("does not know its variable `bias[2]` (value reference 99)", "there is no such value reference"),
    ),
    "terminate error": (
        defect("terminate_error"),
        ("cannot terminate `Probe`", "terminate failed on purpose", "fmi2Terminate returned fmi2Error"),
    ),
    "terminate fatal": (defect("terminate_fatal"), ("cannot terminate `Probe`", "returned fmi2Fatal")),
    "no item of its enumeration": (
        defect("item"),
        ("`controller.mode_out` is `77` at t = 0.003 s, which is not one of its items: `1` Off, `2` Slow",),
    ),
    "another version": (defect("version_3"), ("`broken.fmu`: `fmi2GetVersion` returns `3.0`, not `2.0`",)),
    "version is null": (defect("version_null"), ("`fmi2GetVersion` returns nothing",)),
    "another platform": (defect("platform"), ("`fmi2GetTypesPlatform` returns `nonsense`, not `default`",)),
}
"""Defects that hinder no run: it is done, with a warning."""
CRASHES = (
    "segfault",
    "abort",
    "bus_error",
    "exit",
    "exit_now",
    "init_segfault",
    "exit_in_instantiate",
    "heap",
)
"""Defects of the library that end the process."""
