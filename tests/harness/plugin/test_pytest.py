"""`pytest --cosim` in a process of its own, as a user starts it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ..conftest import DATA, END, entry

Write = Callable[..., Path]
MEETS = entry("criterion", id="low", claim="the lag stays low", metric="end", maximum=1.5, unit="m")
FAILS = entry("criterion", id="high", claim="the lag rises", metric="end", minimum=2e3, unit="m")
TRUE = entry("metric", name="dropped", value="any(plant.x < 0)")
CLAIM = entry("criterion", id="drop", claim="the lag falls below 0", metric="dropped", equals=True)
COUNTED = """
import cosim.loop.session
run = cosim.loop.session.Session.run
def counted(self, *arguments):
    with open("runs", "a") as file:
        file.write(self.scenario.name + "\\n")
    return run(self, *arguments)
cosim.loop.session.Session.run = counted
import cosim.pool.runs
alone = cosim.pool.runs.run
cosim.pool.runs.run = lambda scenario, engine, isolated: alone(scenario, engine=engine)
"""
"""Counts the runs, which then have no process of their own."""


@pytest.fixture(autouse=True)
def _beside(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the scenarios in a folder below the FMU and the plant."""
    monkeypatch.setenv("COSIM_FMU_PATH", str(folder))
    for place in ("scenarios", "scenarios/deep"):
        (folder / place).mkdir()
        shutil.copy(DATA / "probe_plants.py", folder / place)


def started(*arguments: str) -> tuple[int, str]:
    """Exit code and text of a call of pytest."""
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout + done.stderr


def test_each_criterion_is_a_test_and_each_scenario_runs_once(write: Write, folder: Path) -> None:
    (folder / "conftest.py").write_text(COUNTED)
    write(END + MEETS + FAILS + TRUE + CLAIM, "scenarios/lag.toml")
    write(END, "scenarios/deep/free.toml")
    write("", "other.toml")
    code, text = started("--cosim", "-v", "-rs", "--junitxml=out.xml", ".")
    assert code == 1, text
    # xdist is installed: its worker ids are not in these lines
    outcomes = dict(re.findall(r"^(\S+) (PASSED|FAILED|SKIPPED)", text, re.MULTILINE))
    assert outcomes == {
        "scenarios/lag.toml::low": "PASSED",
        "scenarios/lag.toml::high": "FAILED",
        "scenarios/lag.toml::drop": "FAILED",
        "scenarios/deep/free.toml::run": "SKIPPED",
    }
    assert re.search(r"^the lag rises: `end` is [\d.]+ \S*m, limit >= 2 km$", text, re.MULTILINE), text
    assert "the lag falls below 0: `dropped` is not as claimed\n" in text
    assert "no criteria" in text
    assert "Traceback" not in text
    assert sorted((folder / "runs").read_text().split()) == ["deep/free", "lag"]
    assert '<property name="unit" value="m"' in (folder / "out.xml").read_text()


def test_a_named_file_is_collected_wherever_it_is(write: Write, folder: Path) -> None:
    write(END + MEETS, "my.toml")
    assert started("--cosim", "my.toml", "-q")[0] == 0
    assert started("--cosim", "my.toml::low", "-q")[0] == 0


def test_without_the_option_nothing_is_collected_or_imported(write: Write, folder: Path) -> None:
    write(END + MEETS, "scenarios/lag.toml")
    (folder / "test_own.py").write_text(
        "import sys\ndef test_own():\n    assert not {'cosim.errors', 'numpy', 'fmpy'} & set(sys.modules)\n"
    )
    code, text = started("-q")
    assert (code, "1 passed" in text) == (0, True), text


@pytest.mark.parametrize(
    ("added", "said"),
    [
        ("[loop.nonsense]\n", "nonsense"),
        ('stop_when = "plant.nothing > 0"', "plant.nothing"),
    ],
)
def test_an_error_of_a_scenario_is_its_message(write: Write, folder: Path, added: str, said: str) -> None:
    file = write(END + MEETS, "scenarios/lag.toml")
    file.write_text(file.read_text().replace("duration = 0.05", f"duration = 0.05\n{added}"))
    code, text = started("--cosim", "scenarios")
    assert code in (1, 2)
    assert said in text
    assert "Traceback" not in text
    assert "cosim/" not in text.replace("cosim/pytest_plugin", "")


def test_a_crash_of_an_fmu_fails_the_tests_of_its_scenario(write: Write, folder: Path) -> None:
    write(END + MEETS + "\n[controller.parameters]\ncrash_at = 3\n", "scenarios/lag.toml")
    write(END + MEETS, "scenarios/sound.toml")
    code, text = started("--cosim", "scenarios")
    assert code == 1
    assert "1 failed, 1 passed" in text, text
    assert "crashed" in text


def test_a_worker_of_xdist_gets_whole_scenarios(write: Write, folder: Path) -> None:
    (folder / "conftest.py").write_text(COUNTED)
    for name in ("one", "two", "three"):
        write(END + MEETS + TRUE + CLAIM, f"scenarios/{name}.toml")
    code, text = started("--cosim", "scenarios", "-n", "2", "--dist", "loadgroup")
    assert code == 1
    assert "3 failed, 3 passed" in text, text
    assert sorted((folder / "runs").read_text().split()) == ["one", "three", "two"]
