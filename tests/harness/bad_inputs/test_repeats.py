"""State that an FMU or plant keeps in its process changes no later run."""

from __future__ import annotations

import importlib
import math
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest

import cosim
from cosim.errors import CosimError
from cosim.loop import repeats
from cosim.loop.repeats import NewProcessError
from cosim.pool import executor
from cosim.pool.job import Job
from cosim.pool.limits import Limits

from ..conftest import DATA, entry
from ..sweep import studies
from . import fmus

Write = Callable[..., Path]
KEEPING = ["reset_nothing", "static"]
"""Defects of FMUs: a reset without an effect, and a static variable that outlives its library."""
GAINS = (0.1, 0.2, 0.3, 0.4)
NEW_PROCESS = "; the run gets a new process"
LAW = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

class {name}(Fmi2Slave):
    seen = []

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u = self.y = 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        {body}
        return True
"""
ALONE = """
title = "A script"
loop = {step = 0.01, duration = 0.05}
controller = {fmu = "./Law.fmu"}
signal = [{to = "controller.u", times = [0.0], values = [1.0]}]
metric = [{name = "y", value = "max(controller.y)"}]
"""


@pytest.fixture(autouse=True)
def _new_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ignore the runs of other tests in this process."""
    monkeypatch.setattr(repeats, "first_runs", {})
    monkeypatch.setattr(repeats, "verdicts", {})
    monkeypatch.delitem(sys.modules, "law", raising=False)


def keeping(lag: Path, library: bytes, defect: str) -> list[dict[str, object]]:
    """Write an FMU that keeps state and a study; return the metrics of each case in its own process."""
    fmus.defect(defect)(lag / "keeping.fmu", library)
    cases = [f'controller.gain = {gain}\ncontroller.fmu = "keeping.fmu"' for gain in GAINS]
    (lag / "study.toml").write_text(studies.case_list(cases))
    changes = [[f"controller.gain={gain}", "controller.fmu=keeping.fmu"] for gain in GAINS]
    return [values(cosim.run(cosim.load("lag.toml", change), isolated=True)) for change in changes]


def values(result: cosim.Result) -> dict[str, object]:
    """Values of the metrics."""
    return {name: metric.value for name, metric in result.metrics.items()}


@pytest.mark.parametrize("workers", ["1", "2", "4"])
@pytest.mark.parametrize("defect", KEEPING)
def test_a_sweep_of_an_fmu_that_keeps_state_gives_the_results_of_single_runs(
    defect: str, workers: str, lag: Path, broken_library: bytes
) -> None:
    expected = keeping(lag, broken_library, defect)
    done = studies.sweep("study.toml", "--workers", workers)
    assert [row["metrics"] for row in studies.rows(lag / "study.sweep")] == expected
    if workers != "4":
        who = "the FMU `keeping.fmu` or the plant `probe_plants:Lag`"
        assert f"{who} keeps state: its first run gives other results when it is repeated" in done.stderr
        assert done.stderr.count("every run gets a new process") == 1


@pytest.mark.parametrize("defect", KEEPING)
def test_runs_from_python_do_not_depend_on_earlier_ones(
    defect: str, lag: Path, broken_library: bytes
) -> None:
    expected = keeping(lag, broken_library, defect)
    scenarios = [
        cosim.load("lag.toml", [f"controller.gain={gain}", "controller.fmu=keeping.fmu"]) for gain in GAINS
    ]
    assert [values(cosim.run(scenario)) for scenario in scenarios] == expected
    for workers in (1, 2):
        outcomes = cosim.run_each(scenarios, workers)
        assert [values(one) for one in outcomes if isinstance(one, cosim.Result)] == expected
    repeats.verdicts.clear()
    repeats.first_runs.clear()
    with cosim.Session(scenarios[0]) as session:
        session.run()
        with pytest.raises(NewProcessError, match="keeps state"):
            session.run()


