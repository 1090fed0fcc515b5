"""Command lines and environments with one mistake each."""

from __future__ import annotations

import io
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest

from ..conftest import SCENARIO, entry
from . import commands, studies
from .calling import Case, Refuse, given

FAILING = studies.LIST + "[[case]]\nplant.pole = 0.5\ncriterion.end.maximum = -1.0\n"
SEARCH = 'scenario = "lag.toml"\nobjective = {metric = "end"}\n' + studies.RANGE


@pytest.fixture
def room(lag: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Put what the command lines speak of into the folder."""
    (lag / "study.toml").write_text(studies.DRAWN + studies.RANGE)
    (lag / "torn.fmu").write_bytes((lag / "probe.fmu").read_bytes()[:-100])
    for name in ("full.csv", "full.npz", "full.svg"):
        (lag / name).symlink_to("/dev/full")
    (lag / "folder.csv").mkdir()
    (lag / "cache").mkdir(exist_ok=True)
    (lag / "lag.baseline.npz").mkdir()
    (lag / "loop").symlink_to("loop")
    for name in ("pipe", "zero", "full", "taken"):
        (lag / name).mkdir()
    os.mkfifo(lag / "pipe" / "results.jsonl")
    for name in ("zero", "full"):
        (lag / name / "results.jsonl").symlink_to(f"/dev/{name}")
    (lag / "taken" / "traces").touch()
    (lag / "failing.toml").write_text(FAILING)
    (lag / "search.toml").write_text(SEARCH)
    (lag / "best.toml").write_text('scenario = "lag.toml"\nobjective = {metric = "end"}\n')
    (lag / "model.xml").write_text("<mujoco/>")
    (lag / "driven.toml").write_text(SCENARIO + entry("signal", to="controller.flag", file="in.csv"))
    write_traces(lag)
    return lag


def write_traces(folder: Path) -> None:
    """Write what is a trace, and what only has the name of one."""
    (folder / "in.csv").write_text("time,flag\n0,1\n1,0\n")
    (folder / "empty.csv").touch()
    os.mkfifo(folder / "pipe.csv")
    (folder / "zero.npz").symlink_to("/dev/zero")
    header = {"descr": [("time", "<f8")], "fortran_order": False, "shape": (99999999999999,)}
    vast = io.BytesIO()
    np.lib.format.write_array_header_1_0(vast, header)
    with zipfile.ZipFile(folder / "vast.npz", "w") as archive:
        archive.writestr("trace.npy", vast.getvalue())
    np.savez(folder / "half.npz", trace=np.zeros(100))
    (folder / "half.npz").write_bytes((folder / "half.npz").read_bytes()[:-200])


@pytest.mark.usefixtures("room")
@pytest.mark.parametrize("case", commands.LINES.values(), ids=commands.LINES)
def test_a_bad_command_line_is_named(case: Case, refuse: Refuse) -> None:
    refuse(case)


@pytest.mark.usefixtures("room")
@pytest.mark.parametrize(("variables", "case"), commands.ENVIRONMENTS.values(), ids=commands.ENVIRONMENTS)
def test_a_bad_environment_is_named(
    variables: dict[str, str],
    case: Case,
    monkeypatch: pytest.MonkeyPatch,
    refuse: Refuse,
) -> None:
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    refuse(case)


@pytest.mark.skipif(os.name == "nt", reason="Windows removes no folder in use")
@pytest.mark.parametrize("arguments", [given("list"), given("run", "lag.toml"), given("sweep", "study.toml")])
def test_a_removed_working_directory_is_named(
    arguments: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    refuse: Refuse,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "gone").mkdir()
    os.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    refuse(Case(arguments, ("the working directory cannot be used",)))
