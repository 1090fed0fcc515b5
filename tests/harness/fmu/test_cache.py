"""The cache of extracted FMUs: nothing of the user's is touched, nothing of another user's is trusted."""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys
import time
from pathlib import Path

import fmpy
import pytest

from cosim import paths
from cosim.errors import FmuError
from cosim.fmu import archive, cache
from cosim.fmu.archive import open_fmu

from ..conftest import DATA, pack

LIBRARY = f"binaries/{fmpy.platform}/probe{fmpy.sharedLibraryExtension}"
LONG_AGO = time.time() - (cache.UNUSED_DAYS + 1) * 86400
ROOT = Path(__file__).resolve().parents[3]


def other(folder: Path, change: str = "Other") -> Path:
    """Pack another FMU than the probe."""
    return pack(
        folder / "other.fmu", (DATA / "probe.xml").read_text().replace("Gain", change), {LIBRARY: b"lib"}
    )


def aged(path: Path) -> Path:
    os.utime(path, (LONG_AGO, LONG_AGO))
    return path


@pytest.fixture(autouse=True)
def _fresh() -> None:
    archive.opened.cache_clear()
    cache.of_this_process.cache_clear()


def test_an_fmu_is_extracted_once_and_by_content(folder: Path) -> None:
    first = open_fmu(folder / "probe.fmu").folder
    marker = first / "marker"
    marker.touch()
    assert open_fmu(folder / "probe.fmu").folder == first
    assert marker.exists()
    other(folder).rename(folder / "probe.fmu")
    assert open_fmu(folder / "probe.fmu").folder != first
    assert not [path for path in first.parent.iterdir() if path.name.startswith(cache.PARTIAL)]


def test_what_was_not_used_for_long_is_removed(folder: Path) -> None:
    first = aged(open_fmu(folder / "probe.fmu").folder)
    left = aged_folder(first.parent / f"{cache.PARTIAL}a1_b2")
    assert open_fmu(other(folder)).folder.is_dir()
    assert not first.exists()
    assert not left.exists()


def aged_folder(path: Path) -> Path:
    path.mkdir(parents=True)
    (path / "thesis.txt").write_text("years of work")
    return aged(path)


