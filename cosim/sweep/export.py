"""The table of a sweep on disk: as CSV, and as Parquet where pyarrow is installed."""

from __future__ import annotations

import csv
import importlib
from pathlib import Path
from typing import Any

from cosim.writing import whole

Table = dict[str, list[Any]]
"""Columns by name, all of one length; None where a run has no value."""


def save_csv(table: Table, file: Path) -> None:
    """Write `summary.csv`: one line for each run that has a row.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    with whole(file) as partial, partial.open("w", newline="", encoding="utf-8") as lines:
        writer = csv.writer(lines)
        writer.writerow(table)
        writer.writerows([shown(value) for value in row] for row in zip(*table.values(), strict=True))


def shown(value: Any) -> Any:
    """Value in a CSV file: as TOML where that is something else."""
    return str(value).lower() if isinstance(value, bool) else value


def save_parquet(table: Table, file: Path) -> bool:
    """Write `summary.parquet`, the same table with types; False if pyarrow is not installed.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    try:
        pyarrow: Any = importlib.import_module("pyarrow")
        parquet: Any = importlib.import_module("pyarrow.parquet")
    except ImportError:
        return False
    columns = {name: typed(pyarrow, values) for name, values in table.items()}
    with whole(file) as partial:
        parquet.write_table(pyarrow.table(columns), partial)
    return True


def typed(pyarrow: Any, values: list[Any]) -> Any:
    """Column of one type; of texts where the values have several."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        values = [None if value is None else float(value) for value in values]
    elif len(kinds) > 1:
        values = [None if value is None else str(value) for value in values]
    return pyarrow.array(values)
