"""Imports of Python files by their syntax trees, those within functions and for type checkers included."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

Name = tuple[str, ...]
"""Dotted name of a module."""


def name_of(file: Path, root: Path) -> Name:
    """Dotted name of a file; that of its folder for `__init__.py`."""
    parts = file.relative_to(root).with_suffix("").parts
    return parts[:-1] if parts[-1] == "__init__" else parts


def imported(tree: ast.Module, package: Name) -> Iterator[tuple[Name, str]]:
    """Modules that a tree imports, each with the name taken from it, empty for the module itself."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield tuple(alias.name.split(".")), ""
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            module = (*base, *(node.module.split(".") if node.module else ()))
            for alias in node.names:
                yield module, alias.name


class Packages:
    """All modules below a root that belong to some folders."""

    def __init__(self, root: Path, files: list[Path]) -> None:
        self.files = {name_of(file, root): file for file in files}
        self.found: dict[Name, list[tuple[Name, str]]] = {}
        for name, file in self.files.items():
            package = name if file.name == "__init__.py" else name[:-1]
            self.found[name] = list(imported(ast.parse(file.read_text(encoding="utf-8")), package))

    def target(self, importer: Name, module: Name, name: str) -> Name | None:
        """Return where an import leads to; a facade leads on, unless the importer is below it."""
        if (*module, name) in self.files:
            return (*module, name)
        while module and module not in self.files:
            module = module[:-1]
        if not module:
            return None
        if importer[: len(module)] != module and self.files[module].name == "__init__.py":
            for onward, taken in self.found[module]:
                if taken == name:
                    return self.target(module, onward, name) or module
        return module

    def imports(self) -> dict[Path, set[Path]]:
        """Files, each with those that it imports."""
        graph: dict[Path, set[Path]] = {}
        for importer, file in self.files.items():
            targets = (self.target(importer, *found) for found in self.found[importer])
            graph[file] = {self.files[target] for target in targets if target is not None} - {file}
        return graph


def types(files: list[Path]) -> list[tuple[str, Path]]:
    """Classes that some files define, each with its file."""
    return [
        (node.name, file)
        for file in files
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef)
    ]
