"""Malformed CL files are rejected before any motion, with line and reason."""

from collections.abc import Callable
from pathlib import Path

import pytest

import cosim

pytestmark = pytest.mark.acceptance

RESOURCES = Path(__file__).parents[3] / "fmu-polish/resources"
HEAD = 5
"""Lines before the first point."""

Lines = list[str]


def point(lines: Lines, index: int) -> list[float]:
    return [float(number) for number in lines[index].removeprefix("GOTO/").split(",")]


def goto(numbers: list[float]) -> str:
    return "GOTO/" + ",".join(f"{number:.6f}" for number in numbers)


def flipped_normal(lines: Lines) -> Lines:
    x, y, z, i, j, k = point(lines, 100)
    return [*lines[:100], goto([x, y, z, -i, -j, -k]), *lines[101:]]


def gap(lines: Lines) -> Lines:
    return [*lines[:100], *lines[130:]]


def long_normal(lines: Lines) -> Lines:
    x, y, z, i, j, k = point(lines, 100)
    return [*lines[:100], goto([x, y, z, 1.1 * i, 1.1 * j, 1.1 * k]), *lines[101:]]


def fold(lines: Lines) -> Lines:
    # a hollow of 0.3 mm: the ball of 0.5 mm does not fit
    spot = [0.3 * number for number in (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45)]
    rows = [[x, 0.0, 0.3 - (0.09 - x * x) ** 0.5, -x / 0.3, 0.0, (1.0 - x * x / 0.09) ** 0.5] for x in spot]
    return [*lines[:HEAD], *map(goto, rows), "FINI"]


def not_a_number(lines: Lines) -> Lines:
    return [*lines[:100], "GOTO/nan,0,0,0,0,1", *lines[101:]]


def too_many_points(lines: Lines) -> Lines:
    rows = [f"GOTO/{0.0011 * k:.4f},0,0,0,0,1" for k in range(200_001)]
    return [*lines[:HEAD], *rows, "FINI"]


def wrong_units(lines: Lines) -> Lines:
    return [line.replace("UNITS/MM", "UNITS/FURLONG") for line in lines]


def empty(_: Lines) -> Lines:
    return []


def out_of_stroke(lines: Lines) -> Lines:
    rows = [[x + 300.0, y, z, i, j, k] for x, y, z, i, j, k in (point(lines, n) for n in range(5, 60))]
    return [*lines[:HEAD], *map(goto, rows), "FINI"]


MALFORMED: dict[str, tuple[Callable[[Lines], Lines], int]] = {
    "flipped normal": (flipped_normal, 101),
    "gap": (gap, 101),
    "normal that is no unit vector": (long_normal, 101),
    "fold": (fold, 7),
    "NaN": (not_a_number, 101),
    "too many points": (too_many_points, 200_006),
    "wrong units": (wrong_units, 3),
    "empty": (empty, 1),
    "out of stroke": (out_of_stroke, 6),
}


def refused(file: Path) -> str:
    with pytest.raises(cosim.CosimError) as caught:
        cosim.run(cosim.load("polish", set=[f"controller.path.file='{file}'"]))
    return f"{caught.value.message}\n{caught.value.hint}"


@pytest.mark.parametrize("case", MALFORMED)
def test_a_malformed_file_is_rejected_with_line_and_reason(case: str, tmp_path: Path) -> None:
    change, line = MALFORMED[case]
    file = tmp_path / "path.cls"
    lines = (RESOURCES / "led-short.cls").read_text(encoding="ascii").splitlines()
    file.write_text("\n".join(change(lines)) + "\n", encoding="ascii")
    told = refused(file)
    print(told)
    assert "path.file" in told
    assert f"line {line}" in told


def test_binary_junk_is_rejected(tmp_path: Path) -> None:
    file = tmp_path / "path.cls"
    file.write_bytes(bytes(range(256)) * 100)
    told = refused(file)
    print(told)
    assert "line" in told


def test_a_missing_file_is_rejected(tmp_path: Path) -> None:
    assert "path.file" in refused(tmp_path / "no.cls")
