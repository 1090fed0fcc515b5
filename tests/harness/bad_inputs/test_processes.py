"""Bad inputs that ask for more: deep values, own plants, crashes, hangs, a full disk."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from .. import test_cli
from . import fmus, models, studies
from .calling import check_refusal

PLANTS = {
    "NoParameters": ("del Parameters", ("`own:Bad`", "`reset`")),
    "DictParameters": ("Parameters = dict", ("`own:Bad`", "`Parameters`")),
    "NoReset": ("reset = None", ("`own:Bad`",)),
    "NoChannels": ('readings = ("x",)', ("`own:Bad`", "no attribute 'name'")),
    "NoTimestep": ("timestep = None", ("`own:Bad`", "`timestep`")),
    "Timestep0": ("timestep = 0.0", ("`own:Bad`", "`timestep`")),
    "TwoChannels": ("readings = (probe_plants.Channel('x'),) * 2", ("`own:Bad`", "`x`")),
    "SenseTwo": ("def sense(self): return [1.0, 2.0]", ("`sense` of the plant", "(2,)")),
    "TruthScalar": ("def truth(self): return 1.0", ("`truth` of the plant", "single value")),
    "RaisesInInit": ("def __init__(self, parameters): raise RuntimeError('boom')", ("`own:Bad`", "boom")),
    "ExitsInInit": ("def __init__(self, parameters): raise SystemExit(0)", ("`own:Bad`",)),
    "ExitsInStep": ("def advance(self, substeps): raise SystemExit(0)", ("`own:Bad`",)),
}
CRASHES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(fmus.CRASHES, ()),
    "real_time_signal": ("signal",),
    "close_files": (),
}
"""Defects that end or starve the process of `cosim run`."""


@pytest.mark.parametrize(("body", "words"), PLANTS.values(), ids=PLANTS)
def test_a_bad_plant_is_named(body: str, words: tuple[str, ...], lag: Path) -> None:
    inherited = "" if body.startswith("del") else f"    {body}\n"
    base = "object" if body.startswith("del") else "probe_plants.Lag"
    (lag / "own.py").write_text(f"import probe_plants\n\n\nclass Bad({base}):\n    pass\n{inherited}")
    done = test_cli.cosim("run", "lag.toml", "--set", "plant.name=own:Bad")
    check_refusal(words, done.returncode, done.stdout, done.stderr)


@pytest.mark.parametrize("value", ["inf", "nan"])
def test_a_study_of_infinite_values_keeps_its_rows(lag: Path, value: str) -> None:
    case = f'[[case]]\n"wire.plant.u.maximum" = {value}\n[[case]]\n"wire.plant.u.maximum" = 2.0\n'
    (lag / "study.toml").write_text(studies.LIST + case)
    done = test_cli.cosim("sweep", "study.toml", "--no-plots", "--workers", "1")
    assert "Traceback" not in done.stderr
    assert done.returncode in (0, 2)


@pytest.mark.parametrize(("name", "words"), CRASHES.items(), ids=CRASHES)
def test_a_library_that_ends_its_process_is_named(
    name: str, words: tuple[str, ...], lag: Path, broken_library: bytes
) -> None:
    fmus.defect(name)(lag / "broken.fmu", broken_library)
    done = test_cli.cosim("run", "lag.toml", "--set", "controller.fmu=broken.fmu")
    check_refusal(words, done.returncode, done.stdout, done.stderr)


def test_a_library_that_hangs_is_named(lag: Path, broken_library: bytes) -> None:
    fmus.defect("hang")(lag / "broken.fmu", broken_library)
    done = test_cli.cosim("run", "lag.toml", "--set", "controller.fmu=broken.fmu", "--timeout", "1")
    check_refusal(("timeout",), done.returncode, done.stdout, done.stderr)


def test_a_model_that_takes_for_ever_is_named(lag: Path) -> None:
    many = '<worldbody><replicate count="100000000"><geom size="0.1"/></replicate>'
    (lag / "model.xml").write_text(models.edited("<worldbody>", many))
    (lag / "model.toml").write_text(models.WIRED)
    done = test_cli.cosim("run", "model.toml", "--timeout", "5")
    check_refusal((), done.returncode, done.stdout, done.stderr)


@pytest.mark.usefixtures("lag")
@pytest.mark.parametrize("options", [[], ["--json", "-"]])
def test_a_full_disk_at_the_output_is_named(options: list[str]) -> None:
    command = [sys.executable, "-m", "cosim", "run", "lag.toml", *options]
    variables = {**os.environ, "PYTHONPATH": str(test_cli.ROOT)}
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            command, stdout=full, stderr=subprocess.PIPE, text=True, env=variables, check=False
        )
    check_refusal(("No space left",), done.returncode, "", done.stderr)


def test_a_library_that_forks_answers_once(lag: Path, broken_library: bytes) -> None:
    fmus.defect("fork")(lag / "broken.fmu", broken_library)
    done = test_cli.cosim("run", "lag.toml", "--set", "controller.fmu=broken.fmu", "--json", "-")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["metrics"]["end"]["value"] > 0.0


def test_what_a_library_started_ends_with_its_crash(lag: Path, broken_library: bytes) -> None:
    """Else it would hold the streams of the command, for which this test waits."""
    fmus.defect("orphan")(lag / "broken.fmu", broken_library)
    done = test_cli.cosim("run", "lag.toml", "--set", "controller.fmu=broken.fmu")
    check_refusal(("killed by SIGSEGV",), done.returncode, done.stdout, done.stderr)


def test_what_a_library_started_and_set_free_ends_with_the_command(lag: Path, broken_library: bytes) -> None:
    fmus.defect("runaway")(lag / "broken.fmu", broken_library)
    done = test_cli.cosim("run", "lag.toml", "--set", "controller.fmu=broken.fmu")
    assert done.returncode == 0, done.stderr
    status = Path("/proc", (lag / "runaway").read_text(), "status")
    # a zombie is dead, too
    assert not status.exists() or "State:\tZ" in status.read_text()


@pytest.mark.parametrize("name", ["numpy", "json", "random"])
def test_a_file_named_as_a_package_affects_no_worker(name: str, lag: Path) -> None:
    (lag / f"{name}.py").write_text("raise SystemExit('not the package')\n")
    (lag / "own.py").write_text("import probe_plants\n\n\nclass Own(probe_plants.Lag):\n    pass\n")
    # as the installed command starts, without the working directory in the search path of packages
    command = [sys.executable, "-P", "-c", "from cosim.cli import main; main()"]
    options = ["run", "lag.toml", "--set", "plant.name=own:Own"]
    done = subprocess.run([*command, *options], capture_output=True, text=True, check=False, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
