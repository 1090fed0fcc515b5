"""`cosim --version`."""

from __future__ import annotations

import platform
from typing import Annotated

import typer
from typer import Option

from cosim.formatting.versions import PROJECT, version

DISTRIBUTIONS = {"cosim": PROJECT, "FMPy": "fmpy", "MuJoCo": "mujoco-core", "numpy": "numpy"}
"""Distribution of each program whose version is shown."""


def versions() -> dict[str, str]:
    """Versions of the programs that compute the results, without importing them."""
    found = {name: version(distribution) or "not installed" for name, distribution in DISTRIBUTIONS.items()}
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
