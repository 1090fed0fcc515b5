"""Titles of scenario files, without reading more of them than that takes."""

from __future__ import annotations

from pathlib import Path

from cosim import paths
from cosim.scenario import layers


def title_of(file: Path) -> str:
    """Title of a scenario file, else of the file it extends; empty if none has one.

    Raises
    ------
    ScenarioError
        A file on the way to the title is missing or broken.
    """
    visited: set[Path] = set()
    while file not in visited:
        visited.add(file)
        table = layers.parse_file(file)
        parent = table.get("extends")
        if "title" in table or not isinstance(parent, str):
            return str(table.get("title", ""))
        file = paths.find_scenario(parent, near=file.parent).resolve()
    return ""
