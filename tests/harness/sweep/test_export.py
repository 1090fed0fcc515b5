"""The table of a sweep as Parquet: every value with its type."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pyarrow import parquet

from cosim.sweep.export import save_parquet

COLUMNS: dict[str, tuple[list[Any], str, list[Any]]] = {
    "integers": ([1, None, 2**53], "int64", [1, None, 2**53]),
    "numbers": ([1, 2.5, None], "double", [1.0, 2.5, None]),
    "not finite": ([float("inf"), -float("inf"), -0.0], "double", [float("inf"), -float("inf"), -0.0]),
    "yes and no": ([True, None, False], "bool", [True, None, False]),
    "texts": (["", 'a,b"\n', "\u2028"], "string", ["", 'a,b"\n', "\u2028"]),
    "dates are texts": (["2026-01-31T00:00:00"] * 3, "string", ["2026-01-31T00:00:00"] * 3),
    "several types": ([1, True, "x"], "string", ["1", "True", "x"]),
    "vectors": (
        [[1.0, 2.0], [3.0, 4.5], [0.0, 0.0]],
        "list<element: double>",
        [[1.0, 2.0], [3.0, 4.5], [0.0, 0.0]],
    ),
    "nothing": ([None, None, None], "null", [None, None, None]),
}


def test_values_return_with_their_types(tmp_path: Path) -> None:
    file = tmp_path / "summary.parquet"
    assert save_parquet({name: given for name, (given, _, _) in COLUMNS.items()}, file)
    table = parquet.read_table(file)
    assert table.column_names == list(COLUMNS)
    for name, (_, kind, expected) in COLUMNS.items():
        assert str(table.schema.field(name).type) == kind
        assert repr(table[name].to_pylist()) == repr(expected), name


@pytest.mark.parametrize(("rows", "length"), [(0, 0), (40_000, 40), (2, 3_000_000)])
def test_a_table_has_any_length(tmp_path: Path, rows: int, length: int) -> None:
    text = "x" * length
    # a value that comes late is of another block
    late = [None] * (rows - 1) + [0.5] * min(1, rows)
    assert save_parquet(
        {"number": list(range(rows)), "text": [text] * rows, "late": late}, tmp_path / "x.parquet"
    )
    table = parquet.read_table(tmp_path / "x.parquet")
    assert (table.num_rows, table.column_names) == (rows, ["number", "text", "late"])
    assert table["number"].to_pylist() == list(range(rows))
    assert table["late"].to_pylist() == late


@pytest.mark.parametrize(
    "line",
    [
        "from cosim.sweep.export import save_parquet; save_parquet({'a': [1.0, None]}, Path('x.parquet'))",
        "from cosim.trace.parquet import values; assert values(np.ones(3)).to_pylist() == [1.0, 1.0, 1.0]",
    ],
    ids=["table", "trace"],
)
def test_no_pandas_is_imported_to_write(tmp_path: Path, line: str) -> None:
    code = f"import sys; from pathlib import Path; import numpy as np; {line}; exit('pandas' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
