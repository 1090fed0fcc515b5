"""Traces as `.csv`: names in the first line, numbers below, as FMPy writes and reads them."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from cosim.trace.columns import Columns, Held, structured, whole
from cosim.trace.stored import StoredTrace


def write(columns: Columns, about: dict[str, Any], stream: BinaryIO) -> None:
    """Write a file, which holds only names and numbers."""
    table = whole(columns)
    header = ",".join(f'"{name}"' for name in columns)
    numbers = table.view(np.float64).reshape(len(table), -1)
    np.savetxt(stream, numbers, fmt="%.17g", delimiter=",", header=header, comments="")


def read(path: Path) -> StoredTrace:
    """Read a file."""
    with path.open(newline="", encoding="utf-8-sig") as lines:
        names = [name.strip() for name in next(csv.reader(lines), [])]
        rows = lines.readlines()
    if not names or not all(names) or len(set(names)) != len(names):
        raise ValueError("its first line must hold the names of the columns, each once")
    table = np.loadtxt(rows, delimiter=",", ndmin=2) if rows else np.zeros((0, len(names)))
    if table.size and table.shape[1] != len(names):
        raise ValueError(f"its rows have {table.shape[1]} cells, its first line has {len(names)}")
    return StoredTrace(path, Held(structured(table.reshape(-1, len(names)), names)))
