"""Checks of an FMU's library file: finds defects that would end the process on loading."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import fmpy

from cosim.errors import FmuError
from cosim.fmu.archive import binaries
from cosim.fmu.description import FmuFile
from cosim.fmu.messages import readable
from cosim.warned import warn_once

HEADER = struct.Struct("<4sBB10xHHIQQQIHHHHHH")
"""Header of a 64-bit ELF file."""
SEGMENT = struct.Struct("<IIQQQQQQ")
"""Entry of its table of segments."""
LITTLE_64 = (2, 1)
"""Class and byte order of the examined files."""


def check_library(file: FmuFile) -> None:
    """Check that the library of an extracted FMU is complete; loading a truncated one is a bus error."""
    binary, shown = binaries(file.version), file.path.name
    library = file.folder / binary / f"{file.identifier}{fmpy.sharedLibraryExtension}"
    if not library.is_file():
        there = ", ".join(f"`{path.name}`" for path in sorted((file.folder / binary).glob("*")))
        raise FmuError(
            f"`{shown}` has no library `{binary}/{library.name}`, which its `modelIdentifier` requires",
            f"`{binary}` holds {there or 'nothing'}.",
        )
    if fmpy.platform.startswith("linux") and (problem := elf_problem(library)):
        raise FmuError(f"`{shown}`: the library `{binary}/{library.name}` in it {problem}", "Build it again.")


def check_headers(slave: Any, answers: Mapping[str, bytes], shown: str) -> None:
    """Warn of a library that was not compiled with the headers whose functions give these answers."""
    for function, wanted in answers.items():
        reported: bytes | None = getattr(slave, function)()
        if reported != wanted:
            answer = "nothing" if reported is None else f"`{readable(reported)}`"
            warn_once(f"the library of `{shown}`: `{function}` returns {answer}, not `{wanted.decode()}`")


def elf_problem(library: Path) -> str:
    """Defect of an ELF file; empty if none was found."""
    size = library.stat().st_size
    with library.open("rb") as file:
        start = file.read(HEADER.size)
        if not start.startswith(b"\x7fELF"):
            return "is not a Linux library" if start else "is empty"
        if len(start) < HEADER.size:
            return f"is truncated after {size} bytes"
        header = HEADER.unpack(start)
        table, entry, count = header[7], header[11], header[12]
        if header[1:3] != LITTLE_64 or entry != SEGMENT.size:
            return ""
        file.seek(min(table, size))
        segments = file.read(count * entry)
    whole = segments[: len(segments) // entry * entry]
    needed = max(
        (begin + length for _, _, begin, _, _, length, _, _ in SEGMENT.iter_unpack(whole)), default=0
    )
    if len(segments) < count * entry or needed > size:
        return f"is truncated: it has {size} bytes, its header requires {max(needed, table + count * entry)}"
    return ""
