"""`cosim plot`: stored traces of any format, alone and overlaid."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from cosim.errors import CosimError
from cosim.show import figure, overlay
from cosim.trace import files
from cosim.trace.columns import Held, structured

from .commands import called

NAMES = ["time", "plant.x", "plant.y", "plant.f", "controller.state", "a[1]"]
TIMES = np.linspace(0.0, 1.0, 2001)


def saved(file: str, factor: float = 1.0, unit: str = "m") -> Path:
    """Write a trace whose columns but the last two change."""
    columns = [factor * 1e-3 * TIMES, -1e-3 * TIMES, TIMES**2, 1.0 + (TIMES > 0.5), 0.0 * TIMES]
    table = structured(np.column_stack([TIMES, *columns]), NAMES)
    about = {"units": {"plant.x": unit, "plant.y": "m", "plant.f": "N"}, "simulated_s": 1.0}
    files.save(Held(table), Path(file), {**about, "items": {"controller.state": {"Idle": 1, "Run": 2}}})
    return Path(file)


def texts(file: str) -> list[str]:
    """Texts of an SVG: matplotlib draws letters and leaves the text as a comment."""
    return [unescape(text).strip() for text in re.findall(r"<!-- (.*?) -->", Path(file).read_text())]


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("ending", [".npz", ".csv", ".parquet"])
def test_a_trace_has_a_panel_for_each_unit(ending: str) -> None:
    file = saved(f"x{ending}")
    done = called("plot", str(file))
    assert (done.returncode, done.stdout) == (0, "wrote plot.svg\n"), done.stderr
    found = texts("plot.svg")
    assert {"plant.x", "plant.y", "plant.f", "time (s)", f"x{ending}"} <= set(found)
    assert "a[1]" not in found
    assert ("mm" in found, "Run" in found) == 2 * (ending != ".csv",)


def test_patterns_choose_columns_that_need_not_change() -> None:
    saved("x.npz")
    assert called("plot", "x.npz", "--column", "a[?]", "--column", "*.f", "-o", "y.svg").returncode == 0
    assert {name for name in texts("y.svg") if name in NAMES} == {"plant.f", "a[1]"}


def test_traces_are_overlaid_in_one_unit() -> None:
    saved("one.npz"), saved("two.npz", 1e6, "um"), saved("three.csv")
    done = called("plot", "one.npz", "two.npz", "three.csv", "--column", "plant.x", "-o", "y.svg")
    assert done.returncode == 0, done.stderr
    found = texts("y.svg")
    assert {"one.npz", "two.npz", "three.csv", "plant.x"} <= set(found)
    # 1e-3 m and 1000 um
    assert [unit for unit in ("mm", "m", "km") if unit in found] == ["mm"]


def test_a_long_trace_is_decimated() -> None:
    times = np.arange(200_000.0)
    table = structured(np.column_stack([times, np.sin(times)]), ["time", "x"])
    files.save(Held(table), Path("x.npz"), {})
    assert called("plot", "x.npz").returncode == 0
    assert Path("plot.svg").stat().st_size < 300_000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("x.npz", "--column", "plant.z"), "`--column plant.z` matches no column of the traces\nhint: Use"),
        (("x.npz", "-o", "x.jpg"), "cannot plot to `x.jpg`"),
        (("x.npz", "-o", "no/x.svg"), "cannot write `no/x.svg`: the folder"),
        (("gone.npz",), "cannot read `gone.npz`: No such file or directory"),
        (("x.txt",), "`x.txt` is not a trace"),
        (("x.npz", "other.npz"), "`plant.x` is in `N` in `other.npz` and in `m` in another trace"),
        (("many.npz", "many.npz", "--column", "*"), "the patterns match 30 columns, more than 24 panels"),
        (("time.npz",), "`time.npz` has no column in addition to the time"),
    ],
)
def test_what_cannot_be_plotted_is_one_message(arguments: tuple[str, ...], message: str) -> None:
    saved("x.npz"), saved("other.npz", unit="N")
    for name, count in (("many", 30), ("time", 0)):
        table = structured(np.zeros((1, 1 + count)), ["time", *(f"c{n}" for n in range(count))])
        files.save(Held(table), Path(f"{name}.npz"), {})
    done = called("plot", *arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr
    assert done.stderr.count("error:") == 1


def test_a_figure_leaves_the_backend_of_the_caller(monkeypatch: pytest.MonkeyPatch) -> None:
    # the backend of a notebook draws below its cell
    monkeypatch.setitem(matplotlib.rcParams, "backend", "svg")
    trace = files.read(saved("x.npz"))
    assert figure.plots_requested(True)
    overlay.save([trace], (), Path("x.svg"))
    with pytest.raises(CosimError):
        overlay.save([trace], ["none"], Path("x.svg"))
    assert matplotlib.rcParams["backend"] == "svg"
