"""Studies: the cases of their designs; every mistake gives an error before any run."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cosim.cli import main
from cosim.study.parameters import Vary
from cosim.sweep import study
from cosim.sweep.designs import DESIGNS, levels

from . import studies

Write = Callable[..., Path]
Refused = Callable[[list[str], str], None]

LINEAR = Vary("a", minimum=-1.0, maximum=3.0)
GEOMETRIC = Vary("b", minimum=1e-3, maximum=1e3, distribution="log-uniform")
WHOLE = Vary("c", minimum=1.0, maximum=4.0, integer=True)
CHOICE = Vary("d", values=("x", "y"))
NORMAL = Vary("e", mean=5.0, deviation=2.0, distribution="normal", minimum=4.0)
ALL = [LINEAR, GEOMETRIC, WHOLE, CHOICE, NORMAL]


def test_a_grid_has_every_combination_the_last_key_fastest() -> None:
    varied = [CHOICE, Vary("a", minimum=0.0, maximum=1.0, points=3)]
    cases = DESIGNS["grid"](varied, 0, 1)
    assert cases == [{"d": d, "a": a} for d in ("x", "y") for a in (0.0, 0.5, 1.0)]
    geometric = Vary("b", minimum=1e-3, maximum=1e3, points=4, distribution="log-uniform")
    assert np.allclose(levels(geometric), [1e-3, 1e-1, 1e1, 1e3], rtol=1e-12)
    assert levels(Vary("c", minimum=1.0, maximum=4.0, points=4, integer=True)) == [1, 2, 3, 4]


@pytest.mark.parametrize("kind", ["latin-hypercube", "sobol", "monte-carlo"])
def test_drawn_values_keep_range_and_distribution(kind: str) -> None:
    cases = DESIGNS[kind](ALL, 1024, 3)
    assert cases == DESIGNS[kind](ALL, 1024, 3)
    assert cases != DESIGNS[kind](ALL, 1024, 4)
    a, b, e = (np.array([case[key] for case in cases]) for key in "abe")
    # three standard deviations of an independent sample of this size; the others are far more even
    assert -1.0 <= a.min() < a.max() <= 3.0
    assert abs(a.mean() - 1.0) < 3.0 * (4.0 / math.sqrt(12.0)) / 32.0
    assert 1e-3 <= b.min() < b.max() <= 1e3
    assert abs(np.log10(b).mean()) < 3.0 * (6.0 / math.sqrt(12.0)) / 32.0
    assert e.min() >= 4.0
    # of a normal distribution cut off half a deviation below its mean 0.276 lies within that half
    assert abs(np.mean(e < 5.0) - 0.1915 / 0.6915) < 3.0 * 0.45 / 32.0
    for value in (1, 2, 3, 4):
        assert abs(sum(case["c"] == value for case in cases) - 256) < 3 * 14
    assert abs(sum(case["d"] == "x" for case in cases) - 512) < 3 * 16


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_normal_distribution_keeps_its_shape_far_from_its_mean(sign: float) -> None:
    ends = sorted([sign * 9.0, sign * 12.0])
    tail = Vary("a", mean=0.0, deviation=1.0, distribution="normal", minimum=ends[0], maximum=ends[1])
    drawn = sign * np.array([case["a"] for case in DESIGNS["latin-hypercube"]([tail], 1000, 3)])
    # beyond 9 deviations it falls off as an exponential of 1 / 9 does, Mills' ratio
    assert abs(drawn.mean() - 9.1085) < 1e-3
    assert 9.0 <= drawn.min() < drawn.max() < 12.0


def test_a_latin_hypercube_meets_every_part_of_each_range_once() -> None:
    cases = DESIGNS["latin-hypercube"]([LINEAR, GEOMETRIC], 20, 1)
    parts = [int((case["a"] + 1.0) / 4.0 * 20.0) for case in cases]
    assert sorted(parts) == list(range(20))


@pytest.mark.parametrize("kind", ["sobol", "monte-carlo"])
def test_more_samples_only_add(kind: str) -> None:
    assert DESIGNS[kind](ALL, 100, 1) == DESIGNS[kind](ALL, 300, 1)[:100]


def test_a_list_may_come_from_a_csv_file(folder: Path) -> None:
    (folder / "cases.csv").write_text("plant.pole, controller.label\n0.25, fast\n\n, 12\n")
    text = 'scenario = "lag.toml"\n[design]\nkind = "list"\nfile = "cases.csv"\n'
    (folder / "list.toml").write_text(text)
    cases = study.load(folder / "list.toml").case
    assert cases == ({"plant.pole": 0.25, "controller.label": "fast"}, {"controller.label": 12})


VARY = '[[vary]]\nkey = "plant.pole"\n'
LIST = 'scenario = "lag.toml"\n[design]\nkind = "list"\n'
GRID = 'scenario = "lag.toml"\n[design]\nkind = "grid"\n'
DRAWN = 'scenario = "lag.toml"\n[design]\nkind = "monte-carlo"\nsamples = 4\n'
RANGE = VARY + "minimum = 0.1\nmaximum = 0.9\n"
BAD = {
    "no study": (None, "the study file `study.toml` does not exist"),
    "broken TOML": ("scenario = ", "not valid TOML"),
    "no scenario": ('[design]\nkind = "grid"\n', "`scenario` is missing"),
    "unknown scenario": (DRAWN.replace("lag.toml", "lagg.toml") + RANGE, "`lagg.toml` does not exist"),
    "unknown table": (GRID + "[varied]\n", "`varied` is not a known key"),
    "unknown design": (GRID.replace("grid", "gird"), "`design.kind` is `'gird'`"),
    "empty grid": (GRID, "`vary` is empty"),
    "grid without values": (GRID + VARY, "neither `values` nor a range"),
    "grid without points": (GRID + RANGE, "`vary[0].points`"),
    "grid with samples": (GRID + "samples = 3\n" + RANGE, "`design.samples` cannot be used with a `grid`"),
    "endless grid": (GRID + RANGE + "points = 2000000\n", "2000000 runs"),
    "empty list": (LIST, "`case` is empty"),
    "list with vary": (LIST + RANGE, "`vary` cannot be used with"),
    "missing CSV": (LIST + 'file = "none.csv"\n', "none.csv"),
    "torn CSV": (LIST + 'file = "torn.csv"\n', "line 3 has 1 cells, not 2"),
    "samples missing": (DRAWN.replace("samples = 4", "") + RANGE, "`design.samples` is `None`"),
    "no samples": (DRAWN.replace("4", "0") + RANGE, "needs at least 1"),
    "ends swapped": (DRAWN + VARY + "minimum = 0.9\nmaximum = 0.1\n", "must be above `minimum` = `0.9`"),
    "one end": (DRAWN + VARY + "minimum = 0.9\n", "needs `minimum` and `maximum`"),
    "values and range": (DRAWN + RANGE + "values = [1]\n", "cannot be used with `values`"),
    "logarithm of 0": (
        DRAWN + VARY + 'minimum = 0.0\nmaximum = 1.0\ndistribution = "log-uniform"\n',
        "must start above 0",
    ),
    "normal without deviation": (DRAWN + VARY + 'mean = 0.5\ndistribution = "normal"\n', "both of them"),
    "key twice": (DRAWN + RANGE + RANGE, "`plant.pole` is given twice"),
    "key set and varied": (DRAWN + RANGE + "[set]\nplant.pole = 0.2\n", "`plant.pole` is given twice"),
    "unknown key": (DRAWN + RANGE.replace("plant.pole", "plants.pole"), "not a key of a scenario"),
    "unknown plant parameter": (DRAWN + RANGE.replace("pole", "ploe"), "`plant.ploe`"),
    "unknown FMU variable": (DRAWN + RANGE.replace("plant.pole", "controller.gian"), "`gian`"),
    "unknown loop key": (DRAWN + RANGE.replace("plant.pole", "loop.dration"), "`loop.dration`"),
    "unknown wire": (DRAWN + RANGE.replace("plant.pole", "wire.plant.v.noise"), "no wire `plant.v`"),
    "value out of range": (LIST + "[[case]]\nplant.pole = 0.5\n[[case]]\nplant.pole = 9\n", "case 1"),
    "wrong type": (LIST + '[[case]]\nplant.pole = "high"\n', "`plant.pole`"),
    "unknown key in set": (DRAWN + RANGE + "[set]\nplant.ploe = 0.2\n", "`plant.ploe`"),
    "unknown metric": (DRAWN + RANGE + '[traces]\nworst = 1\nmetric = "ned"\n', "not a metric"),
    "worst of nothing": (DRAWN + RANGE + "[traces]\nworst = 1\n", "`traces.metric` is missing"),
    "no time": (DRAWN + RANGE + "[limits]\ntimeout = 0\n", "`limits.timeout` is `0.0`"),
    "no repeats": (DRAWN.replace("samples", "repeats = 0\nsamples") + RANGE, "`design.repeats` is `0`"),
    "negative seed": ("seed = -1\n" + DRAWN + RANGE, "`seed` is `-1`"),
}


@pytest.fixture
def refused(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Refused:
    """Check that a sweep is rejected with one message about a problem."""

    def check(arguments: list[str], problem: str) -> None:
        monkeypatch.setattr(sys, "argv", ["cosim", "sweep", *arguments])
        with pytest.raises(SystemExit) as exited:
            main()
        stdout, stderr = capsys.readouterr()
        assert (exited.value.code, stdout) == (2, "")
        lines = stderr.strip().splitlines()
        assert lines[0].startswith("error: ")
        assert problem in lines[0]
        assert len(lines) == 1 or (len(lines) == 2 and lines[1].startswith("hint: "))

    return check


@pytest.mark.parametrize(("text", "problem"), BAD.values(), ids=BAD.keys())
def test_a_bad_study_is_one_message_and_exit_code_2(
    text: str | None,
    problem: str,
    write: Write,
    folder: Path,
    refused: Refused,
) -> None:
    write(studies.MEASURED)
    (folder / "torn.csv").write_text("plant.pole,controller.gain\n0.1,0.2\n0.3\n")
    if text is not None:
        (folder / "study.toml").write_text(text)
    refused(["study.toml"], problem)
    assert not (folder / "study.sweep").exists()


@pytest.mark.parametrize(
    ("lines", "problem"),
    [
        ("import os\nos._exit(0)", "it ended the process with exit code 0"),
        ("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)", "killed by SIGSEGV"),
        ("import sys\nsys.exit(0)", "ended the process: `sys.exit(0)`"),
    ],
)
def test_a_plant_that_ends_its_process_at_import_ends_no_sweep(
    lines: str, problem: str, write: Write, folder: Path, refused: Refused
) -> None:
    file = write(studies.MEASURED)
    file.write_text(file.read_text().replace("probe_plants:Lag", "ending:Any"))
    (folder / "ending.py").write_text(lines)
    (folder / "study.toml").write_text(DRAWN + RANGE)
    refused(["study.toml"], problem)
    assert not (folder / "study.sweep").exists()


BAD_OPTIONS = {
    "unwritable folder": (["--out", "lag.toml/out"], "cannot write results to `lag.toml/out`"),
    "unknown engine": (["--engine", "natvie"], "there is no engine `natvie`"),
    "no workers": (["--workers", "0"], "--workers"),
}


@pytest.mark.parametrize(("options", "problem"), BAD_OPTIONS.values(), ids=BAD_OPTIONS.keys())
def test_bad_options_are_one_message_and_exit_code_2(
    options: list[str],
    problem: str,
    write: Write,
    folder: Path,
    refused: Refused,
) -> None:
    write(studies.MEASURED)
    (folder / "study.toml").write_text(DRAWN + RANGE)
    refused(["study.toml", *options], problem)


def test_a_missing_extra_is_named(
    write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write(studies.MEASURED)
    (folder / "study.toml").write_text(DRAWN.replace("monte-carlo", "sobol") + RANGE)
    monkeypatch.setitem(sys.modules, "scipy.stats.qmc", None)
    monkeypatch.setattr(sys, "argv", ["cosim", "sweep", "study.toml"])
    with pytest.raises(SystemExit) as exited:
        main()
    stderr = capsys.readouterr().err
    assert exited.value.code == 2
    assert 'hint: Run `pip install "scipy>=' in stderr
