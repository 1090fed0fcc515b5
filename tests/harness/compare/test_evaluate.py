"""`cosim evaluate`: a stored trace gives the numbers of its run, and new ones for new criteria."""

from __future__ import annotations

import json
import logging
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import cosim
from cosim.cli import app
from cosim.errors import CosimError

from ..conftest import END, entry

Write = Callable[..., Path]

JUDGED = (
    END
    + entry("metric", name="active", value="mean(controller.mode == 'Off')")
    + entry("metric", name="last", value="at(controller.out, 0.02)")
    + entry("metric", name="top", value="max(plant.x)")
    + entry("criterion", id="end", claim="ends low", metric="end", maximum=1.5)
)


@pytest.fixture
def stored(write: Write, folder: Path) -> Path:
    """Write the scenario, a variant, and the trace of its run."""
    write(JUDGED)
    cosim.run(cosim.load("lag.toml")).save_trace(folder / "lag.npz")
    return folder / "lag.npz"


def test_a_stored_trace_gives_the_numbers_of_its_run(stored: Path) -> None:
    scenario = cosim.load("lag.toml", ["loop.seed=3"])
    result = cosim.run(scenario)
    result.save_trace(stored)
    again = cosim.evaluate(scenario, cosim.read_trace(stored))
    assert again.metrics == result.metrics
    assert again.metrics["top"].unit == "m"
    assert again.criteria == result.criteria
    assert (again.seed, again.passed) == (3, result.passed)
    assert again.simulated_s == result.simulated_s


def test_a_csv_file_takes_items_and_units_from_the_fmu(stored: Path) -> None:
    scenario = cosim.load("lag.toml")
    result = cosim.run(scenario)
    result.save_trace(stored.with_suffix(".csv"))
    again = cosim.evaluate(scenario, cosim.read_trace(stored.with_suffix(".csv")))
    values = {name: metric.value for name, metric in result.metrics.items()}
    assert {name: metric.value for name, metric in again.metrics.items()} == values
    # what the plant's columns are in is unknown
    assert [again.metrics[name].unit for name in ("last", "top")] == ["m", ""]
    assert again.simulated_s == pytest.approx(result.simulated_s)


def test_a_limit_in_a_unit_needs_one_of_the_number(stored: Path) -> None:
    demand = ["criterion.end.metric=top", "criterion.end.unit=mm", "criterion.end.maximum=1.0"]
    scenario = cosim.load("lag.toml", demand)
    result = cosim.run(scenario)
    assert result.passed is False
    result.save_trace(stored.with_suffix(".csv"))
    found = cosim.read_trace(stored.with_suffix(".csv"))
    with pytest.raises(
        CosimError, match=r"`criterion.end.unit` is `mm`, `lag.csv` has no units.*`metric.top`"
    ):
        cosim.evaluate(scenario, found)
    reported = cosim.load("lag.toml", [*demand, "metric.top.unit=m"])
    assert cosim.evaluate(reported, found).criteria == result.criteria


def test_only_metrics_and_criteria_count(stored: Path) -> None:
    run = cosim.run(cosim.load("lag.toml"))
    end = run.metrics["end"].value
    changed = cosim.load("lag.toml", ["plant.pole=0.9", f"criterion.end.maximum={end / 2.0}"])
    again = cosim.evaluate(changed, cosim.read_trace(stored))
    assert again.metrics["end"].value == end
    assert (run.passed, again.passed) == (True, False)


def test_the_command_evaluates_without_a_run(stored: Path, folder: Path) -> None:
    (folder / "probe_plants.py").write_text("raise SystemExit('nothing is to be run')")
    command = [sys.executable, "-m", "cosim", "evaluate", "lag.npz", "lag.toml"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert "evaluated from a stored trace" in done.stdout
    options = ["--set", "criterion.end.maximum=-1", "--json", "-"]
    done = subprocess.run([*command, *options], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 1
    assert json.loads(done.stdout)["engine"] == "stored"
    scenario = folder / "lag.toml"
    scenario.write_text(scenario.read_text().partition("[[criterion]]")[0])
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, "no criteria" in done.stdout) == (0, True)


def test_a_column_that_the_trace_does_not_have_is_named(stored: Path) -> None:
    scenario = cosim.load("lag.toml", ["metric.end.value='last(plant.why)'"])
    with pytest.raises(
        CosimError, match=r"names `plant.why`, which is not a known column of the trace `lag.npz`"
    ):
        cosim.evaluate(scenario, cosim.read_trace(stored))


def test_a_trace_of_another_loop_is_reported(
    stored: Path, folder: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "other.toml").write_text((folder / "lag.toml").read_text())
    monkeypatch.setattr(logging.getLogger("cosim"), "propagate", True)
    cosim.evaluate(cosim.load("other.toml"), cosim.read_trace(stored))
    assert "is a trace of `lag`; it is evaluated as a trace of `other`" in caplog.text


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["gone.npz", "lag.toml"], "cannot read `gone.npz`"),
        (["lag.npz", "gone"], "there is no scenario `gone`"),
        (["lag.npz", "lag.toml", "--set", "metric.end.value='plant.x'"], "gives 50 values, not one"),
        (["lag.npz", "lag.toml", "--json", "no/a.json"], "cannot write `no/a.json`"),
        (["lag.toml", "lag.toml"], "`lag.toml` is not a trace"),
    ],
)
@pytest.mark.usefixtures("stored")
def test_what_cannot_be_evaluated_is_one_sentence(
    arguments: list[str], problem: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", ["cosim", "evaluate", *arguments])
    assert app.status_of(app.app) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("error: ")
    assert problem in err.splitlines()[0]


def test_what_a_file_shows_wrongly_is_not_taken(stored: Path) -> None:
    trace = np.load(stored)["trace"]
    about = {"seed": "x", "simulated_s": [], "scenario": 3, "units": {"plant.x": 1}, "items": {"a": 2}}
    np.savez(stored, trace=trace, about=json.dumps(about))
    again = cosim.evaluate(cosim.load("lag.toml", ["metric.active.value='0'"]), cosim.read_trace(stored))
    assert again.seed == 1
    assert again.simulated_s == pytest.approx(0.05)
