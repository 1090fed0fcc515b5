"""Files that are there only when they are whole."""

from __future__ import annotations

import contextlib
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from cosim.errors import CosimError
from cosim.writing import refused, whole, write


def test_a_link_stays_one_and_leads_to_the_whole_file(tmp_path: Path) -> None:
    link, target = tmp_path / "link.csv", tmp_path / "deep" / "target.csv"
    target.parent.mkdir()
    target.write_text("before")
    link.symlink_to(target)
    with whole(link) as file:
        file.write_text("after")
        assert target.read_text() == "before"
    assert link.is_symlink()
    assert target.read_text() == "after"
    assert sorted(path.name for path in tmp_path.rglob("*.csv*")) == ["link.csv", "target.csv"]


def test_what_fails_half_way_leaves_the_file_of_before(tmp_path: Path) -> None:
    file = tmp_path / "x.csv"
    file.write_text("before")

    def write() -> None:
        with whole(file) as part:
            part.write_text("half")
            raise OSError(28, "No space left on device")

    with pytest.raises(CosimError, match=r"cannot write `.*x\.csv`: No space left on device"):
        write()
    assert file.read_text() == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["x.csv"]


def test_two_writers_of_a_file_leave_one_whole_file(tmp_path: Path) -> None:
    file = tmp_path / "x.parquet"
    with contextlib.ExitStack() as stack:
        first, second = (stack.enter_context(whole(file)) for _ in range(2))
        assert first != second
        first.write_text("first")
        second.write_text("second")
    assert file.read_text() == "first"
    with contextlib.suppress(KeyError), whole(file) as kept:
        with contextlib.suppress(ValueError), whole(file) as failing:
            failing.write_text("failed")
            raise ValueError
        assert kept.exists()
        raise KeyError
    assert file.read_text() == "first"
    assert list(tmp_path.iterdir()) == [file]


def test_a_part_is_written_directly_and_named_as_its_file(tmp_path: Path) -> None:
    file = tmp_path / "x.y.npz"
    with whole(file) as part:
        with whole(part) as inner:
            assert inner == part
            inner.write_text("inside")
        assert part.exists()
        assert refused(part, OSError(28, "full")).message == f"cannot write `{file}`: full"
    assert file.read_text() == "inside"


def test_a_file_keeps_its_permissions(tmp_path: Path) -> None:
    file = tmp_path / "x.json"
    write("{}", file)
    (tmp_path / "plain").touch()
    assert file.stat().st_mode == (tmp_path / "plain").stat().st_mode
    file.chmod(0o640)
    write("{}", file)
    assert stat.S_IMODE(file.stat().st_mode) == 0o640


@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
@pytest.mark.parametrize("kind", ["json", "svg", "csv", "npz"])
def test_a_full_disk_keeps_the_file_of_before(kind: str, tmp_path: Path) -> None:
    file = tmp_path / f"x.{kind}"
    file.write_text("before")
    script = f"""
import resource, signal
import contextlib
import os
import stat
import subprocess
import sys
from pathlib import Path
import numpy as np
from cosim.show import figure
from cosim.trace import files
from cosim.trace.columns import Held
from cosim.writing import write

def draw():
    with figures.styled((3.0, 2.0)) as drawn:
        drawn.subplots().plot(table["x"])
        figures.save(drawn, file)

figures, file = figure, Path({str(file)!r})
table = np.zeros(5000, [("time", float), ("x", float)])
table["time"] = table["x"] = np.random.default_rng(0).random(5000)
def save():
    return files.save(Held(table), file, {{}})
make = {{"json": lambda: write("x" * 10_000, file), "svg": draw, "csv": save, "npz": save}}[{kind!r}]
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
make()
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert f"cannot write `{file}`: File too large" in done.stderr
    assert file.read_text() == "before"
    assert list(tmp_path.iterdir()) == [file]
