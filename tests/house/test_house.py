"""Structure of the sources: layers, no circular imports, unique names of types."""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from . import python, rust

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("cosim", "handbook", "plants", "tests", "xtask")
"""Folders with Python modules that import each other."""

LAYERS = (
    *("fmu", "scenario", "metrics", "formatting", "trace", "loop", "pool", "study", "show", "replay"),
    *("sweep", "acceptance", "report", "compare", "optimize", "check", "schema", "new", "ssp", "cli"),
)
"""Packages of cosim in the order of ARCHITECTURE.md; each imports only those before it."""


def sources() -> list[Path]:
    """Rust and Python files of the repository with stubs, without what is built or installed."""
    found: list[Path] = []
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [name for name in folders if name != "target" and not name.startswith(".")]
        found += [Path(folder, name) for name in names if name.endswith((".rs", ".py", ".pyi"))]
    return sorted(found)


SOURCES = sources()
CRATES = sorted(
    {str(file.parent.parent.relative_to(ROOT)) for file in SOURCES if file.parent.name == "src"} - {"."}
)


def shown(file: Path) -> str:
    return file.relative_to(ROOT).as_posix()


def circle(graph: Mapping[Path, set[Path]]) -> str:
    """One import cycle, as text; empty if there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return " imports ".join(f"`{shown(file)}`" for file in reversed(error.args[1]))
    return ""


@pytest.mark.parametrize("page", ["ARCHITECTURE.md"])
def test_a_page_about_the_structure_names_every_folder(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    folders = {shown(file).partition("/")[0] for file in SOURCES if file.parent != ROOT}
    plain = re.sub(
        r"fmu-(\*|<name>)/", " ".join(f"{name}/" for name in folders if name.startswith("fmu-")), text
    )
    of_tests = re.search(r"^(\| `)?tests/[^/]*", text, re.MULTILINE)
    inside = {file.parent.name for file in SOURCES if file.parent.parent == ROOT / "tests"}
    missing = {name for name in folders if f"{name}/" not in plain}
    assert of_tests
    assert missing | {name for name in inside if not re.search(rf"\b{name}\b", of_tests[0])} == set()


@pytest.mark.parametrize("crate", CRATES)
def test_no_rust_files_import_each_other(crate: str) -> None:
    for root in rust.roots(ROOT / crate):
        found = circle(rust.imports(root))
        assert not found, found


def test_no_python_files_import_each_other() -> None:
    files = [file for file in SOURCES if file.suffix != ".rs" and file.relative_to(ROOT).parts[0] in PACKAGES]
    found = circle(python.Packages(ROOT, files).imports())
    assert not found, found


def layer(file: Path) -> str:
    """Package of cosim that contains a file, at any depth; empty if there is none."""
    parts = file.relative_to(ROOT).parts
    return parts[1] if parts[0] == "cosim" and len(parts) > 2 else ""


def test_a_package_of_the_harness_imports_only_those_before_it() -> None:
    files = [file for file in SOURCES if file.is_relative_to(ROOT / "cosim") and file.suffix == ".py"]
    assert {layer(file) for file in files} - {""} == set(LAYERS)
    upwards = [
        f"`{shown(file)}` imports `{shown(known)}`"
        for file, imported in python.Packages(ROOT, files).imports().items()
        for known in imported
        if layer(file) and layer(known) and LAYERS.index(layer(known)) > LAYERS.index(layer(file))
    ]
    assert not upwards, "\n".join(sorted(upwards))


def twice(types: Iterable[tuple[str, Path]]) -> str:
    """Names that more than one type has, as text."""
    places: dict[str, list[str]] = defaultdict(list)
    for name, file in types:
        places[name].append(shown(file))
    return "\n".join(f"`{name}` in {', '.join(files)}" for name, files in places.items() if len(files) > 1)


@pytest.mark.parametrize("crate", CRATES)
def test_a_type_name_means_one_thing_in_a_crate(crate: str) -> None:
    found = twice(rust.types(ROOT / crate))
    assert not found, found


@pytest.mark.parametrize("package", ["cosim", "handbook", "plants"])
def test_a_class_name_means_one_thing_in_a_package(package: str) -> None:
    files = [file for file in SOURCES if file.is_relative_to(ROOT / package) and file.suffix == ".py"]
    found = twice(python.types(files))
    assert not found, found
