"""Installed packages: their versions, and those that only some commands need."""

from __future__ import annotations

import functools
import importlib
import re
from typing import Any

from cosim.errors import CosimError

PROJECT = "machining-fmus"
"""The distribution that cosim is a part of."""
DISTRIBUTIONS = {"cosim": PROJECT, "FMPy": "fmpy", "MuJoCo": "mujoco-core", "numpy": "numpy"}
"""Programs that compute the results, with their distributions."""
REQUIREMENT = re.compile(r"""(([\w.-]+)(\[.*\])?[^;]*?)\s*;\s*extra\s*==\s*['"](\w+)['"]""")
"""A package of an extra: the requirement, name and extras of the package, and name of the extra."""


@functools.cache
def version(distribution: str) -> str:
    """Version of a distribution; empty if it was not installed as one."""
    from importlib import metadata

    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return ""


def needed(module: str, problem: str, hint: str) -> Any:
    """Import a module of another package; raises CosimError with problem and hint if it is not installed."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise CosimError(problem, hint) from None


def hint(extra: str) -> str:
    """Hint how to install the missing packages of an extra; no registry has this project itself."""
    found = [known for known in map(REQUIREMENT.fullmatch, requirements()) if known and known[4] == extra]
    # an extra of an installed package may be missing, or its version too old
    missing = [known[1] for known in found if known[3] or not version(known[2])] or [one[1] for one in found]
    packages = " ".join(f'"{one}"' for one in missing)
    return f"Run `pip install {packages}`." if packages else f"Install the packages of the extra `{extra}`."


def requirements() -> list[str]:
    """Return the requirements of this project; empty if it was not installed."""
    from importlib import metadata

    try:
        return metadata.requires(PROJECT) or []
    except metadata.PackageNotFoundError:
        return []
