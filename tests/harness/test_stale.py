"""An FMU of the checkout that is older than its sources gives one warning in one line."""

from __future__ import annotations

import logging
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from cosim import paths
from cosim.cli import main
from cosim.fmu import stale

Write = Callable[..., Path]
BUILT = 1e9
WORKSPACE = """
[workspace.dependencies]
blocks = { path = "blocks" }
macros = { path = "blocks/macros", version = "0.1" }
serde = "1.0"
"""
USED = {"probe": "blocks.workspace = true\nserde.workspace = true", "blocks": "macros.workspace = true"}
FOLDERS = {"probe": "probe", "blocks": "blocks", "macros": "blocks/macros", "other": "other"}


@pytest.fixture
def checkout(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Checkout with the FMU `probe`, newer than its crate and the two that it uses."""
    (folder / "Cargo.toml").write_text(WORKSPACE)
    for name, place in FOLDERS.items():
        source = folder / place / "src" / "deep" / "lib.rs"
        source.parent.mkdir(parents=True)
        source.write_text("// nothing")
        manifest = folder / place / "Cargo.toml"
        manifest.write_text(f"[dependencies]\n{USED.get(name, '')}\n")
        for file in (source, manifest):
            os.utime(file, (BUILT - 1.0, BUILT - 1.0))
    built = folder / "target" / "fmu"
    built.mkdir(parents=True)
    shutil.move(folder / "probe.fmu", built / "probe.fmu")
    os.utime(built / "probe.fmu", (BUILT, BUILT))
    monkeypatch.setattr(paths, "OWN_FMUS", built)
    return folder


@pytest.fixture
def reported(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> Callable[[], list[str]]:
    """Warnings so far, also after the command line has set up its own log in this process."""
    monkeypatch.setattr(logging.getLogger("cosim"), "propagate", True)
    caplog.set_level(logging.WARNING, "cosim")
    return lambda: [record.getMessage() for record in caplog.records]


def edit(file: Path, time: float = BUILT + 1.0) -> None:
    file.parent.mkdir(exist_ok=True)
    file.touch()
    os.utime(file, (time, time))


def stderr_of(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *arguments: str) -> str:
    """Return what a command that succeeds says on stderr."""
    monkeypatch.setattr(sys, "argv", ["cosim", *arguments])
    with pytest.raises(SystemExit) as exited:
        main()
    assert exited.value.code == 0
    return capsys.readouterr().err


def test_the_last_change_after_the_build_counts() -> None:
    times = {Path("a"): 1.0, Path("b"): 3.0, Path("c"): 2.5}
    assert stale.changed_after(2.0, times.items()) == Path("b")
    assert stale.changed_after(3.0, times.items()) is None
    assert stale.changed_after(0.0, []) is None


@pytest.mark.parametrize(
    ("edited", "matters"),
    [
        ("probe/src/deep/lib.rs", True),
        ("probe/Cargo.toml", True),
        ("probe/resources/table.json", True),
        ("blocks/src/deep/lib.rs", True),
        ("blocks/macros/src/deep/lib.rs", True),
        ("probe/tests/loop.rs", False),
        ("other/src/deep/lib.rs", False),
    ],
)
def test_an_edit_of_what_an_fmu_is_built_from_is_reported(
    checkout: Path, reported: Callable[[], list[str]], edited: str, matters: bool
) -> None:
    edit(checkout / edited)
    stale.warn("probe", paths.find_fmu("probe", checkout))
    wanted = f"`target/fmu/probe.fmu` is older than `{edited}`: build it again with `cargo xtask fmu probe`"
    assert reported() == ([wanted] if matters else [])


@pytest.mark.parametrize("command", [["run", "--in-process"], ["show", "--in-process"]])
def test_the_command_line_shows_it_in_one_line(
    write: Write,
    checkout: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    command: list[str],
) -> None:
    write()
    assert stderr_of(capsys, monkeypatch, *command, "lag.toml") == ""
    edit(checkout / "probe" / "src" / "deep" / "lib.rs")
    reported = stderr_of(capsys, monkeypatch, *command, "lag.toml")
    assert reported.startswith("warning: `target/fmu/probe.fmu` is older than `probe/src/deep/lib.rs`: ")
    assert reported.count("\n") == 1
    given = ("--set", "controller.fmu=target/fmu/probe.fmu")
    assert stderr_of(capsys, monkeypatch, *command, "lag.toml", *given) == ""
    assert stderr_of(capsys, monkeypatch, *command, "lag.toml", "-q") == ""


def test_an_fmu_without_sources_with_it_is_never_old(
    checkout: Path, reported: Callable[[], list[str]]
) -> None:
    edit(checkout / "probe" / "src" / "deep" / "lib.rs")
    shutil.copy(checkout / "target" / "fmu" / "probe.fmu", checkout / "probe.fmu")
    os.utime(checkout / "probe.fmu", (BUILT, BUILT))
    stale.warn("probe", checkout / "probe.fmu")
    shutil.rmtree(checkout / "probe")
    stale.warn("probe", checkout / "target" / "fmu" / "probe.fmu")
    assert reported() == []


def test_a_broken_manifest_is_left_to_cargo(checkout: Path, reported: Callable[[], list[str]]) -> None:
    (checkout / "probe" / "Cargo.toml").write_text("[dependencies")
    edit(checkout / "probe" / "Cargo.toml")
    stale.warn("probe", checkout / "target" / "fmu" / "probe.fmu")
    assert "is older than `probe/Cargo.toml`" in reported()[0]
