"""`Write it with `cosim compare`: traces, results and baselines as a user meets them."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cosim
from cosim.cli import app
from cosim.trace import files
from cosim.trace.columns import Held, structured

from ..conftest import END, SETTLING

Write = Callable[..., Path]
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def command(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run `cosim` in this process: exit code, stdout, stderr."""

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["cosim", *arguments])
        code = app.status_of(app.app)
        return code, *capfd.readouterr()

    return run


def save(file: str, units: dict[str, str] | None = None, items: Any = None, **columns: Any) -> None:
    """Write a trace."""
    table = np.array(list(columns.values()), dtype=float).T
    about = {"units": units or {}, "items": items or {}}
    files.save(Held(structured(table, list(columns))), Path(file), about)


def found(command: Run, *arguments: str) -> tuple[int, dict[str, Any]]:
    """Exit code and JSON of a comparison."""
    code, out, err = command("compare", *arguments, "--json", "-")
    assert code in (0, 1), err
    return code, json.loads(out)


TIME = np.arange(100) / 100.0
WAVE = np.sin(6.0 * TIME) + 0.01


@pytest.mark.usefixtures("folder")
def test_a_trace_is_equal_to_itself_in_either_format(command: Run, write: Write) -> None:
    write(END)
    result = cosim.run(cosim.load("lag.toml"))
    result.save_trace(Path("a.npz"))
    result.save_trace(Path("a.csv"))
    for pair in (("a.npz", "a.npz"), ("a.npz", "a.csv"), ("a.csv", "a.npz")):
        code, out, err = command("compare", *pair)
        assert (code, err) == (0, "")
        assert "columns equal" in out


@pytest.mark.usefixtures("folder")
def test_the_table_shows_column_deviation_time_and_tolerance(command: Run) -> None:
    bent = WAVE.copy()
    bent[40] += 3e-6
    save("a.npz", {"x": "m"}, time=TIME, x=WAVE, y=WAVE)
    save("b.npz", {"x": "m"}, time=TIME, x=bent, y=WAVE)
    code, out, _ = command("compare", "a.npz", "b.npz", "--atol", "x=1e-6")
    assert code == 1
    (line,) = [line for line in out.splitlines() if line.startswith("x ")]
    assert all(word in line for word in ("3 um", "1 um", "0.4 s", "1 of 100", "NO"))
    assert "1 of 2 columns beyond tolerance" in out
    assert command("compare", "a.npz", "b.npz", "--atol", "x=4e-6")[0] == 0
    assert command("compare", "a.npz", "b.npz", "--atol", "1", "--atol", "x=1e-6")[0] == 1
    assert command("compare", "a.npz", "b.npz", "--only", "y")[0] == 0


@pytest.mark.usefixtures("folder")
def test_a_signal_that_is_late_is_within_the_time_shift(command: Run) -> None:
    save("a.npz", time=TIME, x=WAVE)
    save("b.npz", time=TIME, x=np.interp(TIME - 0.02, TIME, WAVE))
    assert found(command, "a.npz", "b.npz")[0] == 1
    assert found(command, "a.npz", "b.npz", "--dt", "0.021")[0] == 0
    assert found(command, "a.npz", "b.npz", "--dt", "0.01")[0] == 1


@pytest.mark.usefixtures("folder")
def test_nan_on_one_side_is_a_difference_at_any_tolerance(command: Run) -> None:
    hole = WAVE.copy()
    hole[7] = np.nan
    save("a.npz", time=TIME, x=WAVE)
    save("b.npz", time=TIME, x=hole)
    for pair in (("a.npz", "b.npz"), ("b.npz", "a.npz")):
        code, answer = found(command, *pair, "--atol", "1e9")
        assert code == 1
        assert (answer["quantities"][0]["at"], answer["quantities"][0]["outside"]) == (0.07, 1)
    assert found(command, "b.npz", "b.npz")[0] == 0
    assert "not a number" in command("compare", "a.npz", "b.npz", "--atol", "1e9")[1]


