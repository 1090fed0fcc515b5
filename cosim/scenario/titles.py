"""Titles of scenario files, read without the rest of the files."""

from __future__ import annotations

from pathlib import Path

from cosim import paths
from cosim.scenario.toml import parse_file


def title_of(file: Path) -> str:
    """Title of a scenario file, otherwise of the file it extends; empty if none has one.

    Raises
    ------
    ScenarioError
        A file is missing or broken.
    """
    visited: set[Path] = set()
    while file not in visited:
        visited.add(file)
        table = parse_file(file)
        parent = table.get("extends")
        if "title" in table or not isinstance(parent, str):
            return str(table.get("title", ""))
        file = paths.find_scenario(parent, near=file.parent).resolve()
    return ""
