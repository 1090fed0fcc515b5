"""Trace files: one format for each ending."""

from __future__ import annotations

import csv
import importlib
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.errors import CosimError
from cosim.trace import endings
from cosim.trace.columns import Columns
from cosim.trace.stored import StoredTrace, check
from cosim.writing import whole

MODULES = {endings.NPZ: "npz", endings.CSV: "csv_file", endings.MAT: "mat"}
MODULES |= dict.fromkeys(endings.PARQUET, "parquet")
"""Module of each format: `write` takes columns, their metadata and a stream; `read` a path."""
HINT = "Use a file of `cosim run --trace`, or a CSV or Parquet file with a column `time`."
BROKEN = (
    *(MemoryError, ValueError, KeyError, EOFError, NotImplementedError, RecursionError, SyntaxError),
    *(csv.Error, tokenize.TokenError, zipfile.BadZipFile, zlib.error),
)
"""Exceptions of numpy, zipfile, csv and pyarrow for damaged files."""


def module(file: Path) -> Any:
    """Import the module of the format of a file."""
    endings.check_installed(file)
    return importlib.import_module(f"cosim.trace.{MODULES[file.suffix]}")


def save(columns: Columns, file: Path, about: dict[str, Any]) -> None:
    """Save a trace in the format of its ending; the file is always complete."""
    endings.check(file)
    with whole(file) as partial, partial.open("wb") as stream:
        module(file).write(columns, about, stream)


def check_rows(file: Path, rows: int) -> None:
    """Check before a long run that a trace with a number of rows fits into a file."""
    if file.suffix == endings.MAT:
        module(file).check_rows(rows)


def read(file: str | Path) -> StoredTrace:
    """Read a trace as `Result.save_trace` writes it, or any file of numbers with a column `time`.

    Parameters
    ----------
    file
        It ends in `.npz`, `.csv` or `.parquet`; Parquet columns are read on access.

    Raises
    ------
    CosimError
        Missing or broken file, no times, or times that do not increase.
    """
    file = Path(file)
    if file.suffix not in endings.READ:
        problem = f"`{paths.shown(file)}` is not a trace"
        raise CosimError(problem, f"Use a file that ends in {endings.listed(endings.READ)}.")
    found = open_trace(file)
    check(found)
    return found


def open_trace(file: Path) -> StoredTrace:
    """Open a trace of this program without a check of its times, which may be many."""
    shown = paths.shown(file)
    if paths.is_there(file) and not paths.is_file(file):
        raise CosimError(f"cannot read `{shown}`: it is not a regular file")
    try:
        found: StoredTrace = module(file).read(file)
    except OSError as error:
        raise CosimError(f"cannot read `{shown}`: {error.strerror or error}") from None
    except BROKEN as error:
        raise CosimError(f"`{shown}` is not a valid trace: {' '.join(str(error).split())}", HINT) from None
    return found