def test_what_the_user_keeps_in_the_cache_folder_stays(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = folder / "mine"
    monkeypatch.setenv("COSIM_CACHE", str(chosen))
    own = paths.cache_folder()
    kept = [
        chosen / ".git",
        chosen / "data",
        chosen / ("0" * 32),
        own / "thesis",
        own / ".partial",
        own / "a",
    ]
    for path in kept:
        aged_folder(path)
    link = own / ("f" * 32)
    link.symlink_to(aged_folder(folder / "target"))
    os.utime(link, (LONG_AGO, LONG_AGO), follow_symlinks=False)
    open_fmu(folder / "probe.fmu")
    assert all((path / "thesis.txt").read_text() for path in [*kept, folder / "target"])


def test_an_empty_variable_is_no_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COSIM_CACHE", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "user"))
    kept = [aged_folder(folder / ".git"), aged_folder(folder / "data")]
    assert open_fmu(folder / "probe.fmu").folder.is_relative_to(folder / "user" / paths.CACHE_NAME)
    assert all((path / "thesis.txt").exists() for path in kept)


def test_a_relative_cache_lies_in_the_working_directory(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COSIM_CACHE", "near")
    found = open_fmu(folder / "probe.fmu").folder
    assert found.is_absolute()
    assert found.is_relative_to(folder / "near")


@pytest.mark.parametrize("damage", ["torn", "gone", "file"])
def test_a_damaged_folder_is_extracted_again(
    folder: Path, damage: str, caplog: pytest.LogCaptureFixture
) -> None:
    first = open_fmu(folder / "probe.fmu").folder
    library = first / LIBRARY
    whole = library.read_bytes()
    if damage == "torn":
        library.write_bytes(whole[: len(whole) // 2])
    elif damage == "gone":
        library.unlink()
    else:
        shutil.rmtree(first)
        first.write_text("in the way")
    archive.opened.cache_clear()
    assert (open_fmu(folder / "probe.fmu").folder / LIBRARY).read_bytes() == whole
    assert "was damaged" in caplog.text


def test_a_folder_that_was_removed_during_the_process_is_extracted_again(folder: Path) -> None:
    first = open_fmu(folder / "probe.fmu").folder
    shutil.rmtree(first)
    assert open_fmu(folder / "probe.fmu").folder == first
    assert (first / LIBRARY).is_file()


def test_an_unwritable_cache_falls_back_and_says_so(
    folder: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (folder / "file").touch()
    monkeypatch.setenv("COSIM_CACHE", str(folder / "file" / "below"))
    monkeypatch.setattr("tempfile.tempdir", str(folder / "temporary"))
    (folder / "temporary").mkdir()
    assert open_fmu(folder / "probe.fmu").folder.is_relative_to(folder / "temporary")
    assert "Not a directory): FMUs are extracted to" in caplog.text


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="only root gives folders away")
@pytest.mark.parametrize("place", ["chosen", "temporary"])
def test_a_cache_of_another_user_is_not_used(
    folder: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, place: str
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(folder / "temporary"))
    foreign = paths.cache_folder()
    if place == "temporary":
        (folder / "file").touch()
        monkeypatch.setenv("COSIM_CACHE", str(folder / "file"))
        foreign = folder / "temporary" / f"{paths.CACHE_NAME}-{os.getuid()}"
    (folder / "temporary").mkdir()
    foreign.mkdir(parents=True)
    os.chown(foreign, 65534, -1)
    assert not open_fmu(folder / "probe.fmu").folder.is_relative_to(foreign)
    assert not list(foreign.iterdir())
    assert "FMUs are extracted to" in caplog.text


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="only root gives folders away")
def test_a_library_that_another_user_planted_is_replaced(folder: Path) -> None:
    planted = open_fmu(folder / "probe.fmu").folder
    whole = (planted / LIBRARY).read_bytes()
    (planted / LIBRARY).write_bytes(b"x" * len(whole))
    os.chown(planted, 65534, -1)
    archive.opened.cache_clear()
    assert (open_fmu(folder / "probe.fmu").folder / LIBRARY).read_bytes() == whole


@pytest.mark.skipif(os.name == "nt", reason="POSIX permissions")
def test_a_cache_is_closed_to_others(folder: Path) -> None:
    own = paths.cache_folder()
    own.mkdir(parents=True)
    own.chmod(0o777)
    assert open_fmu(folder / "probe.fmu").folder.is_relative_to(own)
    assert not stat.S_IMODE(own.stat().st_mode) & cache.FOREIGN


def test_a_full_disk_gives_an_error_with_the_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = shutil.disk_usage(folder)._replace(free=10)
    monkeypatch.setattr("shutil.disk_usage", lambda _: usage)
    with pytest.raises(FmuError, match=r"unpacks to .* MB, but `.*` has 0 MB free\nhint: Set COSIM_CACHE"):
        open_fmu(folder / "probe.fmu")


def test_several_processes_extract_the_same_fmu(folder: Path) -> None:
    opening = "print(archive.open_fmu(pathlib.Path(sys.argv[1])).folder)"
    code = f"import pathlib, sys; from cosim.fmu import archive; {opening}"
    command = [sys.executable, "-c", code, str(folder / "probe.fmu")]
    variables = {**os.environ, "PYTHONPATH": str(ROOT)}
    started = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=variables) for _ in range(4)]
    found = {process.communicate()[0].strip() for process in started}
    assert len(found) == 1
    assert (Path(found.pop()) / LIBRARY).stat().st_size > 0
    assert not [path for path in paths.cache_folder().iterdir() if path.name.startswith(cache.PARTIAL)]
