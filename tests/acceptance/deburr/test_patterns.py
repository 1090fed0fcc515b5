"""The bank of patterns of the deburring robot: what it holds, how it is interpolated, its files."""

import json
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cosim

from ..samples.robots import DELAYS, Changes, errors, learn
from ..samples.runs import Columns, run, trace, value

pytestmark = pytest.mark.acceptance

ROOT = Path(__file__).parents[3]
RESOURCES = ROOT / "fmu-deburr/resources"


def test_what_is_imported_is_what_was_learned(tmp_path: Path) -> None:
    bank = tmp_path / "bank.bin"
    few = ("controller.learn.speeds='1.0 0.5'", "controller.expert.learn.law='NormOptimal'")
    then_played = (
        "controller.learn.repetitions=2",
        f"controller.bank.export='{bank}'",
        "signal.controller.mode.times=[0.0, 45.0]",
        "signal.controller.mode.values=['Learn', 'Playback']",
        "signal.plant.workpiece.values=[0.0, 0.0]",
        "loop.duration=55.0",
        'loop.stop_when=\'controller.state == "Done" and controller.mode == "Playback"\'',
    )
    first = trace(run("deburr/learn", *few, *then_played))
    second = trace(run("deburr/speed-range", *few, f"controller.bank.import='{bank}'", *STEADY))
    played = [
        rows[(rows["controller.mode"] == 4.0) & (rows["controller.state"] == 5.0)] for rows in (first, second)
    ]
    assert len(played[0]) == len(played[1]) > 300
    for axis in range(1, 7):
        for output in ("compensation", "reference"):
            column = f"controller.axis{axis}.{output}"
            assert np.array_equal(played[0][column], played[1][column]), column


SINE = {
    "speed_m_s": 0.1,
    "start": {"tip_m": [0.727492092192, 0.0, -0.222507907808], "axis": [0.0, 0.0, -1.0]},
    "blocks": [
        {
            "type": "arc",
            "via_m": [0.75, 0.0, -0.168169011382],
            "to": {"tip_m": [0.772507907808, 0.0, -0.222507907808]},
        }
    ],
}
"""Three quarters of an upright circle: axis 3 moves as 100 sin(pi t) mm/s over the upper half."""


def sine_pattern(bank: Path, path: Path, speeds: str) -> tuple[Columns, Columns]:
    """Distance and compensation of axis 3 in pulses at 75 mm/s, with patterns of some speeds."""
    learned = (f"controller.path.file='{path}'", f"controller.learn.speeds='{speeds}'", *DELAYS[0])
    learn(bank, *learned, repetitions=12)
    played = (
        "signal.controller.speed_override.times=[0.0]",
        "signal.controller.speed_override.values=[0.75]",
    )
    rows = trace(run("deburr/speed-range", *learned, f"controller.bank.import='{bank}'", *played))
    rows = rows[rows["controller.path.speed"] > 0.0]
    return rows["controller.path.distance"], rows["controller.axis3.compensation"] / 5e-6


def test_interpolated_patterns_are_those_that_repetition_forms(tmp_path: Path) -> None:
    # the paper's Fig. 2: from 100 and 50 mm/s to 75
    path = tmp_path / "sine.json"
    path.write_text(json.dumps(SINE))
    interpolated = sine_pattern(tmp_path / "two.bin", path, "1.0 0.5")
    formed = sine_pattern(tmp_path / "one.bin", path, "0.75")
    # 10 to 90 % of the half circle in the middle
    place = np.linspace(0.035, 0.115, 321)
    difference = np.interp(place, *interpolated) - np.interp(place, *formed)
    print(f"interpolated and formed differ by {np.abs(difference).max():.1f} pulses of {formed[1].max():.0f}")
    assert formed[1].max() > 1000.0
    assert np.abs(difference).max() <= 4.0


STEADY: Changes = (
    "signal.controller.speed_override.times=[0.0]",
    "signal.controller.speed_override.values=[1.0]",
)


def test_errors_of_the_files_have_a_hint() -> None:
    for change, words in {
        "controller.path.file='six_axis.json'": ("bank.import", "hint: "),
        "controller.path.file='nowhere.json'": ("path.file", "nowhere.json", "hint: "),
        "controller.axis3.pulse=1e-5": ("bank.import", "hint: "),
    }.items():
        command = [sys.executable, "-m", "cosim", "run", "deburr", "--set", change]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 2, f"{change}: {done.stdout}"
        for word in words:
            assert word in done.stderr, f"{change}: {done.stderr}"


def written(bank: Path) -> cosim.Result:
    """Learn one speed once with `bank` as the file, then deburr."""
    return run(
        "deburr/learn",
        "controller.learn.speeds='1.0'",
        "controller.learn.repetitions=1",
        f"controller.bank.export='{bank}'",
        "loop.duration=25.0",
        "signal.controller.mode.times=[0.0, 16.0]",
        "signal.plant.workpiece.times=[0.0, 18.0]",
    )


def reported_and_kept(result: cosim.Result) -> None:
    """Check that writing failed and was reported, and that the patterns are still used."""
    rows, status = trace(result), result.items["controller.bank.status"]
    assert rows["controller.bank.status"][rows["time"] < 16.0][-1] == status["ExportFailed"]
    assert value(result, "good") == 1.0
    assert max(errors(result)) < 0.5e-3


def test_a_bank_without_a_folder_is_reported_and_kept(tmp_path: Path) -> None:
    reported_and_kept(written(tmp_path / "missing" / "bank.bin"))


def test_a_full_disk_leaves_the_old_bank_as_it_was(tmp_path: Path) -> None:
    bank = tmp_path / "bank.bin"
    bank.write_text("what was there")
    # the FMU is unpacked before files may not grow
    run("deburr/no-bank")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8192, before[1]))
    try:
        result = written(bank)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    reported_and_kept(result)
    assert bank.read_text() == "what was there"
    assert [file.name for file in tmp_path.iterdir()] == ["bank.bin"]
