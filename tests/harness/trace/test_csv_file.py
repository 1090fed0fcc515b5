"""Traces as CSV: names of any kind, and files of other programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cosim
from cosim.errors import CosimError
from cosim.trace import files
from cosim.trace.columns import Held, structured

NAMES = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1).filter(
    lambda name: name == name.strip() and name != "time"
)


def saved(names: list[str], file: Path) -> np.ndarray:
    table = structured(np.arange(2.0 * (1 + len(names))).reshape(2, -1), ["time", *names])
    files.save(Held(table), file, {})
    return table


@given(st.lists(NAMES, min_size=1, max_size=4, unique=True))
def test_any_name_comes_back(tmp_path_factory: pytest.TempPathFactory, names: list[str]) -> None:
    file = tmp_path_factory.mktemp("names") / "x.csv"
    table = saved(names, file)
    found = cosim.read_trace(file)
    assert found.columns == names
    assert found.trace.tobytes() == table.tobytes()


def test_names_are_in_utf_8_and_quoted(tmp_path: Path) -> None:
    file = tmp_path / "x.csv"
    saved(["plant.Ω", "größe", 'a"b'], file)
    assert file.read_bytes().decode().splitlines()[0] == '"time","plant.Ω","größe","a""b"'


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_other_separators_are_read(tmp_path: Path, separator: str) -> None:
    file = tmp_path / "x.csv"
    file.write_text(f'time{separator}"a,b;c"\n0{separator}1.5\n1{separator}2e-3\n')
    found = cosim.read_trace(file)
    assert found.columns == ["a,b;c"]
    assert found.trace["a,b;c"].tolist() == [1.5, 2e-3]


def test_decimal_commas_are_read_where_no_number_has_a_point(tmp_path: Path) -> None:
    file = tmp_path / "x.csv"
    file.write_text("time;a\n0;-1,5e3\n0,5;2\n")
    assert cosim.read_trace(file).trace.tolist() == [(0.0, -1500.0), (0.5, 2.0)]
    file.write_text("time;a\n0;1,5\n0.5;2\n")
    with pytest.raises(CosimError, match=r"is not a valid trace: .*'1,5'"):
        cosim.read_trace(file)
