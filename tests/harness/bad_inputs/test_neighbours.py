"""Changes that an FMU makes to its process do not affect other runs."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.loop.engines import Engine
from cosim.process import Arithmetic

from ..conftest import DATA
from ..native.conftest import CART, SCENARIO
from ..sweep import studies
from . import fmus

CHANGED = "changed the floating-point environment (rounding, denormals or traps)"
ARITHMETIC = {
    "rounding": f"the FMU `rounding.fmu` {CHANGED} while it was loaded and instantiated; it was restored",
    "traps": f"the FMU `traps.fmu` {CHANGED} while it was loaded and instantiated; it was restored",
    "rounding_in_step": f"`rounding_in_step.fmu` or the plant `counting:Counting` {CHANGED} at or after",
}
BELONGINGS = {
    "locale": "locale",
    "umask": "`umask`",
    "folder": "working directory",
    "variables": "environment variables",
    "handler": "signal handling",
}
SAME, OTHER = 1, 2
"""Processes in which the runs of a sweep are done."""


def neighbours(defect: str, lag: Path, library: bytes) -> tuple[int, str, list[dict[str, object]]]:
    """Sweep the probe, an FMU with a defect and the probe: processes, messages and rows."""
    shutil.copy(DATA / "counting.py", lag / "counting.py")
    fmus.defect(defect)(lag / f"{defect}.fmu", library)
    plant = 'plant.name = "counting:Counting"'
    cases = [f'controller.fmu = "{name}.fmu"\n{plant}' for name in ("probe", defect, "probe")]
    (lag / "study.toml").write_text(studies.case_list(cases))
    done = studies.sweep("study.toml", "--workers", "1")
    return len(set((lag / "processes").read_text().split())), done.stderr, studies.rows(lag / "study.sweep")


def ends(lag: Path) -> dict[str, object]:
    """Metrics of a run of the lag that nothing befell."""
    result = cosim.run(cosim.load("lag.toml", ["plant.name=counting:Counting"]))
    return {name: metric.value for name, metric in result.metrics.items()}


@pytest.mark.parametrize(("defect", "words"), ARITHMETIC.items(), ids=ARITHMETIC)
def test_how_the_processor_calculates_is_put_back(
    defect: str, words: str, lag: Path, broken_library: bytes
) -> None:
    processes, reported, rows = neighbours(defect, lag, broken_library)
    assert words in reported, reported
    assert [row["status"] for row in rows] == ["passed"] * 3
    assert rows[0]["metrics"] == rows[2]["metrics"] == ends(lag)
    assert processes == SAME


@pytest.mark.parametrize(("defect", "what"), BELONGINGS.items(), ids=BELONGINGS)
def test_what_belongs_to_the_process_is_left_to_the_run_that_changed_it(
    defect: str, what: str, lag: Path, broken_library: bytes
) -> None:
    processes, reported, rows = neighbours(defect, lag, broken_library)
    who = f"the FMU `{defect}.fmu` or the plant `counting:Counting`"
    assert (
        f"warning: run 1, seed {rows[1]['seed']}: {who} changed the {what} of its process: the next"
        in reported
    )
    assert [row["status"] for row in rows] == ["passed"] * 3
    assert processes == OTHER


@pytest.mark.parametrize(
    ("defect", "words"),
    [
        ("garbage", " wrote to a foreign file descriptor: the connection to the worker process is corrupted"),
        (
            "files",
            " changed the resource limits of its process: the plant `counting:Counting` cannot be reset",
        ),
    ],
)
def test_what_a_run_does_to_its_connection_or_files_is_its_own_row(
    defect: str, words: str, lag: Path, broken_library: bytes
) -> None:
    _, _, rows = neighbours(defect, lag, broken_library)
    assert [row["status"] in ("crashed", "error") for row in rows] == [False, True, False]
    reason = str(rows[1]["reason"])
    assert reason.startswith(f"the FMU `{defect}.fmu` or the plant `counting:Counting`{words}"), reason
    assert rows[0]["metrics"] == rows[2]["metrics"] == ends(lag)


@pytest.mark.parametrize("defect", ["reset_error", "reset_fatal"])
def test_an_fmu_that_rejects_a_reset_runs_as_in_a_fresh_process(
    defect: str, lag: Path, broken_library: bytes
) -> None:
    fmus.defect(defect)(lag / "refusing.fmu", broken_library)
    cases = [f'controller.gain = 0.{k}\ncontroller.fmu = "refusing.fmu"' for k in (1, 2, 3)]
    (lag / "study.toml").write_text(studies.case_list(cases))
    done = studies.sweep("study.toml", "--workers", "1")
    assert "warning: run 1, seed " in done.stderr
    assert ": every run gets a new instance, because it cannot be reset: " in done.stderr
    for row in studies.rows(lag / "study.sweep"):
        changes = [f"{key}={value}" for key, value in row["set"].items()]
        single = cosim.run(cosim.load("lag.toml", changes), row["seed"])
        assert row["metrics"] == {name: metric.value for name, metric in single.metrics.items()}


@pytest.mark.parametrize("engine", ["reference", "native"])
def test_both_engines_put_back_how_the_processor_calculates(
    engine: Engine,
    write: Callable[..., Path],
    folder: Path,
    broken_library: bytes,
    caplog: pytest.LogCaptureFixture,
) -> None:
    (folder / "cart.xml").write_text(CART)
    cart = cosim.load(write(text=SCENARIO), ["controller.fmu=rounding.fmu"])
    fmus.defect("rounding_in_step")(folder / "rounding.fmu", broken_library)
    before = Arithmetic()
    with cosim.Session(cart, engine=engine) as session:
        assert session.run().engine == engine
    assert not before.put_back()
    reported = "the FMU `rounding.fmu` or the plant `cart.xml` changed the floating-point environment"
    assert reported in caplog.text
