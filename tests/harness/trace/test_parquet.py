"""Parquet files of others as traces, and files that are damaged."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet

import cosim
from cosim.errors import CosimError


def save(columns: dict[str, Any], file: str = "x.parquet") -> Path:
    parquet.write_table(pyarrow.table(columns), file, row_group_size=2)
    return Path(file)


@pytest.mark.usefixtures("folder")
def test_a_file_of_another_program_is_a_trace() -> None:
    times = [0.0, 0.5, 1.0]
    found = cosim.read_trace(
        save({"a": [1, 2, None], "time": times, "a.b": [True, False, True], "text": ["x", "y", "z"]})
    )
    assert found.times.tolist() == times
    assert found.columns == ["a", "a.b", "text"]
    # a name that others begin with is one column
    assert found.data["a"][:2].tolist() == [1.0, 2.0]
    assert np.isnan(found.data["a"][2])
    assert found.data["a.b"].tolist() == [1.0, 0.0, 1.0]
    assert (found.units, found.items, found.about) == ({}, {}, {})
    with pytest.raises(CosimError, match=r"cannot read `text` in `x\.parquet`"):
        found.data["text"]


def torn(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-20])


def empty(file: Path) -> None:
    file.write_bytes(b"")


WRONG: dict[str, tuple[dict[str, Any], Callable[[Path], None] | None, str]] = {
    "no time": ({"t": [0.0, 1.0]}, None, "has no column `time`"),
    "no rows": ({"time": pyarrow.array([], pyarrow.float64())}, None, "has no rows"),
    "back": ({"time": [1.0, 0.0]}, None, "do not increase"),
    "gap": ({"time": [0.0, None]}, None, "do not increase"),
    "text": ({"time": ["now", "then"]}, None, "cannot read `time`"),
    "torn": ({"time": [0.0, 1.0]}, torn, "is not a valid trace"),
    "empty": ({"time": [0.0, 1.0]}, empty, "is not a valid trace"),
}


@pytest.mark.parametrize("case", WRONG)
@pytest.mark.usefixtures("folder")
def test_what_is_no_trace_is_one_sentence(case: str) -> None:
    columns, damage, problem = WRONG[case]
    file = save(columns)
    if damage:
        damage(file)
    with pytest.raises(CosimError) as caught:
        cosim.read_trace(file)
    assert "x.parquet" in caught.value.message
    assert problem in caught.value.message


@pytest.mark.usefixtures("folder")
def test_facts_that_are_no_table_are_rejected() -> None:
    schema = pyarrow.schema([("time", pyarrow.float64())], {"cosim": "[1]"})
    parquet.write_table(pyarrow.table({"time": [0.0]}, schema=schema), "x.parquet")
    with pytest.raises(CosimError, match="is not a valid trace"):
        cosim.read_trace("x.parquet")
