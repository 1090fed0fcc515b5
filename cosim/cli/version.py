"""`cosim --version`."""

from __future__ import annotations

import platform
from typing import Annotated

import typer
from typer import Option

DISTRIBUTIONS = {"cosim": "machining-fmus", "FMPy": "fmpy", "MuJoCo": "mujoco-core", "numpy": "numpy"}
"""Distribution of each thing whose version is told."""


def versions() -> dict[str, str]:
    """Versions of what computes the numbers; nothing is imported for it."""
    from importlib.metadata import PackageNotFoundError, version

    found = {}
    for name, distribution in DISTRIBUTIONS.items():
        try:
            found[name] = version(distribution)
        except PackageNotFoundError:
            found[name] = "not installed"
    return {**found, "Python": platform.python_version()}


def show_version(wanted: bool) -> None:
    """Print the versions and end."""
    if wanted:
        for name, version in versions().items():
            print(name, version)
        raise typer.Exit


Version = Annotated[
    bool,
    Option(
        "--version",
        callback=show_version,
        is_eager=True,
        help="Show the versions of cosim, FMPy, MuJoCo, numpy and Python.",
    ),
]


def options(version: Version = False) -> None:
    """Options before any command."""
