"""Parts of a sweep and their merged folder; the folder of results belongs to one study."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import cosim

from . import studies

Write = Callable[..., Path]
TRACES = '\n[traces]\nworst = 3\nfailed = 4\nmetric = "end"\n'
WALL = re.compile(rb'"wall_s": [^,}]*')


@pytest.fixture
def study(write: Write, folder: Path) -> Path:
    """Write the lag and a study of twelve runs, of which some fail."""
    write(studies.MEASURED.replace("1.5", "0.5"))
    (folder / "grid.toml").write_text(studies.GRID + TRACES)
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """Files of a folder of results without the wall times, which no two sweeps share."""
    found = {}
    for file in sorted(path for path in folder.rglob("*") if path.is_file()):
        if file.name == "summary.csv":
            *lines, _ = (line.split(b",") for line in file.read_bytes().split(b"\n"))
            place = lines[0].index(b"wall_s")
            text = b"\n".join(b",".join(line[:place] + line[place + 1 :]) for line in lines)
        else:
            text = WALL.sub(b"", file.read_bytes())
        # Parquet and NumPy archives hold times; their rows are those of the CSV file and of the traces
        found[file.relative_to(folder).as_posix()] = b"" if file.suffix in (".parquet", ".npz") else text
    return found


def test_merged_parts_are_the_folder_of_an_undivided_sweep(study: Path) -> None:
    for part in ("3/3", "1/3", "2/3"):
        cosim.sweep("grid.toml", workers=1, part=part, plots=True)
    folders = [f"grid.{part}-of-3.sweep" for part in (2, 3, 1)]
    assert [len(studies.rows(study / folder)) for folder in folders] == [4, 4, 4]
    done = studies.sweep("merge", *folders, "-o", "merged", "--plots")
    assert done.stderr == ""
    assert "12 of 12 runs" in done.stdout
    cosim.sweep("grid.toml", "undivided", workers=1, plots=True)
    assert contents(study / "merged") == contents(study / "undivided")
    assert len([*(study / "merged" / "traces").iterdir()]) > 4
    for file in (study / "merged" / "traces").glob("*.npz"):
        other = study / "undivided" / "traces" / file.name
        assert np.load(file)["trace"].tobytes() == np.load(other)["trace"].tobytes()
    # the runs are those of the parts, and a second merge changes nothing
    times = {row["hash"]: row["wall_s"] for folder in folders for row in studies.rows(study / folder)}
    assert times == {row["hash"]: row["wall_s"] for row in studies.rows(study / "merged")}
    before = (study / "merged" / "results.jsonl").read_bytes()
    studies.sweep("merge", *folders, "-o", "merged")
    assert (study / "merged" / "results.jsonl").read_bytes() == before


def test_parts_may_be_merged_elsewhere_and_before_all_are_there(study: Path, tmp_path: Path) -> None:
    studies.sweep("grid.toml", "--part", "2/4")
    shutil.copytree(study, tmp_path / "other machine")
    shutil.rmtree(study / "grid.2-of-4.sweep")
    folder = tmp_path / "other machine" / "grid.2-of-4.sweep"
    done = studies.sweep("merge", str(folder), "--json", "-")
    assert json.loads(done.stdout)["rows"] == 3
    assert [row["run"] for row in studies.rows(study / "grid.sweep")] == [1, 5, 9]
    assert done.returncode == 1


def test_a_result_replaces_a_run_without_one(study: Path) -> None:
    for folder in ("a", "b"):
        studies.sweep("grid.toml", "--part", "1/6", "--out", folder)
    file = study / "a" / "results.jsonl"
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    lost = {key: rows[0][key] for key in ("run", "case", "seed", "set", "hash")}
    file.write_text(json.dumps({**lost, "status": "crashed", "reason": "test"}) + "\n")
    studies.sweep("merge", "a", "b", "-o", "both")
    assert studies.numbers(study / "both") == studies.numbers(study / "b")


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (["merge"], "`merge` has no folder"),
        (["merge", "gone"], "`gone` is not the folder of a sweep"),
        (["merge", "grid.sweep", "other.sweep"], "the folders have several studies"),
        (["merge", "grid.sweep", "--part", "1/2"], "`--part` and `merge` cannot be given together"),
        (["grid.toml", "other.toml"], "`other.toml` is a second study"),
        *(
            (["grid.toml", "--part", part], f"`--part` is `{part}`")
            for part in ("0/3", "4/3", "1", "-1/2", "a/b")
        ),
    ],
)
def test_wrong_parts_are_one_message(options: list[str], problem: str, study: Path) -> None:
    shutil.copy("grid.toml", "other.toml")
    for name in ("grid", "other"):
        (study / f"{name}.sweep").mkdir()
        (study / f"{name}.sweep" / "results.jsonl").touch()
        (study / f"{name}.sweep" / "study.txt").write_text(f"../{name}.toml\n")
    done = studies.sweep(*options)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: {problem}")


def test_parts_of_another_program_are_not_merged(study: Path, write: Write) -> None:
    studies.sweep("grid.toml", "--part", "1/6")
    write(studies.MEASURED.replace("last(plant.x) +", "3 * last(plant.x) +"))
    done = studies.sweep("merge", "grid.1-of-6.sweep")
    assert done.returncode == 2
    assert "error: the folders hold no run of `grid.toml` as it is now" in done.stderr


def test_studies_of_one_name_do_not_share_a_folder_unasked(study: Path, write: Write) -> None:
    for name in "ab":
        write(studies.MEASURED, name=f"{name}/lag.toml")
        for file in ("probe.fmu", "probe_plants.py"):
            shutil.copy(study / file, study / name / file)
        (study / name / "grid.toml").write_text(studies.GRID.replace("values = [0.2, 0.4]", "values = [0.2]"))
    studies.sweep("a/grid.toml")
    before = (study / "grid.sweep" / "summary.csv").read_bytes()
    done = studies.sweep("b/grid.toml")
    problem = "`grid.sweep` holds the results of `a/grid.toml`, not of `b/grid.toml`"
    assert (done.returncode, problem in done.stderr) == (2, True)
    assert (study / "grid.sweep" / "summary.csv").read_bytes() == before
    # on request they share it
    assert "6 of 6 runs" in studies.sweep("b/grid.toml", "--out", "grid.sweep").stdout
    # a study that was moved keeps its folder
    (study / "b" / "grid.toml").rename(study / "grid.toml")
    (study / "grid.toml").write_text((study / "grid.toml").read_text().replace("lag.toml", "b/lag.toml"))
    assert "6 of 6 runs" in studies.sweep("grid.toml").stdout
