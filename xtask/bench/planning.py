"""Time and memory of planning a large study, before the first run begins; JSON for `cargo xtask bench`."""

from __future__ import annotations

import json
import resource
import sys
import tempfile
import time
from pathlib import Path

from sweep import STUDY

from cosim.sweep import study
from cosim.sweep.plan import Plan


def main(runs: int) -> None:
    """Plan a study with a number of runs and print time and peak memory of this process."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "study.toml"
        file.write_text(STUDY.format(runs))
        begin = time.perf_counter()
        planned = len(Plan(study.load(file)).runs)
        took = time.perf_counter() - begin
    assert planned == runs, planned
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
    json.dump({"time": took, "memory": memory}, sys.stdout)


if __name__ == "__main__":
    main(int(sys.argv[1]))
