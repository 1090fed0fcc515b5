"""Traces read back from files."""

from __future__ import annotations

import csv
import json
import tokenize
import zipfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim import paths
from cosim.errors import CosimError
from cosim.loop import trace

ENDINGS = (".npz", ".csv")
BROKEN = (
    *(ValueError, KeyError, EOFError, NotImplementedError, RecursionError, SyntaxError),
    *(csv.Error, tokenize.TokenError, zipfile.BadZipFile, zlib.error),
)
"""What numpy, zipfile and csv raise where a file is damaged."""


@dataclass(frozen=True)
class StoredTrace:
    """A trace from a file.

    Parameters
    ----------
    file
        The file.
    trace
        Structured array as `Result.trace`; times ascend.
    units, items
        Units and items of the columns, where the file tells them.
    about
        What else the file tells of the run: scenario, title, seed, simulated time.
    """

    file: Path
    trace: NDArray[Any]
    units: dict[str, str] = field(default_factory=dict)
    items: dict[str, dict[str, int]] = field(default_factory=dict)
    about: dict[str, Any] = field(default_factory=dict)

    @property
    def columns(self) -> list[str]:
        """Names of the columns but that of the time."""
        return [name for name in self.trace.dtype.names or () if name != "time"]

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the rows, s."""
        found: NDArray[np.float64] = self.trace["time"]
        return found


def read(path: str | Path) -> StoredTrace:
    """Read a trace as `Result.save_trace` writes it, or any CSV file of numbers with a column `time`.

    Raises
    ------
    CosimError
        Missing or broken file, no times, or times that do not ascend.
    """
    path = Path(path)
    shown = paths.shown(path)
    try:
        if path.suffix == ".npz":
            found = read_npz(path)
        elif path.suffix == ".csv":
            found = read_csv(path)
        else:
            raise CosimError(f"`{shown}` is no trace", "traces end in `.npz` or `.csv`")
    except OSError as error:
        raise CosimError(f"cannot read `{shown}`: {error.strerror or error}") from None
    except BROKEN as error:
        hint = "a trace is what `cosim run --trace` writes, or a CSV file with a header"
        raise CosimError(f"`{shown}` holds no trace: {' '.join(str(error).split())}", hint) from None
    check(found, shown)
    return found


def read_npz(path: Path) -> StoredTrace:
    """Read an `.npz` file."""
    with np.load(path, allow_pickle=False) as saved:
        table = saved["trace"]
        about = json.loads(str(saved["about"])) if "about" in saved else {}
    kinds = [kind for kind, *_ in (table.dtype.fields or {}).values()]
    if table.ndim != 1 or not kinds or any(kind != np.float64 for kind in kinds):
        raise ValueError("the array `trace` has no columns of 64-bit numbers")
    units, items = (about.pop(name, {}) if isinstance(about, dict) else None for name in ("units", "items"))
    if not isinstance(units, dict) or not isinstance(items, dict):
        raise ValueError("the array `about` does not tell units and items")
    named = {name: entry for name, entry in items.items() if isinstance(entry, dict)}
    return StoredTrace(path, table, {name: str(unit) for name, unit in units.items()}, named, about)


def read_csv(path: Path) -> StoredTrace:
    """Read a `.csv` file; its first line holds the names."""
    with path.open(newline="", encoding="utf-8-sig") as lines:
        names = [name.strip() for name in next(csv.reader(lines), [])]
        rows = lines.readlines()
    table = np.loadtxt(rows, delimiter=",", ndmin=2) if rows else np.zeros((0, len(names)))
    if not all(names) or len(set(names)) != len(names):
        raise ValueError("its first line must hold the names of the columns, each once")
    if table.size and table.shape[1] != len(names):
        raise ValueError(f"its rows have {table.shape[1]} cells, its first line has {len(names)}")
    return StoredTrace(path, trace.structured(table.reshape(-1, len(names)), names))


def check(found: StoredTrace, shown: str) -> None:
    """Check that there are rows, and that their times ascend."""
    names = found.trace.dtype.names or ()
    if "time" not in names:
        known = ", ".join(f"`{name}`" for name in names[:8])
        raise CosimError(f"`{shown}` has no column `time`", f"its columns are {known}")
    if not len(found.trace):
        raise CosimError(f"`{shown}` has no rows")
    if not np.all(np.isfinite(found.times)) or np.any(np.diff(found.times) <= 0.0):
        raise CosimError(f"the times in `{shown}` do not ascend from row to row")
