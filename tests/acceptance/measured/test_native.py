"""Numbers of the pages that the tests of the controllers measure in Rust.

On the small plants of `tests/closed_loop`; they print lines `measured: TABLE | ROW | NAME=VALUE NAME=VALUE`.
"""

import re
import subprocess

import pytest

from .store import ROOT, measured

TESTS = {
    "dob": ("table_of_depths", "hours"),
    "fts": ("each_layer_of_the_table", "whole_table", "two_hours"),
    "deburr": ("errors", "every_weight", "ten_hours"),
    "polish": ("tables", "ten_hours"),
    "centering": ("ten_hours",),
}
"""Ignored tests of each controller, by what is in their names."""
LINE = re.compile(r"measured: ([\w-]+) \| (.+?) \|((?: \w+=\S+)+)$", re.MULTILINE)


def lines(printed: str) -> list[tuple[str, str, dict[str, float]]]:
    """Tables, rows and values that a test printed."""
    return [
        (table, row, {name: float(value) for name, value in re.findall(r"(\w+)=(\S+)", values)})
        for table, row, values in LINE.findall(printed)
    ]


@pytest.mark.full
@pytest.mark.parametrize(("name", "test"), [(name, test) for name, tests in TESTS.items() for test in tests])
def test_what_a_controller_measures_on_its_own(name: str, test: str) -> None:
    line = ["cargo", "test", "--release", "-p", f"fmu-{name}", "--test", "closed_loop", "--", test]
    line += ["--ignored", "--nocapture", "--test-threads", "1"]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    found = lines(done.stdout)
    assert found, f"`{' '.join(line)}` measured nothing"
    for table, row, values in found:
        measured(table, row, **values)


def test_a_line_that_a_test_printed_is_a_row() -> None:
    printed = "running 1 test\nmeasured: fts-layers | 3 cm, 870 rpm | rms=0.37 tip=1e-3\nok\n"
    assert lines(printed) == [("fts-layers", "3 cm, 870 rpm", {"rms": 0.37, "tip": 1e-3})]
