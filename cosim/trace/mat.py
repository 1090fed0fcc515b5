"""Traces as MAT files of version 5, which MATLAB, Octave and scipy read.

Every column is a variable with a valid MATLAB name. The cell array `columns` has a row for
each: variable, name of the column, unit and description. `about` holds the facts of the run as JSON.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, BinaryIO

import numpy as np
from scipy import io

from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.trace.columns import Columns
from cosim.trace.stored import facts

LONGEST = 63
"""Maximum length of a name in MATLAB."""
MOST = (1 << 31) - 1
"""Maximum bytes of a variable in a MAT file of version 5."""
OWN = ("columns", "about")
KEYWORDS = (
    *("break", "case", "catch", "classdef", "continue", "else", "elseif", "end", "for", "function", "global"),
    *("if", "otherwise", "parfor", "persistent", "return", "spmd", "switch", "try", "while"),
)


def write(columns: Columns, about: dict[str, Any], stream: BinaryIO) -> None:
    """Write a file."""
    check_rows(len(columns["time"]))
    names = variables(columns)
    labels = [about.get(label, {}) for label in ("units", "descriptions")]
    rows = [[variable, name, *(of.get(name, "") for of in labels)] for name, variable in names.items()]
    table = np.array(rows, dtype=object)
    own = {"columns": table, "about": strict.line(facts(about))}
    data = {variable: columns[name] for name, variable in names.items()}
    io.savemat(stream, {**data, **own}, long_field_names=True, oned_as="column", do_compression=True)


def check_rows(rows: int) -> None:
    """Check that a column with a number of rows fits into a variable."""
    if 8 * rows > MOST:
        problem = f"a column of {rows} rows needs {8e-9 * rows:.1f} GB; the limit of a `.mat` file is 2.1 GB"
        raise CosimError(problem, "Use `.parquet`, or record less with `loop.record_every`.")


def variables(names: Iterable[str]) -> dict[str, str]:
    """Names of columns and of their variables: letters, digits and `_`, at most 63, each once."""
    found: dict[str, str] = {}
    taken = {*OWN, *KEYWORDS}
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
        plain = (plain if plain[:1].isalpha() else f"x{plain}")[:LONGEST]
        variable, number = plain, 2
        while variable in taken:
            ending = f"_{number}"
            variable, number = plain[: LONGEST - len(ending)] + ending, number + 1
        taken.add(variable)
        found[name] = variable
    return found
