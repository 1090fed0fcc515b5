"""Where the output goes: a full disk, a reader that has gone, a stream that is closed; paths with `~`."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from cosim.check.files import check

from .commands import PROGRAM, ROOT, cosim

Write = Callable[..., Path]
pytestmark = pytest.mark.skipif(os.name != "posix", reason="devices and pipes of POSIX")


def started(arguments: list[str], stdout: int | None, **options: object) -> subprocess.CompletedProcess[str]:
    """Run the command line with its output to a descriptor."""
    return subprocess.run(  # type: ignore[call-overload, no-any-return]
        [sys.executable, "-c", PROGRAM, *arguments],
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        **options,
    )


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a disk that is always full")
@pytest.mark.parametrize("arguments", [["list"], ["schema"], ["show", "lag.toml", "--in-process"]])
def test_a_full_disk_is_one_line(arguments: list[str], write: Write) -> None:
    write()
    with Path("/dev/full").open("w") as full:
        done = started(arguments, full.fileno())
    assert done.stderr == "error: cannot write the result: No space left on device\n"
    assert done.returncode == 2


@pytest.mark.parametrize("arguments", [["list"], ["schema"]])
def test_a_reader_that_has_gone_is_no_error(arguments: list[str], write: Write) -> None:
    write()
    reader, writer = os.pipe()
    os.close(reader)
    try:
        done = started(arguments, writer)
    finally:
        os.close(writer)
    # as a shell reports the end by SIGPIPE
    assert (done.returncode, done.stderr) == (141, "")


def test_a_closed_stream_is_no_error(write: Write) -> None:
    write()
    done = started(["list"], None, preexec_fn=lambda: os.close(1))
    assert (done.returncode, done.stderr) == (0, "")


def test_a_path_may_begin_with_the_home(write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = write()
    monkeypatch.setenv("HOME", str(folder))
    assert check("~/lag.toml").error is None
    for name in ("~nobody-at-all/lag.toml", "x" * 300, f"{file}\0"):
        error = check(f"{name}.toml").error
        assert error is not None
        assert "does not exist" in error.message
    (folder / "cart.xml").write_text("<mujoco/>")
    (folder / "deep").mkdir()
    done = cosim("new", "~/probe.fmu", "~/cart.xml", "--out", "~/deep/new.toml", "--in-process")
    assert (done.returncode, done.stderr) == (0, "")
    text = (folder / "deep" / "new.toml").read_text()
    assert 'name = "../cart.xml"' in text
    assert 'fmu = "../probe.fmu"' in text


@pytest.mark.parametrize(
    ("command", "line"),
    [
        ("optimize", 'vary = [{key = "controller.gain", minimum = 0.1, maximum = 10.0}]'),
        ("compare", "cosim compare before.json after.json --rtol 1e-6"),
    ],
)
def test_examples_in_the_help_can_be_copied(command: str, line: str) -> None:
    assert line in [shown.strip() for shown in cosim(command, "--help").stdout.splitlines()]


def test_a_sweep_shows_where_its_results_are(write: Write, folder: Path) -> None:
    write("")
    (folder / "study.toml").write_text('scenario = "lag.toml"\ncase = [{}]\ndesign = {kind = "list"}\n')
    done = cosim("sweep", "study.toml", "--workers", "1", "--no-plots")
    assert done.stdout.endswith("wrote study.sweep\n"), done.stderr
