"""`results.jsonl`: rows that are no rows are done again, and what could not be written costs nothing else."""

from __future__ import annotations

import errno
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cosim.errors import CosimError
from cosim.study.store import Store

from . import studies

Write = Callable[..., Path]

EDITS: dict[str, Callable[[dict[str, Any]], Any]] = {
    "only hash and status": lambda row: {"hash": row["hash"], "status": "passed"},
    "no metrics": lambda row: {key: value for key, value in row.items() if key != "metrics"},
    "no units": lambda row: row | {"units": {}},
    "metrics of text": lambda row: row | {"metrics": {"end": "low"}},
    "metrics as array": lambda row: row | {"metrics": [1.0]},
    "criteria of numbers": lambda row: row | {"criteria": {"end": 1}},
    "passed against its criteria": lambda row: row | {"status": "passed", "criteria": {"end": False}},
    "passed without criteria": lambda row: row | {"status": "passed", "criteria": {}},
    "unknown status": lambda row: row | {"status": "great"},
    "error without reason": lambda row: {"hash": row["hash"], "status": "error"},
    "run as text": lambda row: row | {"run": "first"},
    "set as text": lambda row: row | {"set": "plant.pole"},
    "array": lambda row: [row],
    "number": lambda row: 1,
    "null": lambda row: None,
}
DEEP = "[" * 100_000 + "\n"


def write_study(write: Write, folder: Path, cases: list[str], added: str = studies.MEASURED) -> Path:
    """Write a study of the lag with these cases; returns the file of its rows."""
    write(added)
    (folder / "list.toml").write_text(studies.case_list(cases))
    return folder / "list.sweep" / "results.jsonl"


def test_a_row_that_is_none_is_done_again(write: Write, folder: Path) -> None:
    file = write_study(write, folder, [f"plant.pole = 0.{number:02}" for number in range(len(EDITS) + 1)])
    studies.sweep("list.toml")
    before = studies.numbers(folder / "list.sweep")
    lines = file.read_text().splitlines(keepends=True)
    edited = [
        json.dumps(edit(json.loads(line))) + "\n" for edit, line in zip(EDITS.values(), lines, strict=False)
    ]
    file.write_text("".join([*edited, DEEP, lines[-1]]))
    done = studies.sweep("list.toml")
    warned = re.findall(r"`list.sweep/results.jsonl`, line (\d+) is not a row \(", done.stderr)
    assert list(map(int, warned)) == list(range(1, len(EDITS) + 2))
    assert "Traceback" not in done.stderr
    fresh = {json.loads(line)["hash"]: line for line in file.read_text().splitlines()[len(EDITS) + 1 :]}
    file.write_text("\n".join(fresh.values()) + "\n")
    assert studies.numbers(folder / "list.sweep") == before


ROW = json.dumps(
    {"run": 0, "case": 0, "seed": 1, "set": {}, "hash": "a", "status": "error", "reason": "failed on request"}
)
TAILS = {"half a row": ROW[:40], "what is no row": "a note of mine", "a row": ROW.replace('"a"', '"b"')}
"""Last lines without end."""


