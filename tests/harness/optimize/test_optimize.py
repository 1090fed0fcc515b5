"""`cosim optimize`: optima that are known, the same trials after any interruption, and what a user sees."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cosim
from cosim.cli import app
from cosim.optimize import problem, search
from cosim.optimize.search import Proposer, Runner
from cosim.optimize.variants import Variants
from cosim.study.store import Store

from ..conftest import END, entry
from ..sweep import studies

Write = Callable[..., Path]
Run = Callable[..., tuple[int, str, str]]

LOOP = (
    END
    + entry("metric", name="off", value="(last(plant.x) - 0.5) ** 2")
    + entry("criterion", id="end", claim="does not end low", metric="end", minimum=0.3)
)
"""Ends the lag scenario, whose state decays by `pole + (1 - pole) gain` in each step."""
SET = "[set]\nloop.duration = 0.005\nloop.compute_delay = 0\n"
"""Four steps lie between the first and the last row, nothing is late."""
GAIN = '[[vary]]\nkey = "controller.gain"\nminimum = 0.0\nmaximum = 1.0\n'


def gain_at(end: float, pole: float = 0.5) -> float:
    """Gain at which the state ends there."""
    return float((end**0.25 - pole) / (1.0 - pole))


def study(wanted: str, vary: str = GAIN, trials: int = 40, more: str = "") -> Path:
    """Write an optimization of the lag."""
    Path("o.toml").write_text(
        f'scenario = "lag.toml"\n{SET}[objective]\n{wanted}\n[search]\ntrials = {trials}\n{more}\n{vary}'
    )
    return Path("o.toml")


@pytest.fixture
def command(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, write: Write) -> Run:
    """Run `cosim optimize o.toml` in this process: exit code, stdout, stderr."""
    write(LOOP)

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["cosim", "optimize", "o.toml", "--workers", "1", *arguments])
        code = app.status_of(app.app)
        return code, *capfd.readouterr()

    return run


def found(command: Run, *arguments: str) -> dict[str, Any]:
    """JSON of an optimization that found something."""
    code, out, err = command(*arguments, "--json", "-")
    assert code == 0, err
    best: dict[str, Any] = json.loads(out)
    return best


def history(folder: str = "o.optimize") -> list[list[str]]:
    """Rows of `trials.csv`."""
    with (Path(folder) / "trials.csv").open(newline="") as lines:
        return list(csv.reader(lines))


def test_the_optimum_of_a_metric_is_found(command: Run) -> None:
    study('metric = "off"')
    best = found(command)
    assert best["best"]["set"]["controller.gain"] == pytest.approx(gain_at(0.5), abs=0.02)
    assert (best["objective"], best["trials"]) == ("off", 40)
    code, out, _ = command()
    assert code == 0
    assert "minimum of off" in out
    # the command that is shown repeats the value
    (line,) = [line for line in out.splitlines() if line.startswith("repeat it with")]
    options = [word for word in line.split() if "=" in word]
    again = cosim.run(cosim.load("lag.toml", options))
    assert again.metrics["off"].value == best["best"]["value"]


@pytest.mark.parametrize(("direction", "end"), [("minimize", 0.3), ("maximize", 1.0)])
def test_criteria_are_constraints(command: Run, direction: str, end: float) -> None:
    study(f'metric = "end"\ndirection = "{direction}"')
    best = found(command)
    assert best["best"]["value"] == pytest.approx(end, abs=0.02)
    assert best["best"]["value"] >= 0.3
    assert 0 < best["feasible"] < 40 or direction == "maximize"


def test_python_gives_the_trials_of_the_command(command: Run) -> None:
    study('metric = "end"\ndirection = "maximize"', trials=10)
    code, out, _ = command()
    assert code == 0
    assert out.endswith("wrote o.optimize\n")
    result = cosim.optimize("o.toml", "again", workers=1)
    assert history() == history("again")
    assert (result.folder, len(result.trials)) == (Path("again"), 10)
    assert result.best in result.trials
    assert f"repeat it with: {result.command}\n" in out
    assert result.verdict in result._repr_html_()
    assert repr(result) == f"<OptimizeResult of o: {result.verdict}>"


def test_no_trial_that_holds_the_criteria_is_exit_code_1(command: Run) -> None:
    study('metric = "end"', GAIN.replace("maximum = 1.0", "maximum = 0.1"), trials=9)
    code, out, err = command()
    assert code == 1
    assert "error" not in err
    largest = max(history()[1:], key=lambda row: float(row[1]))
    assert (
        f"closest is trial {largest[0]}, which fails `end`; 9 trials, 0 of them passed all criteria"
        in " ".join(out.split())
    )
    assert json.loads(command("--json", "-")[1])["best"] is None


VALUES = """
[[vary]]
key = "plant.label"
values = ["a", "b"]
[[vary]]
key = "plant.nan_at"
minimum = 5
maximum = 50
integer = true
distribution = "log-uniform"
"""


def test_values_integers_and_logarithmic_ranges(command: Run) -> None:
    study('metric = "off"', GAIN + VALUES, trials=12)
    best = found(command)["best"]["set"]
    assert best["plant.label"] in ("a", "b")
    assert isinstance(best["plant.nan_at"], int)
    labels = {row[2] for row in history()[1:]}
    assert labels == {"a", "b"}


def test_a_search_that_is_stopped_anywhere_continues_to_the_same_trials(
    command: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    study('metric = "end"', trials=22, more="batch = 4")
    found(command, "--out", "whole")
    runs: list[int] = []
    original = Runner.do

    def counted(runner: Runner, wanted: Any, store: Store) -> None:
        missing = [run for run in wanted if not store.status(run.hash)]
        runs.append(len(missing))
        if len(runs) == 3:
            raise KeyboardInterrupt
        original(runner, wanted, store)

    monkeypatch.setattr(Runner, "do", counted)
    assert command()[0] == 130
    file = Path("o.optimize/results.jsonl")
    lines = file.read_bytes().splitlines(keepends=True)
    assert len(lines) == 8
    # killed in the middle of the second batch, and of a row
    file.write_bytes(b"".join(lines[:6]) + lines[6][:40])
    runs[:] = [0, 0, 0]
    found(command)
    assert runs[3:] == [0, 2, 4, 4, 4, 2]
    assert history() == history("whole")
    # all is done: no run, the same answer
    runs[:] = [0, 0, 0]
    found(command)
    assert sum(runs) == 0
    # more trials only add to them
    study('metric = "end"', trials=30, more="batch = 4")
    found(command)
    assert sum(runs) == 8
    assert history()[:23] == history("whole")


@pytest.mark.skipif(sys.platform != "linux", reason="signals of Linux")
def test_a_kill_in_the_middle_of_a_batch_costs_only_what_was_under_way(command: Run) -> None:
    study('metric = "end"', trials=6, more="batch = 6")
    file = Path("o.toml")
    file.write_text(file.read_text().replace(SET, SET + "plant.stall_at = 3\n"))
    # one of its six runs never ends, the first time
    line = [sys.executable, "-m", "cosim", "optimize", "o.toml", "--workers", "2"]
    process = subprocess.Popen(line, env=studies.environment(), stderr=subprocess.DEVNULL)
    results = Path("o.optimize/results.jsonl")
    try:
        studies.wait_for(lambda: results.exists() and results.read_bytes().count(b"\n") == 5)
    finally:
        process.kill()
        process.wait()
    before = results.read_bytes()
    found(command)
    assert results.read_bytes().startswith(before)
    assert results.read_bytes().count(b"\n") == 6
    found(command, "--out", "whole")
    assert history() == history("whole")


@pytest.mark.skipif(sys.platform != "linux", reason="signals of Linux")
def test_a_run_that_crashes_or_hangs_costs_its_trial_only(command: Run) -> None:
    values = "".join(
        f'[[vary]]\nkey = "controller.{key}_at"\nvalues = [-1, 3]\n' for key in ("crash", "hang")
    )
    study('metric = "end"', GAIN + values + "[limits]\ntimeout = 2.0\n", trials=5, more="batch = 5")
    assert found(command)["best"]["set"]["controller.crash_at"] == -1
    reported = {(row[2], row[3]): row[-1] for row in history()[1:]}
    assert "killed by SIGSEGV" in reported["3", "-1"]
    assert "no result within `limits.timeout` = `2` s" in reported["-1", "3"]
    assert reported["-1", "-1"] == ""


def test_trials_do_not_depend_on_the_number_of_workers(command: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    study('metric = "end"', trials=8, more="batch = 4\nseeds = [3, 4]")
    found(command)
    monkeypatch.setenv("PYTHONPATH", str(Path.cwd()))
    assert command("--workers", "2", "--out", "two")[0] == 0
    assert history() == history("two")
    assert len(Path("o.optimize/results.jsonl").read_text().splitlines()) == 16


def test_another_seed_gives_other_trials_and_a_changed_scenario_new_runs(command: Run, write: Write) -> None:
    study('metric = "end"', trials=4)
    found(command)
    before = history()
    # a limit changes no run of the first batch, a metric changes all
    write(LOOP.replace("minimum = 0.3", "minimum = 0.2"))
    found(command)
    assert len(Path("o.optimize/results.jsonl").read_text().splitlines()) == 4
    write(LOOP.replace("0.5) ** 2", "0.4) ** 2"))
    found(command)
    assert len(Path("o.optimize/results.jsonl").read_text().splitlines()) == 8
    file = Path("o.toml")
    file.write_text("seed = 2\n" + file.read_text())
    found(command)
    assert {row[1] for row in history()[1:]}.isdisjoint(row[1] for row in before[1:])


def test_a_run_without_result_costs_its_trial_only(command: Run) -> None:
    study('metric = "end"', GAIN + '[[vary]]\nkey = "plant.fail_at"\nvalues = [-1, 2]\n', trials=16)
    best = found(command)
    assert best["best"]["set"]["plant.fail_at"] == -1
    reasons = [row[-1] for row in history()[1:]]
    assert any("failed on request" in reason for reason in reasons)
    assert "without a result" in command()[1]


def test_a_plant_parameter_is_recovered_from_a_measured_trace(command: Run) -> None:
    true = cosim.run(cosim.load("lag.toml", ["plant.pole=0.37", "controller.gain=0.2"]))
    assert true.trace is not None
    rows = true.trace[1:30:3]
    # a measurement with its own times, one gap, and less columns
    measured = np.column_stack([rows["time"], rows["plant.x"]])
    measured[4, 1] = np.nan
    np.savetxt("measured.csv", measured, delimiter=",", header="time,plant.x", comments="")
    vary = '[[vary]]\nkey = "plant.pole"\nminimum = 0.0\nmaximum = 0.9\n'
    file = study('trace = "measured.csv"', vary, trials=60)
    file.write_text(file.read_text().replace(SET, "[set]\ncontroller.gain = 0.2\n"))
    best = found(command)["best"]
    assert best["set"]["plant.pole"] == pytest.approx(0.37, abs=0.01)
    assert best["value"] < 1e-3
    assert "of a standard deviation" in command()[1]


def test_the_example_identifies_the_mass_of_a_slide(folder: Path) -> None:
    example = studies.ROOT / "studies" / "dob-identify.toml"
    found = cosim.optimize(example, workers=2).best
    assert found is not None
    # the mass of the slide in the file, within the uncertainty that its noise leaves
    assert found.values["plant.mass"] == pytest.approx(12.7, rel=0.02)


def test_the_true_value_has_no_misfit(command: Run) -> None:
    cosim.run(cosim.load("lag.toml", ["plant.pole=0.4"])).save_trace(Path("m.npz"))
    vary = '[[vary]]\nkey = "plant.pole"\nvalues = [0.1, 0.4, 0.8]\n'
    file = study('trace = "m.npz"\ncolumns = ["plant.x", "controller.out"]', vary, trials=10)
    file.write_text(file.read_text().replace(SET, ""))
    best = found(command)["best"]
    assert (best["set"], best["value"]) == ({"plant.pole": 0.4}, 0.0)


def test_a_run_that_ends_before_what_was_measured_is_no_fit(command: Run) -> None:
    cosim.run(cosim.load("lag.toml", ["plant.pole=0.4"])).save_trace(Path("m.npz"))
    vary = '[[vary]]\nkey = "plant.pole"\nvalues = [0.1, 0.4, 0.8]\n'
    file = study('trace = "m.npz"\ncolumns = ["plant.x"]', vary, trials=10)
    # what comes before the end is the same, and what is held after it may be near
    file.write_text(file.read_text().replace(SET, '[set]\nloop.stop_when = "time >= 0.02"\n'))
    code, _, err = command()
    assert code == 2
    assert "gave a number; the first: `misfit` is inf: the run ended before the measured trace" in err


WRONG = {
    "no objective": ("", GAIN, "`objective` needs one of `metric` and `trace`"),
    "two": ('metric = "end"\ntrace = "m.csv"', GAIN, "needs one of"),
    "unknown metric": ('metric = "ende"', GAIN, "`objective.metric` = `ende`"),
    "unknown direction": ('metric = "end"\ndirection = "down"', GAIN, "`objective.direction`"),
    "unknown key": ('metric = "end"', GAIN.replace("gain", "gian"), "gian"),
    "end out of range": (
        'metric = "end"',
        GAIN.replace("controller.gain", "plant.pole").replace("1.0", "1.5"),
        "plant.pole",
    ),
    "no range": ('metric = "end"', GAIN.replace("maximum = 1.0", ""), "needs `minimum` and `maximum`"),
    "points": ('metric = "end"', GAIN + "points = 3\n", "points"),
    "normal": ('metric = "end"', GAIN + 'distribution = "normal"\nmean = 1\ndeviation = 1\n', "`normal`"),
    "twice": ('metric = "end"', GAIN + GAIN, "is given twice"),
    "nothing varies": ('metric = "end"', "vary = []\n", "vary"),
    "list of lists": ('metric = "end"', '[[vary]]\nkey = "plant.label"\nvalues = [[1]]\n', "values"),
    "nan": ('metric = "end"', '[[vary]]\nkey = "plant.pole"\nvalues = [0.5, nan]\n', "which is not finite"),
    "no trials": ('metric = "end"', "trials = 0\n", "search.trials"),
    "no seeds": ('metric = "end"', "seeds = []\n", "`search.seeds` is empty"),
    "the seed": ('metric = "end"', GAIN + '[[vary]]\nkey = "loop.seed"\nvalues = [1, 2]\n', "`loop.seed`"),
    "no measured trace": ('trace = "gone.csv"', GAIN, "gone.csv"),
    "unknown column": ('trace = "m.csv"\ncolumns = ["plant.y"]', GAIN, "`plant.y`"),
    "column of no run": (
        'trace = "m.csv"',
        GAIN,
        "the column `speed`, which is not in the trace of a run",
    ),
    "nothing measured": ('trace = "none.csv"', GAIN, "`plant.x` in `none.csv` holds no finite number"),
    "measured beyond all": ('trace = "vast.csv"', GAIN, "`vast.csv` ranges from -1e+308 to 1e+308"),
    "empty trace": ('trace = "empty.csv"', GAIN, "its first line must hold the names of the columns"),
    "too long": ('trace = "long.csv"', GAIN, "`long.csv` ends at 1 s, the scenario at"),
    "columns of a metric": ('metric = "end"\ncolumns = ["plant.x"]', GAIN, "belongs to `objective.trace`"),
    "a study": ('metric = "end"', '[design]\nkind = "grid"\n' + GAIN, "`design` belongs to a study"),
    "all fail": (
        'metric = "end"',
        GAIN + '[[vary]]\nkey = "plant.fail_at"\nvalues = [1]\n',
        "failed on request",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_one_sentence(case: str, command: Run) -> None:
    wanted, vary, message = WRONG[case]
    Path("m.csv").write_text("time,speed\n0,1\n0.001,2\n")
    Path("none.csv").write_text("time,plant.x\n0,nan\n0.001,inf\n")
    Path("vast.csv").write_text("time,plant.x\n0,-1e308\n0.001,1e308\n")
    Path("empty.csv").touch()
    Path("long.csv").write_text("time,plant.x\n0,1\n1,2\n")
    if vary.startswith("trials"):
        study(wanted, GAIN, trials=0)
    elif vary.startswith("seeds"):
        study(wanted, GAIN, more=vary)
    elif vary.startswith("vary"):
        Path("o.toml").write_text(f'scenario = "lag.toml"\n{vary}[objective]\n{wanted}\n')
    else:
        study(wanted, vary, trials=8)
    code, out, err = command()
    assert (code, out) == (2, "")
    error = [line for line in err.splitlines() if line.startswith("error: ")]
    assert len(error) == 1
    assert message in error[0]
    assert "Traceback" not in err


def test_proposals_follow_from_the_trials_before_alone(command: Run) -> None:
    study('metric = "end"', trials=16, more="batch = 4")
    variants = Variants(problem.load(Path("o.toml")))
    with Store(Path("one")) as store:
        trials = search.search(variants, store, workers=1)
    proposer = Proposer(variants.problem)
    for begin in range(0, 16, 4):
        batch = [proposer.propose(number) for number in range(begin, begin + 4)]
        assert batch == [trial.values for trial in trials[begin : begin + 4]]
        # in another order
        for trial in reversed(trials[begin : begin + 4]):
            proposer.report(trial)
