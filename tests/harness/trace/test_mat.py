"""Traces as MAT files: what MATLAB finds in them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import io

from cosim.errors import CosimError
from cosim.trace import files, mat
from cosim.trace.columns import Held, structured

NAMES = ("time", "plant.force[1]", "plant.force_1", "plant.x", "plant." + 70 * "y", "end", "plant.µ")


def save(file: str, names: tuple[str, ...] = NAMES) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    table = np.random.default_rng(3).normal(size=(40, len(names)))
    table[:, 0] = np.arange(40) / 8.0
    table[5, 1:4] = np.nan, np.inf, -0.0
    about = {"scenario": "cart", "seed": 3, "units": {"plant.x": "m"}, "descriptions": {"plant.x": "Place"}}
    files.save(Held(structured(table, names)), Path(file), about)
    return table


@pytest.mark.usefixtures("folder")
def test_every_column_returns_in_every_bit() -> None:
    table = save("x.mat")
    found = io.loadmat("x.mat")
    rows = [[str(cell[0]) if cell.size else "" for cell in row] for row in found["columns"]]
    variables = [row[0] for row in rows]
    assert [row[1] for row in rows] == list(NAMES)
    assert rows[3] == ["plant_x", "plant.x", "m", "Place"]
    for place, variable in enumerate(variables):
        assert found[variable].shape == (40, 1)
        assert found[variable].tobytes() == np.ascontiguousarray(table[:, place]).tobytes()
    assert json.loads(str(found["about"][0])) == {"scenario": "cart", "seed": 3}
    # names that MATLAB takes, each once
    assert all(name.isascii() and name.isidentifier() and name[0].isalpha() for name in variables)
    assert max(map(len, variables)) == mat.LONGEST
    assert variables[:3] == ["time", "plant_force_1", "plant_force_1_2"]
    assert "end" not in variables


def test_long_names_that_begin_alike_stay_apart() -> None:
    names = mat.variables(f"{70 * 'a'}{number}" for number in range(12))
    assert len(set(names.values())) == 12
    assert {len(name) for name in names.values()} == {mat.LONGEST}


@pytest.mark.usefixtures("folder")
def test_a_trace_that_is_too_long_is_rejected_before_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    files.check_rows(Path("x.mat"), 268_435_455)
    files.check_rows(Path("x.parquet"), 268_435_456)
    with pytest.raises(CosimError, match=r"268435456 rows needs 2\.1 GB(?s:.*)Use `\.parquet`"):
        files.check_rows(Path("x.mat"), 268_435_456)
    monkeypatch.setattr(mat, "MOST", 8 * 39)
    with pytest.raises(CosimError, match="40 rows"):
        save("x.mat")
    assert not list(Path().glob("*.mat*"))


@pytest.mark.usefixtures("folder")
def test_a_mat_file_is_not_read_back() -> None:
    save("x.mat")
    with pytest.raises(CosimError, match=r"`x\.mat` is not a trace"):
        files.read("x.mat")
