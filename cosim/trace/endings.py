"""Endings of trace files; imports no further module."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from pathlib import Path

from cosim import extras
from cosim.errors import CosimError
from cosim.writing import check_folder

NPZ, CSV, MAT = ".npz", ".csv", ".mat"
PARQUET = (".parquet", ".pq")
READ = (NPZ, CSV, *PARQUET)
WRITTEN = (*READ, MAT)
NEEDS = {**dict.fromkeys(PARQUET, ("pyarrow", "parquet")), MAT: ("scipy", "matlab")}
"""Packages that a format needs, and the extras that install them."""


def listed(endings: Sequence[str]) -> str:
    """List endings as text."""
    *first, last = (f"`{ending}`" for ending in endings)
    return f"{', '.join(first)} or {last}"


def streams(file: Path) -> bool:
    """Whether a trace can be written to this file during the run."""
    return file.suffix in PARQUET


def streamed(file: Path) -> Path:
    """Return the file for a trace that is written during the run, checked as by `check`."""
    if not streams(file):
        hint = f"Use a name that ends in {listed(PARQUET)}."
        raise CosimError(f"a trace cannot be streamed to `{file}`", hint)
    check(file)
    return file


def check(file: Path) -> None:
    """Check before a long run the ending and the folder of its trace, and the packages of the format."""
    if file.suffix not in WRITTEN:
        raise CosimError(f"cannot save a trace as `{file}`", f"Use a name that ends in {listed(WRITTEN)}.")
    check_installed(file)
    check_folder(file)


def check_installed(file: Path) -> None:
    """Check that the package of a format is installed; the error shows how to install it."""
    package, extra = NEEDS.get(file.suffix, ("", ""))
    if package and importlib.util.find_spec(package) is None:
        raise CosimError(f"`{file}` needs {package}, which is not installed", extras.hint(extra))
