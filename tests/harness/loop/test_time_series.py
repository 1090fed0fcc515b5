"""Signals from files: CSV and Parquet, held or interpolated, the same in both engines."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cosim
from cosim.errors import CosimError
from cosim.loop.time_series import sample
from cosim.loop.wires.transform import first_step
from cosim.sweep import study
from cosim.sweep.plan import Plan

Write = Callable[..., Path]
SIGNAL = """
title = "A signal from a file"
loop = {{step = 0.001, duration = 0.006}}
controller = {{fmu = "probe"}}
[[signal]]
to = "{}"
file = "{}"
"""


def scenario(write: Write, to: str = "controller.in", file: str = "x.csv", added: str = "") -> cosim.Scenario:
    return cosim.load(write(added, name="deep/s.toml", text=SIGNAL.format(to, file)))


def driven(write: Write, added: str = "", to: str = "controller.in", file: str = "x.csv") -> list[float]:
    """Return what the FMU got, from both engines."""
    loaded = scenario(write, to, file, added)
    traces = [cosim.run(loaded, engine=engine).trace for engine in ("reference", "native")]
    assert traces[0] is not None
    assert traces[1] is not None
    assert traces[0].tobytes() == traces[1].tobytes()
    return [float(value) for value in traces[0][to]]


@pytest.fixture
def file(folder: Path) -> Path:
    """Write a CSV file next to the scenario, with access to the FMU."""
    (folder / "deep").mkdir()
    os.link(folder / "probe.fmu", folder / "deep" / "probe.fmu")
    csv = folder / "deep" / "x.csv"
    csv.write_text('"time","a","b c"\n0.0,1.0,10\n0.002,3.0,20\n\n0.004,2.0,-5e-1\n')
    return csv


def test_values_are_held_until_the_next(write: Write, file: Path) -> None:
    assert driven(write, 'column = "a"\n') == [1.0, 1.0, 3.0, 3.0, 2.0, 2.0]
    assert driven(write, 'column = "b c"\n') == [10.0, 10.0, 20.0, 20.0, -0.5, -0.5]


def test_values_are_joined_by_lines(write: Write, file: Path) -> None:
    found = driven(write, 'column = "a"\ninterpolation = "linear"\n')
    assert found == pytest.approx([1.0, 2.0, 3.0, 2.5, 2.0, 2.0])


def test_numbers_in_the_scenario_may_be_joined_by_lines_too(write: Write, file: Path) -> None:
    text = SIGNAL.format("controller.in", "").replace('file = ""', "times = [0, 0.004]\nvalues = [0, 4]")
    loaded = cosim.load(write('interpolation = "linear"\n', name="deep/s.toml", text=text))
    trace = cosim.run(loaded).trace
    assert trace is not None
    assert trace["controller.in"] == pytest.approx([0.0, 1.0, 2.0, 3.0, 4.0, 4.0])


@given(
    st.lists(st.floats(0.0, 0.02), min_size=1, max_size=10, unique=True), st.sampled_from([1e-3, 1e-4, 3e-4])
)
def test_a_held_value_begins_with_the_first_step_that_is_not_before_it(
    times: list[float], step: float
) -> None:
    rising = [0.0, *sorted(time for time in times if time > 0.0)]
    expected = np.zeros(30)
    for value, time in enumerate(rising):
        expected[first_step(time, step) :] = value
    assert sample(rising, list(range(len(rising))), step, 30).tolist() == expected.tolist()


def test_a_time_column_may_have_any_name_and_begin_early(write: Write, file: Path) -> None:
    file.write_text("\ufefft, u\n-1.0, 5\n0.003, 6\n", encoding="utf-8")
    assert driven(write) == [5.0, 5.0, 5.0, 6.0, 6.0, 6.0]


def test_switches_and_enumerations_take_words_and_whole_numbers(write: Write, file: Path) -> None:
    file.write_text("time,flag\n0,false\n0.003,TRUE\n")
    assert driven(write, to="controller.flag") == [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
    file.write_text("time,mode\n0,1\n0.003,4\n")
    assert driven(write, to="controller.mode") == [1.0, 1.0, 1.0, 4.0, 4.0, 4.0]


def test_what_fmpy_writes_is_read(write: Write, file: Path) -> None:
    loaded = scenario(write, added='column = "a"\n')
    cosim.run(loaded).save_trace(file.with_name("again.csv"))
    assert driven(write, 'column = "controller.in"\n', file="again.csv") == [1.0, 1.0, 3.0, 3.0, 2.0, 2.0]


@pytest.mark.parametrize(
    "text",
    [
        "time;a\n0;1,5\n0,003;2\n",
        "time;a\n0;1.5\n0.003;2\n",
        "time\ta\n0\t1,5\n3e-3\t2\n",
        '"time";"a"\r\n"0";"1,5"\r\n"0,003";"2"\r\n',
        "time; a\n0; 1.5\n0.003; 2\n",
    ],
)
def test_other_separators_and_decimal_commas_are_read(write: Write, file: Path, text: str) -> None:
    file.write_bytes(text.encode())
    assert driven(write) == [1.5, 1.5, 1.5, 2.0, 2.0, 2.0]


def test_two_rows_at_one_time_are_the_limits_of_a_jump(write: Write, file: Path) -> None:
    file.write_text("time,a\n0,0\n0.002,2\n0.002,10\n0.004,12\n")
    assert driven(write) == [0.0, 0.0, 10.0, 10.0, 12.0, 12.0]
    found = driven(write, 'interpolation = "linear"\n')
    assert found == pytest.approx([0.0, 1.0, 10.0, 11.0, 12.0, 12.0])


@pytest.mark.parametrize("step", [0.1, 0.001, 1 / 60, 1e-4 / 3])
def test_a_jump_has_its_right_limit_in_its_step_whatever_the_rounding(step: float) -> None:
    for k in range(1, 40):
        for time in (k * step, float(f"{k * step:.12g}"), np.nextafter(k * step, 1.0)):
            found = sample([0.0, time, time], [0.0, 0.0, 1.0], step, 41, "linear")
            assert found.tolist() == [0.0] * k + [1.0] * (41 - k)


def test_parquet_is_read(write: Write, file: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    table = pyarrow.table({"a": [1.0, 3.0], "time": [0.0, 0.003], "n": [1, None], "text": ["x", "y"]})
    parquet.write_table(table, file.with_name("x.parquet"))
    assert driven(write, 'column = "a"\n', file="x.parquet") == [1.0, 1.0, 1.0, 3.0, 3.0, 3.0]
    with pytest.raises(CosimError, match=r"x\.parquet`, row 1: time and value must be finite"):
        driven(write, 'column = "n"\n', file="x.parquet")
    with pytest.raises(CosimError, match=r"cannot read numbers from `deep/x\.parquet`"):
        driven(write, 'column = "text"\n', file="x.parquet")


def test_without_pyarrow_the_message_says_what_to_install(
    write: Write, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # whether it was imported before or not
    for module in ("pyarrow", "pyarrow.parquet"):
        monkeypatch.setitem(sys.modules, module, None)
    file.with_name("y.parquet").write_text("")
    hint = r"hint: Run `pip install \"pyarrow>=\d+\"`"
    with pytest.raises(CosimError, match=rf"needs pyarrow.*\n{hint}"):
        driven(write, file="y.parquet")


BROKEN: dict[str, tuple[str | bytes, str]] = {
    "word": ("time,a\n0,1\n0.1,one\n", r"`deep/x.csv`, line 3: `one` is not a number"),
    "cells": ("time,a\n0,1\n\n0.1,1,2\n", r"`deep/x.csv`, line 4 has 3 cells, but the first line has 2"),
    "nan": ("time,a\n0,nan\n", r"`deep/x.csv`, line 2: time and value must be finite"),
    "late": ("time,a\n0.5,1\n", r"line 2: the time starts at `0.5` s, after 0"),
    "falls": ("time,a\n0,1\n2,1\n1,1\n", r"line 4: the time `1` s is before `2` s, the time above it"),
    "thousands": ("time;a\n0;1,000.5\n", r"line 2: `1,000.5` is not a number"),
    "header": ("time,a\n", r"has no values, only a header"),
    "empty": (
        "",
        (
            r"`column` is missing; `.*x.csv` has 0 columns in addition to the time"
            r"\nhint: Put the names of the columns into the first line"
        ),
    ),
    "choice": (
        "time,a,b\n0,1,2\n",
        r"`column` is missing; `.*x.csv` has 2 columns in addition to the time\nhint: Known names: `a`, `b`",
    ),
    "bytes": (b"time,a\n0,\xff\n", r"not a CSV file in UTF-8"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_names_its_line(write: Write, file: Path, name: str) -> None:
    text, reported = BROKEN[name]
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    with pytest.raises(CosimError, match=reported) as raised:
        cosim.run(scenario(write))
    assert "`deep/s.toml`" in raised.value.message


@pytest.mark.parametrize(
    ("to", "added", "reported"),
    [
        ("controller.in", 'column = "c"\n', r"has no column `c`\nhint: Known names: `a`, `b c`"),
        ("controller.in", "times = [0.0]\nvalues = [1.0]\n", "cannot be combined with `times` and `values`"),
        ("controller.in", 'interpolation = "cubic"\n', "it must be `hold` or `linear`"),
        ("controller.mode", 'column = "a"\ninterpolation = "linear"\n', "cannot be interpolated"),
        ("controller.mode", 'column = "a"\n', r"`deep/x.csv`, line 3: `controller.mode` is `3.0`"),
        ("controller.flag", 'column = "b c"\n', r"line 5: `controller.flag` is `-0.5`"),
    ],
)
def test_what_does_not_fit_is_reported(write: Write, file: Path, to: str, added: str, reported: str) -> None:
    with pytest.raises(CosimError, match=reported):
        cosim.run(scenario(write, to, added=added))


def test_a_missing_file_is_reported(write: Write, file: Path) -> None:
    with pytest.raises(CosimError, match=r"the file `none.csv` does not exist\nhint: Searched:"):
        cosim.run(scenario(write, file="none.csv"))


def test_a_sweep_does_a_run_again_when_the_file_has_changed(write: Write, file: Path) -> None:
    write('column = "a"\n', name="deep/s.toml", text=SIGNAL.format("controller.in", "x.csv"))
    cases = file.with_name("study.toml")
    vary = '[[vary]]\nkey = "controller.gain"\nvalues = [1.0, 2.0]\n'
    cases.write_text(f'scenario = "s.toml"\n[design]\nkind = "grid"\n{vary}')
    before = [run.hash for run in Plan(study.load(cases)).runs]
    assert [run.hash for run in Plan(study.load(cases)).runs] == before
    changed = file.with_name("y.csv")
    changed.write_text(file.read_text().replace("3.0", "4.0"))
    changed.replace(file)

    assert {run.hash for run in Plan(study.load(cases)).runs}.isdisjoint(before)


def test_a_signal_of_the_home_is_found_and_what_is_no_file_is_reported(
    write: Write, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(file.parent))
    assert driven(write, 'column = "a"\n', file="~/x.csv")[0] == 1.0
    for name, reported in {
        "~nobody-at-all/x.csv": "does not exist",
        "x" * 300: "does not exist",
        "..": "is not a file",
        "/dev/zero": "is not a file",
    }.items():
        with pytest.raises(CosimError, match=f"the file `{name[:100]}.*` {reported}"):
            driven(write, 'column = "a"\n', file=name)
