"""Throughput and memory of a sweep on two workers, against one core alone; JSON for `cargo xtask bench`."""

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
from typing import Any

from cosim.pool.worker import JobRunner
from cosim.sweep import study
from cosim.sweep.command import Options, execute
from cosim.sweep.plan import Plan

WORKERS = 2
ALONE = 40
"""At most so many runs of the study are done in this process, for the rate of one core."""
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


def one_core(file: Path) -> tuple[float, float]:
    """Rate of one core that does nothing but the runs, 1/s, and its processor time for one, s."""
    plan = Plan(study.load(file))
    jobs = [plan.job(run) for run in plan.runs[: ALONE + 1]]
    count = len(jobs) - 1
    with contextlib.closing(JobRunner()) as runner:
        # the first opens FMU and plant
        runner.run(jobs[0])
        begin, spent = time.perf_counter(), time.process_time()
        for job in jobs[1:]:
            runner.run(job)
        return count / (time.perf_counter() - begin), (time.process_time() - spent) / count


def sweep(runs: int) -> dict[str, Any]:
    """Run a sweep; ratios are to one core alone, memory is that of all processes together."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "study.toml"
        file.write_text(STUDY.format(runs))
        begin = time.perf_counter()
        found, _ = execute(Options(file, Path(folder) / "out", WORKERS, plots=False, quiet=True))
        took = time.perf_counter() - begin
        assert found.results == runs, found.troubles
        parent, workers = (
            resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        )
        rate, processor = one_core(file)
        return {
            "throughput": runs / took / (WORKERS * rate),
            "rate": runs / took,
            "processor": sum(part.ru_utime + part.ru_stime for part in (parent, workers)) / runs / processor,
            "memory": (parent.ru_maxrss + WORKERS * workers.ru_maxrss) * 1024 / 1e6,
        }


def in_process_of_its_own(runs: int) -> dict[str, Any]:
    """Run a sweep in a new process: peaks of memory never go down."""
    command = [sys.executable, __file__, "sweep", str(runs)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=os.environ)
    return dict(json.loads(done.stdout))


if __name__ == "__main__":
    if sys.argv[1] == "sweep":
        json.dump(sweep(int(sys.argv[2])), sys.stdout)
    else:
        most = int(sys.argv[1])
        few, many = in_process_of_its_own(most // 5), in_process_of_its_own(most)
        json.dump({**many, "growth": many["memory"] / few["memory"]}, sys.stdout)