@pytest.mark.usefixtures("folder")
def test_enumerations_are_shown_by_name(command: Run) -> None:
    off, on = np.zeros(100), (TIME >= 0.5).astype(float)
    items = {"mode": {"Off": 0, "On": 1}}
    save("a.npz", items=items, time=TIME, mode=off)
    save("b.npz", items=items, time=TIME, mode=on)
    (line,) = [
        line for line in command("compare", "a.npz", "b.npz")[1].splitlines() if line.startswith("mode ")
    ]
    assert line.split()[1:3] == ["Off", "On"]
    save("c.npz", items={"mode": {"On": 0, "Off": 1}}, time=TIME, mode=off)
    assert found(command, "a.npz", "c.npz")[1]["differences"] == [
        "`mode` has the items On=0 Off=1, the reference Off=0 On=1"
    ]


@pytest.mark.usefixtures("folder")
def test_another_grid_is_interpolated_and_whole_numbers_are_held(command: Run) -> None:
    mode = np.floor(TIME / 0.3)
    save("a.npz", time=TIME, x=3.0 * TIME + 0.5, mode=mode)
    fine = np.arange(199) / 200.0
    save("b.npz", time=fine, x=3.0 * fine + 0.5, mode=mode[np.floor(fine * 100 + 1e-6).astype(int)])
    code, answer = found(command, "a.npz", "b.npz", "--atol", "1e-12")
    assert (code, answer["differences"]) == (0, [])
    assert "interpolated" in answer["notes"][0]


@pytest.mark.usefixtures("folder")
def test_what_is_missing_or_means_something_else_is_reported(command: Run) -> None:
    save("a.npz", {"x": "m"}, time=TIME, x=WAVE, gone=WAVE)
    save("b.npz", {"x": "mm"}, time=TIME[:50], x=WAVE[:50], new=WAVE[:50])
    code, answer = found(command, "a.npz", "b.npz")
    assert code == 1
    assert answer["differences"] == [
        "the column `gone` is missing",
        "it ends at 0.49 s, the reference at 0.99 s",
        "`x` is in `mm`, the reference in `m`",
    ]
    assert answer["notes"] == ["not in the reference: `new`"]


@pytest.mark.usefixtures("folder")
def test_one_row_less_is_a_difference(command: Run) -> None:
    save("a.npz", time=TIME, x=WAVE)
    save("b.npz", time=TIME[:-1], x=WAVE[:-1])
    assert found(command, "a.npz", "b.npz")[1]["differences"] == [
        "it ends at 0.98 s, the reference at 0.99 s"
    ]


@pytest.mark.usefixtures("folder")
def test_the_plot_shows_the_largest_deviations_relative_to_the_tolerance_first(command: Run) -> None:
    columns = {f"c{index}": WAVE for index in range(8)}
    save("a.npz", {"c7": "m"}, time=TIME, **columns)
    save("b.npz", {"c7": "m"}, time=TIME, **{**columns, "c6": 1.005 * WAVE, "c7": WAVE + 0.1})
    assert command("compare", "a.npz", "b.npz", "--rtol", "0.01", "--dt", "0.01", "--plot", "p.svg")[0] == 1
    # texts are drawn as outlines, each after a comment that holds it
    drawn = re.findall(r"<!-- (c\d.*) -->", Path("p.svg").read_text())
    assert drawn == ["c7 (m)", "c6", "c0", "c1", "c2", "c3"]


CRITERION = '[[criterion]]\nid = "end"\nclaim = "ends"\nmetric = "end"\nmaximum = 0.01\n'