def test_runs_from_python_do_not_see_environment_variables_that_an_earlier_one_set(
    lag: Path, broken_library: bytes
) -> None:
    # checked in a process of its own, because C code changes the environment of the process
    expected = keeping(lag, broken_library, "counter_variable")[0]
    code = (
        'import cosim; load = cosim.load("lag.toml", ["controller.gain=0.1", "controller.fmu=keeping.fmu"])\n'
        "for _ in range(3): print(*(m.value for m in cosim.run(load).metrics.values()))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == f"{' '.join(map(str, expected.values()))}\n" * 3


PLANT = """
import probe_plants
runs = []
class Keeping(probe_plants.Lag):
    def reset(self, seed, duration):
        super().reset(seed, duration)
        runs.append(1)
        self.x = {start}
"""


def test_a_plant_that_keeps_state_has_a_process_for_each_run(lag: Path) -> None:
    (lag / "keeping.py").write_text(PLANT.format(start="float(len(runs))"))
    scenario = cosim.load("lag.toml", ["plant.name=keeping:Keeping"])
    for workers in (1, 2):
        first, *others = (values(result) for result in cosim.run_many(scenario, [1, 1, 1], workers))
        assert others == [first, first]


def test_a_plant_with_the_name_of_one_in_another_folder_is_checked_too(lag: Path, tmp_path: Path) -> None:
    other = shutil.copytree(lag, tmp_path / "other")
    for folder, start in ((lag, "1.0"), (other, "float(len(runs))")):
        (folder / "keeping.py").write_text(PLANT.format(start=start))
    found = [
        values(cosim.run(cosim.load(folder / "lag.toml", ["plant.name=keeping:Keeping"])))
        for folder in (lag, lag, other, other, other)
    ]
    assert found == [found[0]] * 5


def test_an_fmu_that_repeats_its_results_costs_one_run_for_each_worker(lag: Path) -> None:
    (lag / "counting.py").write_bytes((DATA / "counting.py").read_bytes())
    cases = [f'controller.gain = {gain}\nplant.name = "counting:Counting"' for gain in GAINS]
    (lag / "study.toml").write_text(studies.case_list(cases))
    studies.sweep("study.toml", "--workers", "1")
    processes = (lag / "processes").read_text().split()
    assert (len(processes), len(set(processes))) == (len(GAINS) + 1, 1)


def test_a_run_and_the_repetition_before_it_have_each_their_time(lag: Path) -> None:
    (lag / "slow.py").write_text(
        "import time, probe_plants\nclass Slow(probe_plants.Lag):\n    def reset(self, seed, duration):\n"
        "        time.sleep(2.0)\n        super().reset(seed, duration)\n"
    )
    cases = [f'controller.gain = {gain}\nplant.name = "slow:Slow"' for gain in GAINS[:2]]
    (lag / "study.toml").write_text(studies.case_list(cases, "timeout = 3.5"))
    studies.sweep("study.toml", "--workers", "1")
    assert [row["status"] for row in studies.rows(lag / "study.sweep")] == ["passed"] * 2


def test_the_repetition_of_a_run_logs_nothing(lag: Path, caplog: pytest.LogCaptureFixture) -> None:
    text = (lag / "lag.toml").read_text()
    (lag / "first.toml").write_text(text.replace(', "plant.extra"', ""))
    first = cosim.load("first.toml", ["controller.warn_at=3"])
    cosim.run(first)
    logged = caplog.messages.copy()
    for message in ("something is odd", "nothing drives"):
        assert any(message in one for one in logged)
    caplog.clear()
    cosim.run(cosim.load("lag.toml"))
    assert caplog.messages == []
    cosim.run(first)
    assert caplog.messages == logged


def script(folder: Path, body: str, name: str = "Law", file: str = "law.py") -> Path:
    """Build an FMU of a Python script in a folder, with a scenario in which it runs alone."""
    folder.mkdir()
    (folder / file).write_text(LAW.format(name=name, body=body))
    build = [sys.executable, "-m", "pythonfmu", "build", "-f", file]
    subprocess.run(build, cwd=folder, check=True, capture_output=True)
    (folder / "alone.toml").write_text(ALONE.replace("Law", name))
    return folder / "alone.toml"


def test_scripts_of_one_name_are_kept_apart(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    loops = [
        script(folder / "one", "self.y = 2.0 * self.u"),
        script(folder / "two", "self.y = 10.0 * self.u"),
        script(folder / "three", "self.y = 30.0 * self.u", "Other"),
    ]
    expected = [2.0, 10.0, 30.0]
    for workers in (1, 2):
        outcomes = cosim.run_each(loops, workers)
        assert [one.metrics["y"].value for one in outcomes if isinstance(one, cosim.Result)] == expected
    assert [cosim.run(loop).metrics["y"].value for loop in loops] == expected
    warnings = [message for message in caplog.messages if NEW_PROCESS in message]
    assert len(warnings) == 2
    assert all(warning.endswith(f"the Python module `law` differs{NEW_PROCESS}") for warning in warnings)


def test_a_script_with_the_name_of_an_imported_module_has_a_new_process(
    folder: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    loop = script(folder / "one", "self.y = 2.0 * self.u")
    (folder / "law.py").write_text("")
    monkeypatch.syspath_prepend(folder)
    importlib.import_module("law")
    assert cosim.run(loop).metrics["y"].value == 2.0
    (warning,) = (message for message in caplog.messages if NEW_PROCESS in message)
    assert warning.endswith(f"in place of its own module{NEW_PROCESS}")


def test_the_state_of_a_class_in_a_script_does_not_pass_to_the_next_run(folder: Path) -> None:
    loop = script(folder / "one", "self.seen.append(1); self.y = float(len(self.seen))")
    for workers in (1, 2):
        assert [one.metrics["y"].value for one in cosim.run_many(loop, [1, 2, 3], workers)] == [5.0] * 3
    assert [cosim.run(loop).metrics["y"].value for _ in range(3)] == [5.0] * 3


def test_two_scripts_of_one_name_in_one_loop_are_rejected(folder: Path) -> None:
    for name, gain in (("one", 2.0), ("two", 10.0), ("same", 2.0)):
        script(folder / name, f"self.y = {gain} * self.u")
    text = 'title = "both"\nloop = {step = 0.01, duration = 0.05}\n'
    both = folder / "both.toml"
    both.write_text(text + "".join(entry("fmu", name=name, fmu=f"{name}/Law.fmu") for name in ("one", "two")))
    with pytest.raises(
        CosimError, match="`one` and `two` bring different versions of the Python module `law`"
    ):
        cosim.run(both)
    both.write_text(
        text + "".join(entry("fmu", name=name, fmu=f"{name}/Law.fmu") for name in ("one", "same"))
    )
    assert cosim.run(both).simulated_s == 0.05


def test_a_script_with_the_name_of_the_module_of_a_plant_is_rejected(folder: Path) -> None:
    loop = script(folder / "one", "self.y = self.u")
    (folder / "one" / "law.py").write_text("from probe_plants import Lag")
    problem = (
        r"`.*Law.fmu` would use `.*law.py` in place of its own module\nhint: Rename one of the modules\."
    )
    with pytest.raises(CosimError, match=problem):
        cosim.run(cosim.load(loop, ["plant.name=law:Lag", "loop.step=0.001"]))


def test_a_script_does_not_see_what_another_one_left_in_a_worker(folder: Path) -> None:
    loops = [
        script(folder / "one", "import math; math.tau = self.y = self.u", file="one.py"),
        script(folder / "two", "import math; self.y = math.tau", file="two.py"),
    ]
    jobs = [(number, Job(cosim.load(loop), 1, "reference", False)) for number, loop in enumerate(loops)]
    found = [outcome for _, outcome in executor.outcomes(jobs, 1, Limits())]
    assert [one.metrics["y"].value for one in found if isinstance(one, cosim.Result)] == [1.0, math.tau]


def test_libraries_of_one_name_in_one_loop_are_rejected(folder: Path, probe_library: bytes) -> None:
    library = f"binaries/{fmpy.platform}/libhelp.so"
    for name, content in (("one", b"1"), ("two", b"2"), ("same", b"1")):
        # a library names those that it needs
        fmus.holding({library: content})(folder / f"{name}.fmu", probe_library + b"libhelp.so")
    text = 'title = "both"\nloop = {step = 0.001, duration = 0.005}\n'
    both = folder / "both.toml"
    both.write_text(text + "".join(entry("fmu", name=name, fmu=f"{name}.fmu") for name in ("one", "two")))
    with pytest.raises(CosimError, match=r"different versions of the library `libhelp\.so`; a process loads"):
        cosim.run(both)
    both.write_text(text + "".join(entry("fmu", name=name, fmu=f"{name}.fmu") for name in ("one", "same")))
    assert cosim.run(both).simulated_s == 0.005
