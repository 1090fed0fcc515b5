"""Every scenario passes its criteria, and every loop is reproducible; new scenario files are included."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cosim

from .samples.runs import WORKERS

pytestmark = pytest.mark.acceptance

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "scenarios"
NAMES = [str(file.relative_to(FOLDER).with_suffix("").as_posix()) for file in sorted(FOLDER.rglob("*.toml"))]
LOOPS = [file.stem for file in sorted(FOLDER.glob("*.toml"))]

# nothing was tuned on these seeds
SOME = (52_001,)
MANY = (52_002, 52_003)


@pytest.mark.parametrize("seeds", [SOME, pytest.param(MANY, marks=pytest.mark.full)], ids=["some", "many"])
@pytest.mark.parametrize("name", NAMES)
def test_criteria_hold(name: str, seeds: tuple[int, ...]) -> None:
    failed = [
        f"seed {result.seed}: {verdict.criterion.id} = {verdict.value:g} {verdict.unit}, {verdict.limits}"
        for result in cosim.run_many(cosim.load(name), seeds, WORKERS)
        for verdict in result.criteria
        if not verdict.passed
    ]
    assert not failed, "\n".join(failed)


@pytest.mark.parametrize("loop", LOOPS)
def test_same_seed_same_bytes(loop: str, tmp_path: Path) -> None:
    scenario = cosim.load(loop)
    first = cosim.run(scenario, 73).trace
    assert first is not None
    # from the first row to the last the native engine, by which the other tests run, gives what FMPy gives,
    # here in another process, by the command line
    file = tmp_path / "trace.npz"
    command = [sys.executable, "-m", "cosim", "run", loop, "--engine", "native", "--seed", "73"]
    command += ["--trace", str(file)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    with np.load(file) as archive:
        assert archive[archive.files[0]].tobytes() == first.tobytes()
    # and another seed what is another
    short = cosim.load(loop, ["loop.duration=0.1"])
    same, other = (cosim.run(short, seed, engine="native").trace for seed in (73, 74))
    assert same is not None
    assert other is not None
    assert same.tobytes() == first[: len(same)].tobytes()
    assert other.tobytes() != same.tobytes()