@pytest.mark.usefixtures("folder")
def test_results_differ_in_metrics_and_verdicts(command: Run, write: Write) -> None:
    write(END + CRITERION)
    before = cosim.run(cosim.load("lag.toml", ["controller.gain=0.4"]))
    after = cosim.run(cosim.load("lag.toml", ["controller.gain=0.9"]))
    assert (before.passed, after.passed) == (True, False)
    before.save_json(Path("a.json"))
    after.save_json(Path("b.json"))
    assert found(command, "a.json", "a.json")[0] == 0
    code, answer = found(command, "a.json", "b.json", "--atol", "end=1e-9")
    assert code == 1
    (end,) = answer["quantities"]
    assert end["deviation"] == abs(before.metrics["end"].value - after.metrics["end"].value)
    assert answer["differences"] == ["the criterion `end` failed, but passed in the reference"]
    # only the metrics, and they may differ
    assert found(command, "a.json", "b.json", "--only", "end", "--atol", "1")[0] == 0


def test_a_scenario_is_compared_with_its_baseline(command: Run, write: Write, folder: Path) -> None:
    write(SETTLING + END, "sub/lag.toml")
    (folder / "sub" / "probe.fmu").symlink_to(folder / "probe.fmu")
    (folder / "sub" / "probe_plants.py").symlink_to(folder / "probe_plants.py")
    code, _, err = command("compare", "sub/lag.toml")
    assert code == 2
    assert "sub/lag.baseline.npz" in err
    assert "hint: Write it with `cosim compare sub/lag.toml --update`" in err
    assert command("compare", "sub/lag.toml", "--update")[0] == 0
    assert (folder / "sub" / "lag.baseline.npz").is_file()
    code, out, err = command("compare", "sub/lag.toml")
    assert (code, err) == (0, "")
    assert "`sub/lag.baseline.npz`: " in out
    code, out, _ = command("compare", "sub/lag.toml", "--set", "plant.pole=0.6")
    assert code == 1
    assert "plant.x" in out
    assert command("compare", "sub/lag.toml", "--set", "plant.pole=0.6", "--atol", "1")[0] == 0


def test_a_run_that_fails_is_no_baseline_and_leaves_the_one_before(
    command: Run, write: Write, folder: Path
) -> None:
    write(END + CRITERION)
    assert command("compare", "lag.toml", "--update")[0] == 2
    assert not list(folder.glob("*baseline*"))
    write(END + CRITERION.replace("0.01", "9.0"))
    assert command("compare", "lag.toml", "--update")[0] == 0
    before = (folder / "lag.baseline.npz").read_bytes()
    write(END + CRITERION)
    code, out, err = command("compare", "lag.toml", "--update", "--json", "-")
    assert (code, json.loads(out)["status"]) == (2, "error")
    assert "a run that fails `end` cannot be the baseline" in err
    assert (folder / "lag.baseline.npz").read_bytes() == before


@pytest.mark.usefixtures("folder")
def test_the_json_of_an_update_shows_file_and_result(command: Run, write: Write) -> None:
    write(END)
    code, out, _ = command("compare", "lag.toml", "--update", "--json", "-")
    answer = json.loads(out)
    assert code == 0
    assert Path(answer["baseline"]).samefile("lag.baseline.npz")
    assert answer["metrics"]["end"]["value"] == cosim.run(cosim.load("lag.toml")).metrics["end"].value


@pytest.mark.usefixtures("folder")
def test_a_trace_that_ends_early_is_a_difference_unless_all_its_columns_may(command: Run) -> None:
    gap = np.append(TIME, 3.0)
    save("a.npz", time=TIME, x=WAVE, y=WAVE)
    save("b.npz", time=TIME[:-3], x=WAVE[:-3], y=WAVE[:-3])
    ends = "it ends at 0.96 s, the reference at 0.99 s"
    # the tolerance of one column is none of the other
    for options in ((), ("--dt", "x=0.1")):
        code, answer = found(command, "a.npz", "b.npz", *options)
        assert (code, answer["differences"]) == (1, [ends])
    code, answer = found(command, "a.npz", "b.npz", "--dt", "0.1")
    assert (code, answer["notes"]) == (0, [ends])
    # a gap is no step
    save("c.npz", time=gap, x=np.append(WAVE, 0.0), y=np.append(WAVE, 0.0))
    code, answer = found(command, "c.npz", "a.npz")
    assert (code, answer["differences"]) == (1, ["it ends at 0.99 s, the reference at 3 s"])


