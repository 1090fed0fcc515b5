"""Traces as `.npz`: the array `trace`, one field per column, and `about` as JSON."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from cosim.formatting import strict
from cosim.trace.columns import Columns, Held, whole
from cosim.trace.stored import StoredTrace, with_labels


def write(columns: Columns, about: dict[str, Any], stream: BinaryIO) -> None:
    """Write a file."""
    np.savez_compressed(stream, trace=whole(columns), about=np.array(strict.line(about)))


def read(path: Path) -> StoredTrace:
    """Read a file."""
    # numpy treats anything else as a pickle, and suggests to trust it
    with path.open("rb") as stream:
        if not zipfile.is_zipfile(stream):
            raise ValueError("it is not an npz file, or it is truncated")
    with np.load(path, allow_pickle=False) as saved:
        table = saved["trace"]
        about = json.loads(str(saved["about"])) if "about" in saved else {}
    kinds = [kind for kind, *_ in (table.dtype.fields or {}).values()]
    if table.ndim != 1 or not kinds or any(kind != np.float64 for kind in kinds):
        raise ValueError("the array `trace` has no columns of 64-bit numbers")
    return with_labels(path, Held(table), about)
