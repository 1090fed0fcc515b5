"""Results and sweeps in Python: one line, tables for notebooks, data frames."""

from __future__ import annotations

import inspect
import pickle
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas
import pytest

import cosim
from cosim.errors import CosimError

from ..conftest import END, SETTLING, entry, grid

Write = Callable[..., Path]
JUDGED = (
    SETTLING
    + END
    + entry("metric", name="<b>", value="last(plant.u)")
    + entry("criterion", id="end", claim="x < 1 & settles", metric="end", maximum=0.7)
)


@pytest.fixture
def study(write: Write, folder: Path) -> Path:
    write(JUDGED)
    (folder / "poles.toml").write_text('title = "Poles"\n' + grid(pole=[0.1, 0.2, 0.3], fail_at=[-1, 7]))
    return folder / "poles.toml"


def test_a_result_is_one_line(write: Write) -> None:
    scenario = cosim.load(write(JUDGED))
    assert repr(cosim.run(scenario, 5)) == ("<Result of lag: 1 of 1 criteria passed, seed 5, 50 x 16 trace>")
    (kept_none,) = cosim.run_many(scenario, [5])
    assert repr(kept_none).endswith("seed 5, no trace>")


def test_a_result_is_a_table_in_a_notebook(write: Write) -> None:
    shown = cosim.run(cosim.load(write(JUDGED)))._repr_html_()
    assert "<td>x &lt; 1 &amp; settles</td><td>666.7 mm</td><td>&lt;= 700 mm</td><td>passed</td>" in shown
    assert "<td>&lt;b&gt;</td>" in shown
    assert "<b>lag: Lag with a probe</b><br>1 of 1 criteria passed; seed 1, 0.05 s simulated" in shown


def test_the_trace_is_a_data_frame_with_units(write: Write) -> None:
    result = cosim.run(cosim.load(write(JUDGED)))
    frame = result.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    assert result.trace is not None
    assert list(frame) == list(result.trace.dtype.names or ())
    assert frame["plant.x"].dtype == np.float64
    assert np.array_equal(frame["plant.x"], result.trace["plant.x"])
    assert frame.attrs["units"]["plant.x"] == "m"
    assert frame.set_index("time")["plant.x"].loc[0.0] == 1.0


def test_without_pandas_the_message_says_what_to_install(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    result = cosim.run(cosim.load(write()))
    reported = r"needs pandas, which is not installed\nhint: Run `pip install \"pandas>=.*\"`"
    with pytest.raises(CosimError, match=reported):
        result.to_dataframe()


def test_a_result_without_trace_has_no_data_frame(write: Write) -> None:
    (result,) = cosim.run_many(cosim.load(write()), [1])
    with pytest.raises(CosimError, match="holds no trace"):
        result.to_dataframe()


def test_a_sweep_is_called_and_gives_its_rows(study: Path, folder: Path) -> None:
    found = cosim.sweep(study, workers=1)
    assert isinstance(found, cosim.SweepResult)
    assert len(found) == 6
    assert not found.passed
    assert [row["status"] for row in found.rows] == ["passed", "error"] * 3
    assert found.folder == Path("poles.sweep")
    assert (folder / "poles.sweep" / "summary.csv").is_file()
    # a grid is no random sample: there is no interval of confidence
    assert repr(found) == "<SweepResult of Poles: 6 of 6 runs: 3 passed, 3 error; 50 % passed>"
    frame = found.to_dataframe()
    assert frame["plant.pole"].tolist() == [0.1, 0.1, 0.2, 0.2, 0.3, 0.3]
    assert frame["metric.end"].isna().tolist() == [False, True] * 3
    assert frame.groupby("status")["run"].count().to_dict() == {"passed": 3, "error": 3}
    assert frame.attrs["units"]["metric.end"] == "m"
    assert "<td>end</td><td>3 of 3</td>" in found._repr_html_()


def test_a_second_call_does_nothing_again(study: Path, folder: Path) -> None:
    first = cosim.sweep(study, folder / "out", workers=1)
    lines = (folder / "out" / "results.jsonl").read_bytes()
    again = cosim.sweep(str(study), str(folder / "out"), workers=1)
    assert again.rows == first.rows
    assert (folder / "out" / "results.jsonl").read_bytes() == lines


@pytest.mark.parametrize("name", ["evaluate", "load", "optimize", "run", "run_each", "run_many", "sweep"])
def test_a_public_function_has_a_signature_and_help_and_can_be_pickled(name: str) -> None:
    function = getattr(cosim, name)
    assert inspect.isfunction(function)
    assert inspect.signature(function).parameters.keys() - {"arguments", "options"}
    assert "Parameters\n" in (inspect.getdoc(function) or "")
    assert pickle.loads(pickle.dumps(function)) is function


def test_a_package_keeps_its_modules_next_to_the_function_of_the_same_name() -> None:
    from cosim.sweep import study as module

    assert sys.modules["cosim.sweep.study"] is module
    assert inspect.isfunction(cosim.sweep)
