"""A sweep on two workers against cores that only run, and its memory; JSON for `cargo xtask bench`."""

from __future__ import annotations

import contextlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import mean
from typing import Any, NamedTuple

from cosim.pool.worker import JobRunner
from cosim.sweep import study
from cosim.sweep.command import Options, execute
from cosim.sweep.plan import Plan

WORKERS = 2
ALONE = 60
"""Maximum number of runs of a core that does only the runs, each time."""
STUDY = """
scenario = "dob"

[design]
kind = "monte-carlo"
samples = {}

[[vary]]
key = "plant.stiffness"
minimum = 1e5
maximum = 1e7
distribution = "log-uniform"

[[vary]]
key = "controller.approach.velocity"
minimum = 9e-5
maximum = 1e-4

[traces]
failed = 0
"""


class Cores(NamedTuple):
    """Cores that do only the runs: their rate, 1/s, and the processor time of one run, s."""

    rate: float
    processor: float


def core(runs: int) -> Cores:
    """Do the first runs of the study in this process."""
    with tempfile.TemporaryDirectory() as folder:
        plan = Plan(study.load(written(folder, runs + 1)))
    jobs = [plan.job(run) for run in plan.runs]
    with contextlib.closing(JobRunner()) as runner:
        # the first opens FMU and plant
        runner.run(jobs[0])
        begin, spent = time.perf_counter(), time.process_time()
        for job in jobs[1:]:
            runner.run(job)
        return Cores(runs / (time.perf_counter() - begin), (time.process_time() - spent) / runs)


def cores(count: int, runs: int) -> Cores:
    """Do the runs in parallel processes."""
    command = [sys.executable, __file__, "core", str(runs)]
    processes = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(count)]
    reported = [process.communicate()[0] for process in processes]
    assert all(process.returncode == 0 for process in processes)
    found = [Cores(*json.loads(text)) for text in reported]
    return Cores(sum(one.rate for one in found), mean(one.processor for one in found))


def written(folder: str, runs: int) -> Path:
    """File of the study."""
    file = Path(folder) / "study.toml"
    file.write_text(STUDY.format(runs))
    return file


def sweep(runs: int) -> dict[str, Any]:
    """Run a sweep: rate, 1/s, processor time of all processes for a run, s, and their memory, MB."""
    with tempfile.TemporaryDirectory() as folder:
        file = written(folder, runs)
        begin = time.perf_counter()
        found, _ = execute(Options(file, Path(folder) / "out", WORKERS, plots=False, quiet=True))
        took = time.perf_counter() - begin
        assert found.results == runs, found.troubles
        parent, workers = (
            resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        )
        return {
            "rate": runs / took,
            "processor": sum(part.ru_utime + part.ru_stime for part in (parent, workers)) / runs,
            "memory": (parent.ru_maxrss + WORKERS * workers.ru_maxrss) * 1024 / 1e6,
        }


def in_process_of_its_own(runs: int) -> dict[str, Any]:
    """Run a sweep in a new process: peaks of memory never go down."""
    command = [sys.executable, __file__, "sweep", str(runs)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=os.environ)
    return dict(json.loads(done.stdout))


def main(runs: int) -> dict[str, Any]:
    """Run two sweeps, one of a fifth of the runs, and before and after them cores that only run."""
    few = min(ALONE, runs)

    def only_run() -> tuple[Cores, Cores]:
        return cores(1, few), cores(WORKERS, few)

    before = only_run()
    fifth, whole = in_process_of_its_own(runs // 5), in_process_of_its_own(runs)
    alone, beside = zip(before, only_run(), strict=True)
    return {
        **whole,
        "throughput": whole["rate"] / WORKERS / mean(one.rate for one in alone),
        "beside": whole["rate"] / mean(one.rate for one in beside),
        "processor": whole["processor"] / mean(one.processor for one in beside),
        "growth": whole["memory"] / fifth["memory"],
    }


if __name__ == "__main__":
    tasks = {"core": core, "sweep": sweep, "all": main}
    task, number = sys.argv[1:]
    json.dump(tasks[task](int(number)), sys.stdout)
