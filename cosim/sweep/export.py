"""The table of a sweep on disk: as CSV, and as Parquet if pyarrow is installed."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

from cosim.writing import whole

Table = dict[str, list[Any]]
"""Columns by name, all of one length; None if a run has no value."""
BLOCK = 1 << 20
"""Bytes of a read block; a row is never longer."""


def save_csv(table: Table, file: Path) -> None:
    """Write `summary.csv`: one line for each run that has a row."""
    with whole(file) as partial, partial.open("w", newline="", encoding="utf-8") as lines:
        writer = csv.writer(lines)
        writer.writerow(table)
        for row in zip(*table.values(), strict=True):
            writer.writerow([str(value).lower() if isinstance(value, bool) else value for value in row])


def save_parquet(table: Table, file: Path) -> bool:
    """Write `summary.parquet`, the same table with types; False if pyarrow is not installed."""
    try:
        import pyarrow
        from pyarrow import json as reader
        from pyarrow import parquet
    except ImportError:
        return False
    columns = {name: of_one_kind(values) for name, values in table.items()}
    lines = io.BytesIO()
    rows = (dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True))
    longest = max((lines.write(json.dumps(row).encode() + b"\n") for row in rows), default=0)
    if longest:
        lines.seek(0)
        # `pyarrow.array` would import pandas, which takes longer than the rest of a short sweep
        types = reader.ParseOptions(explicit_schema=pyarrow.schema(fields(pyarrow, columns)))
        typed = reader.read_json(lines, reader.ReadOptions(block_size=max(BLOCK, longest)), types)
    else:
        typed = pyarrow.table({name: pyarrow.nulls(0) for name in columns})
    with whole(file) as partial:
        parquet.write_table(typed.select(list(columns)), partial)
    return True


def fields(pyarrow: Any, columns: Table) -> list[tuple[str, Any]]:
    """Names and types of the columns of scalars."""
    known = {bool: pyarrow.bool_(), int: pyarrow.int64(), float: pyarrow.float64(), str: pyarrow.string()}
    kinds = {name: {type(value) for value in values if value is not None} for name, values in columns.items()}
    return [(name, known[kind]) for name, found in kinds.items() for kind in found if kind in known]


def of_one_kind(values: list[Any]) -> list[Any]:
    """Values of a column: floats if one is a float, texts if there are several types."""
    kinds = {type(value) for value in values if value is not None}
    if len(kinds) < 2:
        return values
    common: Any = float if kinds == {int, float} else str
    return [None if value is None else common(value) for value in values]
