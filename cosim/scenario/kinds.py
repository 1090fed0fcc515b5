"""Kinds of files, identified by their keys, for clear errors if a file is given to the wrong command."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from cosim import paths
from cosim.errors import ScenarioError

Kind = Literal["scenario", "study", "optimization"]
KEYS: dict[Kind, tuple[str, ...]] = {
    "optimization": ("objective",),
    "study": ("scenario", "design"),
    "scenario": ("loop", "controller", "fmu", "plant", "extends"),
}
"""Keys that identify a kind, in the order of the checks."""
COMMANDS: dict[Kind, str] = {"scenario": "run", "study": "sweep", "optimization": "optimize"}


def kind_of(table: Mapping[str, Any]) -> Kind | None:
    """Kind of a file by its keys; None if unknown."""
    return next((kind for kind, keys in KEYS.items() if not table.keys().isdisjoint(keys)), None)


def check_kind(table: Mapping[str, Any], file: Path, wanted: Kind) -> None:
    """Check that a file is of the required kind; an error names the command for the other."""
    found = kind_of(table)
    if found not in (None, wanted):
        named = {kind: f"{'an' if kind == 'optimization' else 'a'} {kind}" for kind in KEYS}
        shown = paths.shown(file)
        problem = f"`{shown}` is {named[found]}, not {named[wanted]}"
        raise ScenarioError(problem, f"Use `cosim {COMMANDS[found]} {shown}`.")
