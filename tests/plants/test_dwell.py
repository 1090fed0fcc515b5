"""Feeds of a path: what is taken away with them is what a map wants."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from plants.tools import dwell
from plants.tools.cl_path import FOOTPRINT, Spiral, cl_text
from plants.tools.dwell import DepthMap
from plants.tools.molds import MOLDS
from plants.tools.removal import Surface, mismatch

Array = NDArray[np.float64]

MOLD = MOLDS["led"]
FEED, SWEEP, TOOL = 2e-3, 6.6e-3, 0.5e-3
AXIS = np.linspace(-1.2e-3, 1.2e-3, 49)
X, Y = np.meshgrid(AXIS, AXIS)


@pytest.fixture(scope="module")
def path() -> tuple[Array, Array]:
    """Return contact points and normals of a small spiral."""
    points = Spiral(outer=1.1e-3).contact_points(MOLD)
    return points, MOLD.normal(points[:, 0], points[:, 1])


def worn(path: tuple[Array, Array], feeds: Array, wanted: DepthMap) -> float:
    """Wear a mold by a ball with given sweeps; return the difference between depth and map."""
    points, normals = path
    length, centre = (np.linalg.norm(np.diff(p, axis=0), axis=1) for p in (points, points + TOOL * normals))
    slid = np.append(0.0, np.cumsum(np.hypot(centre, SWEEP * length / feeds[:-1])))
    surface = Surface(MOLD, radius=1.3e-3)
    surface.polish(points[:, 0], points[:, 1], slid, 5.0 * slid)
    return mismatch(surface, wanted, 0.2e-3, 0.9e-3)


@pytest.mark.parametrize(
    ("depth", "most"),
    [
        (np.ones_like(X), 0.012),
        (1.0 + 0.4 * Y / 1e-3, 0.012),
        (1.0 + 0.5 * np.exp(-(X**2 + (Y - 4e-4) ** 2) / (2.0 * 3e-4**2)), 0.02),
    ],
    ids=["even", "slope", "hollow"],
)
def test_the_depth_is_that_of_the_map(path: tuple[Array, Array], depth: Array, most: float) -> None:
    wanted = DepthMap(AXIS, AXIS, depth)
    even = dwell.even(*path, TOOL, FEED, SWEEP)
    planned = dwell.planned(*path, TOOL, FEED, SWEEP, wanted, FOOTPRINT)
    assert worn(path, planned, wanted) <= most
    if depth.std() > 0.0:
        assert worn(path, even, wanted) >= 0.1
    # it takes as long as the feed that was asked for
    assert np.mean(1.0 / planned) == pytest.approx(1.0 / FEED, rel=0.02)


def test_no_feed_leaves_its_bounds(path: tuple[Array, Array]) -> None:
    # nothing at all on one side
    wanted = DepthMap(AXIS, AXIS, np.where(X > 0.0, 1.0, 0.0))
    planned = dwell.planned(*path, TOOL, FEED, SWEEP, wanted, FOOTPRINT)
    assert planned.min() >= 0.99 * dwell.SLOWEST * FEED
    assert planned.max() <= 1.01 * dwell.FASTEST * FEED
    assert planned.max() >= 1.9 * FEED


def test_a_map_is_linear_between_its_points_and_its_edge_continues(tmp_path: Path) -> None:
    file = tmp_path / "depth.csv"
    file.write_text("y\\x,-1,0,2\n-1,1,2,4\n1,3,4,6\n", encoding="utf-8")
    points = np.array([[0.5, 0.0], [-0.5, 0.5], [-9.0, -9.0], [9.0, 0.0]]) * 1e-3
    # 1 + (x + 1) + (y + 1), x and y in mm
    np.testing.assert_allclose(DepthMap.read(file).at(points), [3.5, 3.0, 1.0, 5.0])


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("", "not a table"),
        ("y,0,1\n0,1,1\n1,1\n", "not a table"),
        ("y,0,1\n0,1,1\n", "not a table"),
        ("y,0,1\n0,1,deep\n1,1,1\n", "deep"),
        ("y,1,0\n0,1,1\n1,1,1\n", "along x"),
        ("y,0,1\n0,1,1\n0,1,1\n", "along y"),
        ("y,0,1\n0,1,-1\n1,1,1\n", "negative"),
        ("y,0,1\n0,1,nan\n1,1,1\n", "not a number"),
        ("y,0,1\n0,0,0\n1,0,0\n", "all are 0"),
    ],
)
def test_a_map_that_is_none_is_rejected(tmp_path: Path, text: str, reported: str) -> None:
    file = tmp_path / "depth.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=reported):
        DepthMap.read(file)


def test_a_planned_path_changes_nothing_but_feeds() -> None:
    short, wanted = Spiral(outer=0.4e-3), DepthMap(AXIS, AXIS, 1.0 + 0.4 * X / 1e-3)
    plain, planned = (cl_text("led", short, sweep=SWEEP, removal=removal) for removal in (None, wanted))
    points = [
        [line for line in text.splitlines() if not line.startswith("FEDRAT")] for text in (plain, planned)
    ]
    assert points[0] == points[1]
    assert plain != planned
