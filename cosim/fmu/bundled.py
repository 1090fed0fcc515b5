"""What an FMU brings into the process that loads it: an interpreter, Python modules, and libraries."""

from __future__ import annotations

import functools
import hashlib
import mmap
import re
import sys
from collections.abc import Iterable
from pathlib import Path

from cosim.fmu.archive import binaries
from cosim.fmu.members import DESCRIPTION

SCRIPT = "slavemodule.txt"
"""Resource that names the Python module of an FMU of PythonFMU and UniFMU."""
TOOLKITS = ("pythonfmu", "pythonfmu3")
"""Packages of PythonFMU; each of its FMUs brings a copy, any version serves the scripts of others."""
INTERPRETER = re.compile(rb"libpython\d|python3\d*\.dll|libjvm\.|\bjvm\.dll|libjulia", re.IGNORECASE)
"""Name of an interpreter in a library that is linked to it or loads it."""
TOOL = re.compile(rb"""needsExecutionTool\s*=\s*["'](true|1)["']""")


def libraries(folder: Path) -> list[Path]:
    """Library files of an extracted FMU for this platform."""
    places = (folder / binaries(version) for version in (2, 3))
    return [path for place in places for path in sorted(place.glob("*")) if path.is_file()]


def mentions(library: Path, pattern: re.Pattern[bytes]) -> bool:
    """Whether a library file holds a text."""
    if not library.stat().st_size:
        return False
    with library.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        return pattern.search(content) is not None


@functools.cache
def loads_interpreter(folder: Path) -> bool:
    """Whether an extracted FMU uses an interpreter or a tool, whose state outlives the instance."""
    return (
        (folder / "resources" / SCRIPT).is_file()
        or TOOL.search((folder / DESCRIPTION).read_bytes()) is not None
        or any(mentions(library, INTERPRETER) for library in libraries(folder))
    )


@functools.cache
def modules(folder: Path) -> dict[str, str]:
    """Python modules of an extracted FMU with a script, and the SHA-256 of each."""
    resources = folder / "resources"
    if not (resources / SCRIPT).is_file():
        return {}
    own = (path for path in resources.iterdir() if path.is_dir() or path.suffix == ".py")
    return {path.stem: sources(path) for path in own if path.name not in TOOLKITS}


def sources(module: Path) -> str:
    """SHA-256 of the file of a module, or of all modules of a package."""
    return digest(sorted(module.rglob("*.py")) if module.is_dir() else [module])


def foreign_module(folder: Path) -> str:
    """File of a module of this process that an FMU takes for its own; empty if there is none."""
    for name, wanted in modules(folder).items():
        file = Path(getattr(sys.modules.get(name), "__file__", None) or folder)
        module = file.parent if file.name == "__init__.py" else file
        if not file.is_relative_to(folder) and sources(module) != wanted:
            return str(file)
    return ""


@functools.cache
def brought(folder: Path, identifier: str) -> dict[str, str]:
    """SHA-256 of the files of an extracted FMU that its process looks up by name, not by path.

    These are Python modules, and libraries that other libraries of the FMU name. The process takes what has
    the name already, from whatever FMU.
    """
    found = {f"the Python module `{name}`": content for name, content in modules(folder).items()}
    own = libraries(folder)
    for library in (path for path in own if path.stem != identifier):
        name = re.compile(re.escape(library.name.encode()), re.IGNORECASE)
        if any(mentions(other, name) for other in own if other != library):
            found[f"the library `{library.name}`"] = digest([library])
    return found


def digest(files: Iterable[Path]) -> str:
    """SHA-256 of the content of files."""
    total = hashlib.sha256()
    for path in files:
        with path.open("rb") as file:
            total.update(hashlib.file_digest(file, "sha256").digest())
    return total.hexdigest()
