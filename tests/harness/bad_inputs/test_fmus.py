"""FMUs with one defect each: the message names it in FMPy's words or the FMU's own."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from cosim.fmu import archive, members

from .. import test_cli
from . import fmus
from .calling import Case, Refuse, call, given


@pytest.mark.parametrize("broken", fmus.FILES, indirect=True)
def test_a_broken_fmu_is_named(
    broken: str,
    request: pytest.FixtureRequest,
    refuse: Refuse,
) -> None:
    words = fmus.FILES[request.node.callspec.params["broken"]][1]
    case = Case(given("run", "lag.toml", "--set", f"controller.fmu={broken}"), words)
    refuse(case)


@pytest.mark.parametrize("broken", fmus.WARNED, indirect=True)
def test_what_hinders_no_run_is_a_warning(
    broken: str,
    request: pytest.FixtureRequest,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    archive.opened.cache_clear()
    words = fmus.WARNED[request.node.callspec.params["broken"]][1]
    assert call(given("run", "lag.toml", "--set", f"controller.fmu={broken}"), monkeypatch) == 0
    warning = capsys.readouterr().err
    assert warning.startswith("warning: ")
    for word in words:
        assert word in warning


@pytest.mark.usefixtures("lag")
def test_a_library_without_a_function_is_named(
    folder: Path,
    probe_library: bytes,
    refuse: Refuse,
) -> None:
    renamed = probe_library.replace(b"fmi2CancelStep", b"fmi2CancelStop")
    fmus.write(folder / "broken.fmu", {fmus.XML: fmus.description(), fmus.LIBRARY: renamed})
    words = ("lacks an FMI function", "undefined symbol: fmi2CancelStep")
    refuse(Case(given("run", "lag.toml", "--set", "controller.fmu=broken.fmu"), words))


def test_a_library_that_ends_its_process_costs_its_own_row(lag: Path, broken_library: bytes) -> None:
    for name in fmus.CRASHES:
        fmus.defect(name)(lag / f"{name}.fmu", broken_library)
    cases = "".join(f'[[case]]\n"controller.fmu" = "{name}.fmu"\n' for name in ("probe", *fmus.CRASHES))
    (lag / "study.toml").write_text(f'scenario = "lag.toml"\n[design]\nkind = "list"\n{cases}')
    done = test_cli.cosim("sweep", "study.toml", "--workers", "2", "--no-plots")
    assert done.returncode == 1, done.stderr
    lines = (lag / "study.sweep" / "results.jsonl").read_text().splitlines()
    rows = {row["set"]["controller.fmu"]: row["status"] for row in map(json.loads, lines)}
    assert rows == {"probe.fmu": "passed"} | {f"{name}.fmu": "crashed" for name in fmus.CRASHES}


def test_an_fmu_of_very_many_files_is_rejected(
    lag: Path, monkeypatch: pytest.MonkeyPatch, refuse: Refuse, broken_library: bytes
) -> None:
    monkeypatch.setattr(members, "MAX_FILES", 10)
    fmus.holding({f"resources/{index}": "" for index in range(10)})(lag / "broken.fmu", broken_library)
    words = ("`broken.fmu` holds 12 files, more than 10",)
    refuse(Case(given("run", "lag.toml", "--set", "controller.fmu=broken.fmu"), words))


def test_a_bad_sum_of_the_library_is_found(lag: Path, refuse: Refuse, broken_library: bytes) -> None:
    def flip(content: bytes) -> bytes:
        place = content.index(fmus.LIBRARY.encode()) + len(fmus.LIBRARY) + 500
        return (
            content[:place]
            + bytes(255 - byte for byte in content[place : place + 50])
            + content[place + 50 :]
        )

    fmus.patched(flip)(lag / "broken.fmu", broken_library)
    words = ("`broken.fmu` is damaged", "cannot be unpacked")
    refuse(Case(given("run", "lag.toml", "--set", "controller.fmu=broken.fmu"), words))


def test_fmpy_says_the_same(lag: Path, broken_library: bytes) -> None:
    """The reason in the message is the one that FMPy gives."""
    build, _ = fmus.FILES["duplicate names"]
    build(lag / "broken.fmu", broken_library)
    code = "import fmpy, sys; fmpy.read_model_description(sys.argv[1])"
    theirs = subprocess.run(
        [sys.executable, "-c", code, "broken.fmu"], capture_output=True, text=True, check=False
    )
    ours = test_cli.cosim("run", "lag.toml", "--set", "controller.fmu=broken.fmu")
    reason = next(line for line in theirs.stderr.splitlines() if "not unique" in line)
    assert reason.strip("- ") in ours.stderr
