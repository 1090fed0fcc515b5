"""Bad inputs that ask for more: deep values, own plants, crashes, hangs, a full disk."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from .. import test_cli
from . import fmus, models, scenarios, studies
from .calling import Case, Refuse, check_refusal, given

DIGITS = "9" * 5000
FILES: dict[str, tuple[str, tuple[str, ...]]] = {
    # the validator's: nesting, integers, types
    "deep array": ("x = " + "[" * 2000 + "]" * 2000, ("`bad.toml`", "nested")),
    "deep table": ("x = " + "{a = " * 2000 + "1" + "}" * 2000, ("`bad.toml`", "nested")),
    "deep key": (".".join("a" * 2000) + " = 1", ("`bad.toml`",)),
    "deep parameters": (
        scenarios.WHOLE + "[plant.parameters]\n" + ".".join("a" * 2000) + " = 1",
        ("`bad.toml`",),
    ),
    "integer of 5000 digits": (scenarios.edited("0.001", DIGITS), ("`bad.toml`",)),
    "integer above 1e308": (scenarios.edited("0.001", DIGITS[:400]), ("`loop.step`",)),
    "limit above 1e308": (
        scenarios.edited("maximum = 1.0", f"maximum = {DIGITS[:400]}"),
        ("`criterion[0].maximum`",),
    ),
    "parameter above 1e308": (
        scenarios.WHOLE + f"[controller.parameters]\ngain = {DIGITS[:400]}\n",
        ("`controller.parameters.gain`",),
    ),
    "delay is a number": (
        scenarios.edited("[loop]", "[loop]\ncompute_delay = 1.0"),
        ("`loop.compute_delay`", "1.0"),
    ),
    "delay is 0.0": (
        scenarios.edited("[loop]", "[loop]\ncompute_delay = 0.0"),
        ("`loop.compute_delay`", "0.0"),
    ),
    "minimum nan": (
        scenarios.edited('to = "plant.u"', 'to = "plant.u"\nminimum = nan'),
        ("`wire.plant.u.minimum`",),
    ),
    "minimum above maximum": (
        scenarios.edited('to = "plant.u"', 'to = "plant.u"\nminimum = 2.0\nmaximum = 1.0'),
        ("`wire.plant.u.minimum`", "2"),
    ),
    "plant is a module": (scenarios.edited("probe_plants:Lag", "os:path"), ("path` is no class",)),
    "plant is a function": (scenarios.edited("probe_plants:Lag", "os:_exit"), ("_exit` is no class",)),
    "plant is a dict": (scenarios.edited("probe_plants:Lag", "builtins:dict"), ("`builtins:dict`",)),
}
SETS = {
    "deep value": ("controller.gain=" + "[" * 2000 + "]" * 2000, ("controller.gain",)),
    "integer above 1e308": (f"controller.gain={DIGITS[:400]}", ("`controller.gain`",)),
    "integer of 5000 digits": (f"controller.gain={DIGITS}", ("controller.gain",)),
}
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
STUDIES: dict[str, tuple[str, tuple[str, ...]]] = {
    "too many dimensions": (
        studies.HEAD
        + 'kind = "sobol"\nsamples = 4\n'
        + "".join(f'[[vary]]\nkey = "wire.w{i}.noise"\nminimum = 0.0\nmaximum = 1.0\n' for i in range(21300)),
        ("21300",),
    ),
}
CRASHES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(fmus.CRASHES, ()),
    "real_time_signal": ("signal",),
    "close_files": (),
}
"""Defects that end or starve the process of `cosim run`."""


@pytest.mark.parametrize(("content", "words"), FILES.values(), ids=FILES)
def test_a_bad_scenario_is_named(
    content: str,
    words: tuple[str, ...],
    lag: Path,
    refuse: Refuse,
) -> None:
    (lag / "bad.toml").write_text(content)
    refuse(Case(given("run", "bad.toml"), words))


@pytest.mark.usefixtures("lag")
@pytest.mark.parametrize(("override", "words"), SETS.values(), ids=SETS)
def test_a_bad_override_is_named(
    override: str,
    words: tuple[str, ...],
    refuse: Refuse,
) -> None:
    refuse(Case(given("run", "lag.toml", "--set", override), words))


@pytest.mark.parametrize(("body", "words"), PLANTS.values(), ids=PLANTS)
def test_a_bad_plant_is_named(body: str, words: tuple[str, ...], lag: Path) -> None:
    inherited = "" if body.startswith("del") else f"    {body}\n"
    base = "object" if body.startswith("del") else "probe_plants.Lag"
    (lag / "own.py").write_text(f"import probe_plants\n\n\nclass Bad({base}):\n    pass\n{inherited}")
    done = test_cli.cosim("run", "lag.toml", "--set", "plant.name=own:Bad")
    check_refusal(words, done.returncode, done.stdout, done.stderr)


@pytest.mark.parametrize(("content", "words"), STUDIES.values(), ids=STUDIES)
def test_a_bad_study_is_named(
    content: str,
    words: tuple[str, ...],
    lag: Path,
    refuse: Refuse,
) -> None:
    (lag / "study.toml").write_text(content)
    refuse(Case(given("sweep", "study.toml", "--no-plots"), words))


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


@pytest.mark.parametrize("content", [None, "", "{}", '{"address": 5}', "not json"])
def test_a_bad_scheduler_file_is_named(content: str | None, lag: Path) -> None:
    (lag / "study.toml").write_text(studies.DRAWN + studies.RANGE)
    if content is not None:
        (lag / "dask.json").write_text(content)
    done = test_cli.cosim("sweep", "study.toml", "--cluster", "dask.json")
    check_refusal(("dask.json",), done.returncode, done.stdout, done.stderr)


@pytest.mark.usefixtures("lag")
@pytest.mark.parametrize("options", [[], ["--json", "-"]])
def test_a_full_disk_behind_the_output_is_named(options: list[str]) -> None:
    command = [sys.executable, "-m", "cosim", "run", "lag.toml", *options]
    variables = {**os.environ, "PYTHONPATH": str(test_cli.ROOT)}
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            command, stdout=full, stderr=subprocess.PIPE, text=True, env=variables, check=False
        )
    check_refusal(("No space left",), done.returncode, "", done.stderr)
