"""Molds and the CL data of a spiral over them."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from plants.tools.cl_path import Spiral, cl_text
from plants.tools.molds import MOLDS

Array = NDArray[np.float64]

ROOT = Path(__file__).parents[2]
RESOURCES = ROOT / "fmu-polish/resources"
SHORT = Spiral(outer=0.69e-3)
SHIPPED = {
    "led.cls": ("led", Spiral(), 0.0),
    "led-wrong-normals.cls": ("led", SHORT, 0.0872664626),
    **{f"{name}-short.cls": (name, SHORT, 0.0) for name in MOLDS},
}


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "plants.tools.cl_path", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def goto(text: str) -> Array:
    return np.array(
        [line.removeprefix("GOTO/").split(",") for line in text.splitlines() if line.startswith("GOTO/")],
        dtype=np.float64,
    )


@pytest.mark.parametrize("name", MOLDS)
def test_slopes_are_those_of_the_height(name: str) -> None:
    mold, step = MOLDS[name], 1e-7
    radius, angle = np.meshgrid(np.linspace(1e-6, mold.aperture, 20), np.linspace(0.0, 6.0, 20))
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    along_x, along_y = mold.gradient(x, y)
    rise_x = (mold.height(x + step, y) - mold.height(x - step, y)) / (2.0 * step)
    rise_y = (mold.height(x, y + step) - mold.height(x, y - step)) / (2.0 * step)
    np.testing.assert_allclose(along_x, rise_x, atol=1e-7)
    np.testing.assert_allclose(along_y, rise_y, atol=1e-7)
    assert mold.height(0.0, 0.0) == 0.0


def test_the_cap_is_a_sphere() -> None:
    mold, x, y = MOLDS["sphere"], np.array([0.0, 1e-3, -1.2e-3]), np.array([0.0, 0.3e-3, 1e-3])
    centre = np.array([0.0, 0.0, 3e-3])
    points = np.stack([x, y, mold.height(x, y)], axis=-1)
    np.testing.assert_allclose(np.linalg.norm(points - centre, axis=1), 3e-3)
    np.testing.assert_allclose(mold.normal(x, y), (centre - points) / 3e-3, atol=1e-12)


@pytest.mark.parametrize("name", MOLDS)
def test_points_are_evenly_spaced_and_turns_are_a_pick_feed_apart_along_the_surface(name: str) -> None:
    mold = MOLDS[name]
    points = Spiral().contact_points(mold)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert steps.max() <= 2e-5
    assert steps[50:].min() > 1.95e-5
    # crossings of the half plane y = 0, x > 0: one per revolution
    crossing = np.flatnonzero((points[:-1, 1] < 0.0) & (points[1:, 1] >= 0.0) & (points[1:, 0] > 0.0))
    x = points[crossing + 1, 0]
    fine = np.linspace(x[0], x[-1], 20_001)
    height = mold.height(fine, np.zeros_like(fine))
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fine), np.diff(height)))])
    apart = np.diff(np.interp(x, fine, way))
    np.testing.assert_allclose(apart[2:], 1e-4, rtol=0.05)


@pytest.mark.parametrize("file", SHIPPED)
def test_the_shipped_files_are_what_the_generator_writes(file: str) -> None:
    name, spiral, lean = SHIPPED[file]
    assert cl_text(name, spiral, lean=lean) == (RESOURCES / file).read_text(encoding="ascii")


def test_the_command_writes_the_same(tmp_path: Path) -> None:
    file = tmp_path / "saddle.cls"
    done = command("saddle", str(file), "--outer", "0.69e-3")
    assert (done.returncode, done.stderr) == (0, "")
    assert file.read_bytes() == (RESOURCES / "saddle-short.cls").read_bytes()


def test_a_file_holds_contact_points_and_unit_normals() -> None:
    rows = goto((RESOURCES / "led-short.cls").read_text(encoding="ascii"))
    mold = MOLDS["led"]
    points, normals = 1e-3 * rows[:, :3], rows[:, 3:]
    np.testing.assert_allclose(mold.height(points[:, 0], points[:, 1]), points[:, 2], atol=2e-9)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=2e-6)
    np.testing.assert_allclose(normals, mold.normal(points[:, 0], points[:, 1]), atol=2e-6)


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (("cube", "-"), "cube"),
        (("led", "-", "--spacing", "0"), "`0` is not a positive number"),
        (("led", "-", "--inner", "2e-3"), "--inner is 0.002 m"),
        (("led", "-", "--outer", "2e-3"), "--outer is 0.002 m"),
        (("led", "-", "--removal", "gone.csv", "--sweep", "6e-3"), "cannot read `gone.csv`: "),
        (("led", "-", "--removal", "plants/README.md", "--sweep", "6e-3"), "not a table"),
    ],
)
def test_nonsense_is_rejected_with_a_reason(arguments: tuple[str, ...], reported: str) -> None:
    done = command(*arguments)
    assert done.returncode == 2
    assert reported in done.stderr
    assert done.stdout == ""


def test_a_dwelling_feed_slides_equally_far_on_every_length() -> None:
    plain, dwelling = (cl_text("saddle", Spiral(), sweep=sweep) for sweep in (0.0, 6.6e-3))
    np.testing.assert_array_equal(goto(dwelling), goto(plain))
    lines = dwelling.splitlines()
    feeds = (
        np.array([float(line[7:].split(",")[0]) for line in lines if line.startswith("FEDRAT/")][1:]) / 60e3
    )
    rows = goto(dwelling)
    points, normals = 1e-3 * rows[:, :3], rows[:, 3:]
    step = np.linalg.norm(np.diff(points, axis=0), axis=1)
    ratio = np.linalg.norm(np.diff(points + 0.5e-3 * normals, axis=0), axis=1) / step
    # concave along x, convex along y
    assert ratio.min() == pytest.approx(1.0 - 0.5 / 6.0, abs=2e-3)
    assert ratio.max() == pytest.approx(1.0 + 0.5 / 6.0, abs=2e-3)
    way = np.hypot(ratio, 6.6e-3 / feeds[:-1])
    assert way.std() / way.mean() < 2e-4
    assert feeds.mean() == pytest.approx(2e-3, rel=1e-2)


def test_no_feed_is_more_than_doubled() -> None:
    text = cl_text("saddle", SHORT, sweep=1e-4)
    feeds = [float(line[7:].split(",")[0]) for line in text.splitlines() if line.startswith("FEDRAT/")]
    assert max(feeds) <= 240.0
