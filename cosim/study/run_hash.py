"""Hash of everything that affects the results of a run: scenario, FMU, plant and project."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib
import sys
import sysconfig
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from cosim.extras import version
from cosim.loop import own_code, plant
from cosim.pool import single_task
from cosim.scenario.overrides import is_tables

NO_EFFECT = ("title", "description", "plot", "criterion")
"""Parts of a scenario without effect on metrics; criteria are evaluated again whenever a row is read."""
PACKAGES = ("mujoco-core", "fmpy", "numpy")
"""Their versions are part of every hash."""
FOLDERS = ("fmu", "loop", "metrics", "scenario")
"""Folders of cosim that affect the results of a run."""
CODE = (".py", ".xml", ".so", ".pyd")
"""Files of a package that affect a run."""
MODULUS = 1 << 256
PROJECT = [Path(__file__).resolve().parents[2] / name for name in ("plants", "cosim")]
"""Packages whose files are part of every hash."""


def total(leaves: Mapping[str, Any]) -> int:
    """Sum of the hashes of values with their locations, so that one value can be replaced."""
    return sum(leaf(key, value) for key, value in leaves.items()) % MODULUS


def leaf(key: str, value: Any) -> int:
    """SHA-256 of one value as a number."""
    return int.from_bytes(hashlib.sha256(f"{key}={value!r}".encode()).digest(), "big")


def finished(summed: int, seed: int) -> bytes:
    """Hash of a run with a seed, of a sum of leaves; 16 bytes."""
    text = f"{summed % MODULUS:x} {seed}"
    return hashlib.sha256(text.encode()).digest()[:16]


def section(name: str, value: Any) -> dict[str, Any]:
    """Every value in a part of a scenario by its location; none without effect on metrics."""
    return {} if name in NO_EFFECT else dict(values(name, value))


def values(key: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield locations and values; arrays other than those of tables are one value."""
    if isinstance(value, dict):
        for name, item in value.items():
            yield from values(f"{key}.{name}", item)
    elif value and is_tables(value):
        for index, item in enumerate(value):
            yield from values(f"{key}[{index}]", item)
    else:
        yield key, value


def digest(path: Path) -> str:
    """SHA-256 of the current file."""
    state = path.stat()
    return digest_of(path, state.st_mtime_ns, state.st_size)


@functools.cache
def digest_of(path: Path, *_: int) -> str:
    """SHA-256 of a file with this time and size."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


@functools.cache
def plant_of(name: str, folder: Path) -> tuple[Any, str]:
    """Class of a plant and the SHA-256 of its sources; computed again for every plan."""
    module, colon, _ = name.partition(":")
    if colon and not own_code.is_imported(module, folder):
        single_task.check_import(name, folder)
    kind = plant.plant_class(name, folder)
    plant.check_class(kind)
    parts = [digest(file) for file in sources(kind, folder)]
    if name.endswith(plant.MJCF):
        # files that the MJCF includes and meshes count as well
        parts.append(importlib.import_module("plants.bare").fingerprint(kind.file))
    return kind, joined(parts)


def sources(kind: Any, folder: Path) -> list[Path]:
    """Files of a plant's class and its bases, their packages, and their imports from folders of the user."""
    names = {base.__module__ for base in kind.__mro__}
    files = files_of(map(sys.modules.get, names))
    files |= {found for file in files if not is_installed(file) for found in imported(file, folder)}
    # the whole package, installed or not: any of its modules may be imported at any time
    packages = [sys.modules.get(name.partition(".")[0]) for name in names]
    for place in (Path(found) for package in packages for found in getattr(package, "__path__", ())):
        files |= {file.resolve() for file in place.rglob("*") if file.suffix in CODE and file.is_file()}
    # by name, then folder: wherever they lie
    return sorted(files, key=lambda file: file.parts[::-1])


def is_installed(file: Path) -> bool:
    """Whether a file belongs to Python, an installed package or the project, or is not Python code."""
    places = [*map(Path, sysconfig.get_paths().values()), *PROJECT]
    return file.suffix != ".py" or any(file.is_relative_to(place.resolve()) for place in places)


def imported(module: Path, folder: Path) -> set[Path]:
    """Files below a module's folder, a scenario's folder or the working directory that a module imports."""
    from modulefinder import ModuleFinder

    places = list(dict.fromkeys([str(module.parent), str(folder), str(Path.cwd())]))
    finder = ModuleFinder(path=places)
    # a module that is only imported when it is needed may be missing; what was found until then counts
    with contextlib.suppress(Exception):
        finder.run_script(str(module))
    return {file for file in files_of(finder.modules.values()) if not is_installed(file)}


def files_of(modules: Iterable[Any]) -> set[Path]:
    """Files of the modules that have one."""
    return {Path(file).resolve() for module in modules if (file := getattr(module, "__file__", None))}


@functools.cache
def project() -> dict[str, str]:
    """Versions and contents of everything that computes the results, except FMU and plant."""
    import machining_native

    plants, cosim = PROJECT
    files = [*plants.rglob("*"), *cosim.glob("*")]
    files += [file for folder in FOLDERS for file in (cosim / folder).rglob("*")]
    files = sorted((file for file in files if file.suffix in CODE), key=lambda file: file.parts[::-1])
    files.append(Path(machining_native.__file__))
    versions = {name: version(name) for name in PACKAGES}
    return {**versions, "project": joined([digest(file) for file in files])}


def joined(parts: list[str]) -> str:
    """SHA-256 of several hashes."""
    return hashlib.sha256("".join(parts).encode()).hexdigest()
