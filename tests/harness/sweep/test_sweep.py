"""Sweeps from the study file to the tables: the numbers of single runs, resumed after any interruption."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from html import unescape
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

import cosim
from cosim.sweep import summary_tables

from . import studies

Write = Callable[..., Path]


@pytest.fixture
def study(write: Write, folder: Path) -> Path:
    """Write the lag and a study of twelve runs."""
    write(studies.MEASURED)
    (folder / "grid.toml").write_text(studies.GRID)
    return folder / "grid.sweep"


def test_every_run_gives_the_numbers_of_a_single_run(study: Path) -> None:
    done = studies.sweep("grid.toml", "--workers", "2")
    assert done.stderr == ""
    rows = studies.rows(study)
    assert [row["run"] for row in rows] == list(range(12))
    assert len({row["seed"] for row in rows}) == 12
    for row in rows[::5]:
        changes = [f"{key}={value}" for key, value in row["set"].items()]
        single = cosim.run(cosim.load("lag.toml", changes), row["seed"])
        assert row["metrics"] == {"end": single.metrics["end"].value}
        assert row["units"] == {"end": "m"}
        assert row["status"] == ("passed" if single.passed else "failed")
    assert done.returncode == (0 if set(studies.statuses(study)) == {"passed"} else 1)


def test_one_worker_four_workers_and_a_resumed_sweep_give_the_same_rows(study: Path, folder: Path) -> None:
    studies.sweep("grid.toml", "--workers", "1")
    studies.sweep("grid.toml", "--workers", "4", "--out", "four")
    assert studies.numbers(study) == studies.numbers(folder / "four")

    # the last line is torn, and two before it are gone
    file = study / "results.jsonl"
    lines = file.read_bytes().splitlines(keepends=True)
    torn = lines[-1][: len(lines[-1]) // 2]
    file.write_bytes(b"".join(lines[:-3]) + torn)
    again = studies.sweep("grid.toml", "--workers", "2")
    assert "line 10 is not a row (" in again.stderr
    assert file.read_bytes().splitlines()[9] == torn
    file.write_bytes(file.read_bytes().replace(torn + b"\n", b""))
    assert studies.numbers(study) == studies.numbers(folder / "four")
    assert len(file.read_text().splitlines()) == 12

    # nothing is left to do
    before = file.read_bytes()
    studies.sweep("grid.toml")
    assert file.read_bytes() == before


def test_a_larger_study_does_only_what_is_new(study: Path, folder: Path) -> None:
    studies.sweep("grid.toml")
    before = (study / "results.jsonl").read_text()
    larger = studies.GRID.replace("values = [0.2, 0.4]", "values = [0.2, 0.4, 0.6]")
    (folder / "grid.toml").write_text(larger)
    studies.sweep("grid.toml")
    after = (study / "results.jsonl").read_text()
    assert after.startswith(before)
    assert len(after.splitlines()) == 18


def test_another_fmu_makes_all_runs_again(study: Path, folder: Path) -> None:
    studies.sweep("grid.toml")
    # a zip file may end with a comment: another file, the same FMU
    with (folder / "probe.fmu").open("r+b") as file:
        file.seek(-2, os.SEEK_END)
        file.write(b"\x01\x00!")
    studies.sweep("grid.toml")
    assert len((study / "results.jsonl").read_text().splitlines()) == 24


def test_tables_hold_all_runs_and_traces_the_worst(study: Path, folder: Path) -> None:
    traces = '\n[traces]\nworst = 1\nfailed = 0\nmetric = "end"\n'
    (folder / "grid.toml").write_text(studies.GRID + traces)
    done = studies.sweep("grid.toml")
    rows = studies.rows(study)
    with (study / "summary.csv").open(newline="") as lines:
        table = list(csv.DictReader(lines))
    assert [float(line["metric.end"]) for line in table] == [row["metrics"]["end"] for row in rows]
    assert [float(line["plant.pole"]) for line in table] == [row["set"]["plant.pole"] for row in rows]
    parquet = pyarrow.parquet.read_table(study / "summary.parquet").to_pydict()
    assert parquet["metric.end"] == [row["metrics"]["end"] for row in rows]
    assert parquet["criterion.end"] == [row["criteria"]["end"] for row in rows]

    worst = max(rows, key=lambda row: row["metrics"]["end"])
    (file,) = (study / "traces").iterdir()
    assert file.name == f"{worst['run']:06d}-{worst['hash'][:8]}.npz"
    trace = np.load(file)["trace"]
    assert trace["plant.x"][-1] + trace["plant.random"][-1] == worst["metrics"]["end"]
    assert f"--seed {worst['seed']}" in done.stdout
    assert f"12 of 12 runs: {studies.statuses(study).count('passed')} passed" in done.stdout


def test_plots_that_cannot_start_are_reported_before_the_first_run(study: Path) -> None:
    command = [sys.executable, "-m", "cosim", "sweep", "grid.toml"]
    variables = studies.environment(MPLBACKEND="nope")
    done = subprocess.run(command, capture_output=True, text=True, env=variables, check=False)
    assert done.returncode == 2
    assert "error: matplotlib does not start: " in done.stderr
    assert not (study / "results.jsonl").exists()


def test_the_summary_as_json_counts_and_plots_are_drawn(study: Path, folder: Path) -> None:
    traces = '\n[traces]\nworst = 1\nfailed = 0\nmetric = "end"\n'
    (folder / "grid.toml").write_text(studies.GRID + traces)
    command = [sys.executable, "-m", "cosim", "sweep", "grid.toml", "--json", "-"]
    variables = {**os.environ, "PYTHONPATH": str(studies.ROOT)}
    done = subprocess.run(command, capture_output=True, text=True, env=variables, check=False)
    summary = json.loads(done.stdout)
    passed = studies.statuses(study).count("passed")
    assert (summary["runs"], summary["statuses"].get("passed", 0)) == (12, passed)
    assert summary["metrics"]["end"]["unit"] == "m"
    # a grid is no random sample: its rate has no confidence interval
    assert summary["success"] == {"rate": passed / 12}
    assert (study / "summary.svg").read_text().startswith("<?xml")
    (file,) = (study / "traces").glob("*.svg")
    assert file.read_text().startswith("<?xml")


def test_a_plot_that_cannot_be_made_loses_no_row(study: Path, folder: Path) -> None:
    with (folder / "lag.toml").open("a") as file:
        file.write('\n[[plot.panels]]\ncolumns = ["plant.y"]\n')
    traces = '\n[traces]\nworst = 1\nfailed = 0\nmetric = "end"\n'
    (folder / "grid.toml").write_text(studies.GRID + traces)
    command = [sys.executable, "-m", "cosim", "sweep", "grid.toml"]
    variables = {**os.environ, "PYTHONPATH": str(studies.ROOT)}
    done = subprocess.run(command, capture_output=True, text=True, env=variables, check=False)
    problem = "`plot.panels[0].columns` names `plant.y`, which is not a column of the trace"
    assert f"is not plotted: {problem}" in " ".join(done.stderr.split())
    assert done.returncode == 1
    assert len(studies.rows(study)) == 12
    assert [file.suffix for file in (study / "traces").iterdir()] == [".npz"]


def reported(file: Path) -> list[str]:
    """Texts of a figure: matplotlib draws letters and leaves the text as a comment."""
    return [unescape(text).strip() for text in re.findall(r"<!-- (.*?) -->", file.read_text())]


def test_a_plot_shows_texts_and_shows_what_it_leaves_out(
    study: Path, write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lowest = (
        '[[metric]]\nname = "lowest"\nunit = "m"\nvalue = "last(plant.x)"\n[[criterion]]\nid = "lowest"\n'
    )
    write(f'{studies.MEASURED}{lowest}claim = "c"\nmetric = "lowest"\nequals = 1\n')
    key = '{key = "controller.label", values = ["Slow", "Fast"]},\n    {key = "plant.pole"'
    (folder / "grid.toml").write_text(studies.GRID.replace('{key = "plant.pole"', key))
    monkeypatch.setattr(summary_tables, "MAX_KEYS", 2)
    monkeypatch.setattr(summary_tables, "MAX_METRICS", 1)
    cosim.sweep("grid.toml", plots=True)
    texts = reported(study / "summary.svg")
    assert "and 1 more metric, and 1 more key" in texts
    assert {"Slow", "Fast"} <= set(texts)


def test_the_points_of_a_plot_are_pixels(study: Path) -> None:
    cosim.sweep("grid.toml", plots=True)
    # without it, each point is an element `use` of its own, and a file of 10,000 runs has 26 MB
    points = re.findall(r"<image|<use [^>]*style=\"fill: #1f77b4", (study / "summary.svg").read_text())
    assert "<image" in points
    assert set(points) == {"<image"}


def test_cases_may_share_the_noise_of_their_repeats(study: Path, folder: Path) -> None:
    (folder / "grid.toml").write_text(studies.GRID.replace("repeats = 2", 'repeats = 2\nseeds = "repeat"'))
    studies.sweep("grid.toml")
    seeds = [row["seed"] for row in studies.rows(study)]
    assert seeds == seeds[:2] * 6


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_keeps_results_and_the_next_call_continues(number: int, write: Write, folder: Path) -> None:
    write(studies.MEASURED)
    cases = ["controller.gain = 0.1", "controller.hang_at = 3", "controller.gain = 0.2"]
    (folder / "list.toml").write_text(studies.case_list(cases))
    command = [sys.executable, "-m", "cosim", "sweep", "list.toml", "--workers", "1", "--no-plots"]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(studies.ROOT)},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    results = folder / "list.sweep" / "results.jsonl"
    studies.wait_for(lambda: results.exists() and results.read_bytes().count(b"\n") == 1)
    other = studies.sweep("list.toml")
    assert (other.returncode, "another sweep writes" in other.stderr) == (2, True)
    process.send_signal(number)
    stdout, stderr = process.communicate(timeout=30)
    assert (process.returncode, stdout, stderr.splitlines()[-1]) == (130, "", "error: interrupted")
    assert studies.statuses(folder / "list.sweep") == ["passed"]
    assert len((folder / "list.sweep" / "summary.csv").read_text().splitlines()) == 2

    # the case that hangs is taken out, the others go on
    (folder / "list.toml").write_text(studies.case_list([cases[0], cases[2]]))
    assert studies.sweep("list.toml").returncode == 0
    assert len(results.read_text().splitlines()) == 2


def test_a_sweep_of_which_no_run_gives_a_result_could_not_run(write: Write, folder: Path) -> None:
    write(studies.MEASURED.replace("last(plant.x)", "last(plant.y)"))
    (folder / "grid.toml").write_text(studies.GRID)
    done = studies.sweep("grid.toml", "--quiet")
    assert done.returncode == 2
    assert "12 of 12 runs: 12 error" in done.stdout
    error, *_ = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    assert "none of the 12 runs gave a result; the first: `lag.toml`: `metric.end.value`" in error
    assert len(studies.rows(folder / "grid.sweep")) == 12