def row(run: int, end: float | str, status: str = "passed", **more: Any) -> dict[str, Any]:
    """Row of a sweep."""
    return {
        "run": run,
        "case": run,
        "seed": 100 + run,
        "set": {"plant.pole": run / 10},
        "hash": f"a{run}",
        "status": status,
        "metrics": {"end": end},
        "units": {"end": "m"},
        **more,
    }


def sweep(name: str, rows: list[dict[str, Any]]) -> str:
    """Write the folder of a sweep."""
    Path(name).mkdir()
    (Path(name) / "results.jsonl").write_text("".join(f"{json.dumps(row)}\n" for row in rows))
    return name


@pytest.mark.usefixtures("folder")
def test_sweeps_are_compared_run_by_run_also_when_the_program_changed(command: Run) -> None:
    before = sweep("a", [row(run, 1e-3 * run) for run in range(6)])
    # other hashes, another order
    same = sweep("b", [row(run, 1e-3 * run, hash=f"b{run}") for run in reversed(range(6))])
    assert found(command, before, same)[0] == 0
    moved = [row(run, 1e-3 * run + (1e-5 if run == 4 else 0.0), hash=f"c{run}") for run in range(5)]
    moved[2] = row(2, 0.0, "crashed", hash="c2", metrics={})
    code, answer = found(command, before, sweep("c", [*moved, row(7, 1.0, hash="c7")]), "--atol", "1e-6")
    assert code == 1
    (end,) = answer["quantities"]
    assert (end["at"], end["outside"], end["compared"]) == (4.0, 1, 4)
    assert end["deviation"] == pytest.approx(1e-5)
    assert answer["differences"] == [
        "1 run is missing, the first is run 5 of the reference",
        "1 run is `crashed` instead of `passed`, the first is run 2",
    ]
    assert answer["notes"] == ["1 run is not in the reference"]
    assert "10 um" in command("compare", "a", "c")[1]
    code, _, err = command("compare", "a", sweep("d", [row(9, 1.0, hash="d")]))
    assert code == 2
    assert "no run of `a` is in `d`" in err


@pytest.mark.usefixtures("folder")
def test_the_same_hash_is_the_same_run_and_the_last_row_of_it_counts(command: Run) -> None:
    before = sweep("a", [row(0, 1.0)])
    after = sweep("b", [row(0, 5.0), row(0, "NaN", set={}), row(0, 1.0, set={})])
    assert found(command, before, after)[0] == 0
    assert found(command, before, sweep("c", [row(0, "NaN")]), "--atol", "9")[0] == 1
    assert found(command, before, sweep("d", [row(0, "much")]), "--atol", "9")[0] == 1
    # a changed program leaves the rows of before in the file
    stale = sweep("e", [row(0, 1.0), row(0, 99.0, hash="new")])
    assert found(command, before, stale, "--atol", "9")[0] == 1
    code, _, err = command("compare", sweep("f", [row(0, 0.0, "crashed", metrics={})]), "f")
    assert (code, "no metrics to compare" in err) == (2, True)


