"""Traces as `.csv`: names in the first line, numbers below, as FMPy writes and reads them.

Files of other programs may separate their cells by semicolons or tabs, and may have decimal commas.
"""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from cosim.trace.columns import Columns, Held, structured, whole
from cosim.trace.stored import StoredTrace

SEPARATORS = "\t;,"
"""Separators of cells; the first one that the names have outside of quotes separates the cells of a file."""
QUOTED = re.compile(r'"[^"]*"?')


def write(columns: Columns, about: dict[str, Any], stream: BinaryIO) -> None:
    """Write a file in UTF-8, which holds only names and numbers."""
    header = io.StringIO()
    csv.writer(header, quoting=csv.QUOTE_ALL, lineterminator="\n").writerow(columns)
    stream.write(header.getvalue().encode())
    table = whole(columns)
    np.savetxt(stream, table.view(np.float64).reshape(len(table), -1), fmt="%.17g", delimiter=",")


def lines(path: Path) -> tuple[list[str], str]:
    """Lines of a file with decimal points, and the separator of its cells.

    A comma is a decimal comma only if it separates no cells and no number has a point.
    """
    with path.open(newline="", encoding="utf-8-sig") as stream:
        head, *rows = stream.readlines() or [""]
    plain = QUOTED.sub("", head)
    separator = next((one for one in SEPARATORS if one in plain), ",")
    if separator != "," and not any("." in row for row in rows):
        rows = [row.replace(",", ".") for row in rows]
    return [head, *rows], separator


def read(path: Path) -> StoredTrace:
    """Read a file."""
    text, separator = lines(path)
    reader = csv.reader(text, delimiter=separator)
    names = [name.strip() for name in next(reader, [])]
    rows = text[reader.line_num :]
    if not names or not all(names) or len(set(names)) != len(names):
        raise ValueError("its first line must hold the names of the columns, each once")
    table = np.loadtxt(rows, delimiter=separator, ndmin=2) if rows else np.zeros((0, len(names)))
    if table.size and table.shape[1] != len(names):
        raise ValueError(f"its rows have {table.shape[1]} cells, its first line has {len(names)}")
    return StoredTrace(path, Held(structured(table.reshape(-1, len(names)), names)))
