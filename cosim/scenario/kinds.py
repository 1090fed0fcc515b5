"""Kinds of files, told by their keys: a file that is given to the command of another kind is no riddle."""

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
"""Keys of which one is enough, the first kind first."""
COMMANDS: dict[Kind, str] = {"scenario": "run", "study": "sweep", "optimization": "optimize"}


def kind_of(table: Mapping[str, Any]) -> Kind | None:
    """Kind of a file by its keys, None where none is one of these."""
    return next((kind for kind, keys in KEYS.items() if not table.keys().isdisjoint(keys)), None)


def check_kind(table: Mapping[str, Any], file: Path, wanted: Kind) -> None:
    """Check that a file is not of another kind than the one that is wanted.

    Raises
    ------
    ScenarioError
        It is; names the command for it.
    """
    found = kind_of(table)
    if found not in (None, wanted):
        named = {kind: f"{'an' if kind == 'optimization' else 'a'} {kind}" for kind in KEYS}
        shown = paths.shown(file)
        problem = f"`{shown}` is {named[found]}, not {named[wanted]}"
        raise ScenarioError(problem, f"`cosim {COMMANDS[found]} {shown}` is for it")