WRONG = {
    "missing file": (["gone.npz", "b.npz"], "`gone.npz` does not exist"),
    "another kind": (["a.npz", "r.json"], "is a trace"),
    "unknown ending": (["a.xls", "b.npz"], "`a.xls`"),
    "no number": (["a.npz", "b.npz", "--atol", "x"], "does not end in a number"),
    "negative": (["a.npz", "b.npz", "--atol", "-1"], "out of range"),
    "nan": (["a.npz", "b.npz", "--rtol", "nan"], "out of range"),
    "rtol of 1": (["a.npz", "b.npz", "--rtol", "1"], "below 1"),
    "pattern of nothing": (["a.npz", "b.npz", "--atol", "xx=1"], "`--atol xx` matches none"),
    "only nothing": (["a.npz", "b.npz", "--only", "plant.*"], "`--only plant.*` matches none"),
    "only one file": (["a.npz"], "`a.npz` needs a second file"),
    "update of files": (["a.npz", "b.npz", "--update"], "`OTHER` cannot be combined with `--update`"),
    "limit of an update": (
        ["lag", "--update", "--rtol", "1e-6"],
        "`--rtol` cannot be combined with `--update`",
    ),
    "set of files": (["a.npz", "b.npz", "--set", "a=1"], "`--set` cannot be combined with two files"),
    "dt of results": (["r.json", "r.json", "--dt", "1"], "`--dt` cannot be used with a result"),
    "plot of results": (["r.json", "r.json", "--plot", "p.svg"], "`--plot` cannot be used with a result"),
    "plot ending": (["a.npz", "b.npz", "--plot", "p.doc"], "cannot plot to `p.doc`"),
    "plot nowhere": (["a.npz", "b.npz", "--plot", "no/p.svg"], "cannot write `no/p.svg`"),
    "torn": (["torn.npz", "a.npz"], "`torn.npz` is not a valid trace"),
    "objects": (["objects.npz", "a.npz"], "`objects.npz` is not a valid trace"),
    "about is a list": (["about.npz", "a.npz"], "`about.npz` is not a valid trace"),
    "rows that are none": (["rows", "rows"], "has no rows"),
    "no sweep": (["sub", "sub"], "results.jsonl"),
    "no scenario": (["gone"], "there is no scenario `gone`"),
    "no engine": (["gone", "--engine", "fast"], "there is no engine `fast`"),
}

BROKEN = {
    "text.csv": ("time,x\n0,a\n", "`text.csv` is not a valid trace"),
    "ragged.csv": ("time,x\n0,1\n1\n", "`ragged.csv` is not a valid trace"),
    "empty.csv": ("", "`empty.csv`"),
    "timeless.csv": ("t,x\n0,1\n", "no column `time`"),
    "back.csv": ("time,x\n0,1\n0,1\n", "do not increase"),
    "id.json": ('{"metrics": {}, "criteria": [{"id": [1]}]}', "`id.json` is not a result"),
    "text.json": ("{", "`text.json` is not a result"),
    "list.json": ("[1]", "`list.json` is not a result"),
}
"""Files with their text, and what is wrong with them."""
WRONG |= {name: ([name, name], problem) for name, (_, problem) in BROKEN.items()}


@pytest.mark.parametrize("case", WRONG)
@pytest.mark.usefixtures("folder")
def test_what_cannot_be_compared_is_one_sentence(case: str, command: Run) -> None:
    save("a.npz", time=TIME, x=WAVE)
    save("b.npz", time=TIME, x=WAVE)
    whole = Path("a.npz").read_bytes()
    Path("torn.npz").write_bytes(whole[: len(whole) // 2])
    np.savez("objects.npz", trace=np.zeros(3))
    np.savez("about.npz", trace=np.load("a.npz")["trace"], about="[1]")
    Path("rows").mkdir()
    texts = {
        "rows/results.jsonl": '{"run": "x"}\n[1]\n{"run": 1, "hash": "h", "status": "", "metrics": 3}\n',
        "r.json": '{"metrics": {}, "criteria": []}',
        "a.xls": "",
        **{name: text for name, (text, _) in BROKEN.items()},
    }
    for name, text in texts.items():
        Path(name).write_text(text)
    Path("sub").mkdir()
    arguments, problem = WRONG[case]
    code, out, err = command("compare", *arguments)
    assert (code, out) == (2, "")
    (error,) = [line for line in err.splitlines() if line.startswith("error: ")]
    assert problem in error
    assert "Traceback" not in err