@pytest.mark.parametrize("tail", TAILS)
def test_a_last_line_without_end_is_never_removed(
    tail: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "results.jsonl"
    kept = f"{ROW}\n{TAILS[tail]}"
    file.write_text(kept)
    damaged = tail != "a row"
    with Store(tmp_path) as store:
        assert [store.status(name) for name in "ab"] == ["error", "" if damaged else "error"]
        store.append(json.loads(ROW) | {"hash": "c", "status": "crashed"})
    text = file.read_text()
    assert text.startswith(f"{kept}\n")
    assert ("results.jsonl`, line 2 is not a row (" in caplog.text) == damaged
    with Store(tmp_path) as store:
        assert [store.status(name) for name in "ac"] == ["error", "crashed"]
    assert file.read_text() == text


def test_values_that_json_has_not_are_kept(write: Write, folder: Path) -> None:
    values = ["inf", "-inf", "2.0"]
    write(studies.MEASURED)
    vary = f'[[vary]]\nkey = "wire.plant.u.maximum"\nvalues = [{", ".join(values)}]\n'
    (folder / "list.toml").write_text(f'scenario = "lag.toml"\n[design]\nkind = "grid"\n{vary}')
    done = studies.sweep("list.toml")
    assert "Traceback" not in done.stderr
    found = [row["set"]["wire.plant.u.maximum"] for row in studies.rows(folder / "list.sweep")]
    assert found == ["Infinity", "-Infinity", 2.0]
    assert "Infinity" in (folder / "list.sweep" / "summary.csv").read_text()
    dated = write_study(write, folder, ["title = 1979-05-27"])
    assert "it must be a text" in studies.sweep("list.toml").stderr
    assert not dated.exists() or "1979" not in dated.read_text()


def test_a_run_of_which_nothing_is_demanded_is_done_and_did_not_pass(write: Write, folder: Path) -> None:
    added = studies.MEASURED.partition("[[criterion]]")[0]
    write_study(write, folder, ["plant.pole = 0.1", "plant.pole = 0.2"], added)
    done = studies.sweep("list.toml", "--json", "-")
    assert studies.statuses(folder / "list.sweep") == ["done", "done"]
    summary = json.loads(done.stdout)
    assert (summary["passed"], summary["statuses"], done.returncode) == (None, {"done": 2}, 0)
    (folder / "list.toml").write_text(studies.case_list(["plant.pole = 0.1", "plant.fail_at = 3"]))
    assert studies.sweep("list.toml").returncode == 1


FULL = """
import resource, sys
from pathlib import Path
from cosim.sweep import study
from cosim.sweep.plan import Plan
from cosim.study.store import Store, row_of
from cosim.errors import CosimError
plan = Plan(study.load(Path("list.toml")))
with Store(Path("list.sweep")) as store:
    size = Path("list.sweep/results.jsonl").stat().st_size
    # as on a full disk: the file cannot grow by a whole row
    resource.setrlimit(resource.RLIMIT_FSIZE, (size + 20, resource.RLIM_INFINITY))
    try:
        store.append(row_of(plan.runs[1], CosimError("a row that does not fit")))
    except CosimError as error:
        print(error.message)
    print(store.row(plan.runs[0], plan.scenario.criterion)["status"], store.row(plan.runs[1], ()))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_a_full_disk_is_reported_and_loses_no_row(write: Write, folder: Path) -> None:
    file = write_study(write, folder, ["plant.pole = 0.1"])
    studies.sweep("list.toml")
    before = file.read_bytes()
    write_study(write, folder, ["plant.pole = 0.1", "plant.pole = 0.2"])
    command = [sys.executable, "-c", FULL]
    variables = studies.environment()
    done = subprocess.run(command, capture_output=True, text=True, env=variables, check=False)
    assert done.stderr == ""
    problem, rows = done.stdout.splitlines()
    assert problem.startswith("cannot write `list.sweep/results.jsonl`: ")
    assert rows in ("passed None", "failed None")
    assert file.read_bytes() == before
    # the missing runs are done when there is space again
    assert studies.sweep("list.toml").returncode in (0, 1)
    assert file.read_bytes().startswith(before)
    assert len(studies.rows(folder / "list.sweep")) == 2


@pytest.mark.parametrize("number", [errno.ENOSYS, errno.ENOLCK, errno.EWOULDBLOCK])
def test_only_a_lock_of_another_process_is_another_sweep(
    number: int, tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    fcntl = pytest.importorskip("fcntl")

    def flock(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(fcntl, "flock", flock)
    if number == errno.EWOULDBLOCK:
        with pytest.raises(CosimError, match="another sweep writes to"):
            Store(tmp_path)
        return
    with Store(tmp_path) as store:
        store.append(json.loads(ROW))
    assert f"({os.strerror(number)}): start no other sweep" in caplog.text
