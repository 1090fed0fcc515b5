"""Feeds with which a ball that swings across its path takes away a wanted depth: dwell-time planning.

Preston: at constant load the depth is the way that the ball slides on each length of the path. The centre of
the ball goes `ratio` times as far as the contact, and besides swings at `sweep` m/s across the path, so on a
length it slides `sqrt(ratio^2 + (sweep / feed)^2)` times as far: slow is deep.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FASTEST, SLOWEST = 2.0, 0.25
"""No feed is more than doubled, or less than a quarter."""
KNOTS = 0.75
"""Distance of the knots between which a planned way is linear, in radii of the contact."""
MM = 1e3


def even(points: Array, normals: Array, tool_radius: float, feed: float, sweep: float) -> Array:
    """Return feeds of the contact points with which the ball slides equally far on every length, m/s.

    Parameters
    ----------
    points, normals : array, shape (n, 3)
        Contact points, m, and unit normals out of the material.
    tool_radius : float
        Radius of the ball, m.
    feed : float
        Feed in the mean, m/s.
    sweep : float
        Mean speed of the ball across the path, m/s.
    """
    ratio = _ratio(points, normals, tool_radius)
    return _feeds(np.hypot(ratio, sweep / feed).mean(), ratio, feed, sweep)


@dataclass(frozen=True)
class DepthMap:
    """Depths that are wanted over a mold, in the frame of its CL data; only their ratios count.

    Parameters
    ----------
    x, y : array
        Places of the columns and of the rows, rising, m.
    depth : array, shape (y, x)
        At least 0.
    """

    x: Array
    y: Array
    depth: Array

    def __post_init__(self) -> None:
        for name, axis in (("x", self.x), ("y", self.y)):
            if len(axis) < 2 or not (np.diff(axis) > 0.0).all():
                raise ValueError(f"the places along {name} do not rise, or are fewer than two")
        if not np.isfinite(self.depth).all() or (self.depth < 0.0).any() or not (self.depth > 0.0).any():
            raise ValueError("a depth is below 0 or no number, or all are 0")

    @classmethod
    def read(cls, path: Path) -> DepthMap:
        """Read a table with commas: a word and places along x in the first line, then y and depths; mm.

        Raises
        ------
        ValueError
            If it is no such table; the message names what is wrong.
        """
        lines = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
        if len(lines) < 3 or len({len(line) for line in lines}) != 1 or len(lines[0]) < 3:
            raise ValueError("it is no table of two places and more along x and y, all lines equally long")
        lines[0][0] = "0"
        table = np.array([[float(cell) for cell in line] for line in lines])
        return cls(table[0, 1:] / MM, table[1:, 0] / MM, table[1:, 1:])

    def at(self, points: Array) -> Array:
        """Return the depth at points, one a row, m: linear between the places, beyond them as at the edge."""
        along = [_place(axis, points[:, i]) for i, axis in enumerate((self.x, self.y))]
        (column, right), (row, up) = along
        low, high = (
            self.depth[row + step, column] * (1.0 - right) + self.depth[row + step, column + 1] * right
            for step in (0, 1)
        )
        depth: Array = low * (1.0 - up) + high * up
        return depth


def planned(
    points: Array,
    normals: Array,
    tool_radius: float,
    feed: float,
    sweep: float,
    wanted: DepthMap,
    footprint: float,
) -> Array:
    """Return feeds that take away what a map wants, by least squares over the footprint of the ball.

    The contact presses as Hertz's, so at the distance d from its middle it wears by
    `sqrt(1 - (d / footprint)^2)` of what it does there. The depth is in the mean that of the constant `feed`.
    No feed leaves `SLOWEST` to `FASTEST` times that, and the rim gets its part of the footprint alone.

    Parameters
    ----------
    points, normals, tool_radius, feed, sweep
        As in `even`.
    wanted : DepthMap
        Depth over the mold.
    footprint : float
        Radius of the contact, m.
    """
    from scipy.optimize import lsq_linear
    from scipy.sparse import csr_array
    from scipy.spatial import KDTree

    ratio = _ratio(points, normals, tool_radius)
    length = np.linalg.norm(np.diff(points, axis=0, append=points[-1:]), axis=1)
    tree = KDTree(points)
    near = tree.sparse_distance_matrix(tree, footprint, output_type="coo_matrix")
    pressed = np.sqrt(np.maximum(1.0 - (near.data / footprint) ** 2, 0.0)) * length[near.col]
    wear = csr_array((pressed, (near.row, near.col)), shape=near.shape)

    constant = np.hypot(ratio, sweep / feed)
    flat = wear @ constant
    rim = np.minimum(flat / np.median(flat), 1.0)
    target = wanted.at(points) * rim
    target *= flat.sum() / target.sum()

    along = np.cumsum(length) - length
    knots = np.linspace(0.0, along[-1], max(math.ceil(along[-1] / (KNOTS * footprint)), 1) + 1)
    linear = _linear(knots, along)
    bounds = [
        np.interp(knots, along, np.hypot(ratio, sweep / (feed * share))) for share in (FASTEST, SLOWEST)
    ]
    found = lsq_linear(csr_array(wear @ linear), target, bounds, tol=1e-6)
    return _feeds(linear @ found.x, ratio, feed, sweep)


def _ratio(points: Array, normals: Array, tool_radius: float) -> Array:
    """Return how far the centre of the ball goes for each length of its contact, at every point."""
    centres = points + tool_radius * normals
    steps = [np.linalg.norm(np.diff(places, axis=0), axis=1) for places in (centres, points)]
    ratio = steps[0] / steps[1]
    return np.append(ratio, ratio[-1])


def _feeds(way: Array | float, ratio: Array, feed: float, sweep: float) -> Array:
    """Return the feeds with which the ball slides `way` times as far as its contact goes."""
    across = np.sqrt(np.maximum(np.square(way) - ratio**2, (sweep / (FASTEST * feed)) ** 2))
    feeds: Array = sweep / across
    return feeds


def _linear(knots: Array, along: Array) -> Any:
    """Return the matrix that gives values at places from those at knots, linear in between; sparse."""
    from scipy.sparse import csr_array

    before, share = _place(knots, along)
    rows = np.arange(len(along))
    parts = [(1.0 - share, (rows, before)), (share, (rows, before + 1))]
    return sum(csr_array(part, shape=(len(along), len(knots))) for part in parts)


def _place(axis: Array, values: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the places before values on an axis, and the shares of the way to the next one."""
    before = np.clip(np.searchsorted(axis, values, side="right") - 1, 0, len(axis) - 2)
    share = (values - axis[before]) / (axis[before + 1] - axis[before])
    return before, np.clip(share, 0.0, 1.0)
