"""Dwell-time planning: feeds for a desired removal depth of a ball that oscillates across its path.

Preston: at constant load the depth is proportional to the sliding distance per path length. The center of
the ball moves `ratio` times as far as the contact and oscillates at `sweep` m/s across the path. So the ball
slides `sqrt(ratio^2 + (sweep / feed)^2)` times the path length: a slow feed removes more.
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
"""Maximum and minimum feed relative to the mean."""
KNOTS = 0.75
"""Distance of the knots of a planned sliding distance, in radii of the contact."""
MM = 1e3


def even(points: Array, normals: Array, tool_radius: float, feed: float, sweep: float) -> Array:
    """Return feeds of the contact points for a constant sliding distance per path length, m/s.

    Parameters
    ----------
    points, normals : array, shape (n, 3)
        Contact points, m, and unit normals out of the material.
    tool_radius : float
        Radius of the ball, m.
    feed : float
        Mean feed, m/s.
    sweep : float
        Mean speed of the ball across the path, m/s.
    """
    ratio = _ratio(points, normals, tool_radius)
    return _feeds(np.hypot(ratio, sweep / feed).mean(), ratio, feed, sweep)


@dataclass(frozen=True)
class DepthMap:
    """Desired depths over a mold, in the frame of its CL data; only their ratios are used.

    Parameters
    ----------
    x, y : array
        Increasing positions of the columns and of the rows, m.
    depth : array, shape (y, x)
        At least 0.
    """

    x: Array
    y: Array
    depth: Array

    def __post_init__(self) -> None:
        for name, axis in (("x", self.x), ("y", self.y)):
            if len(axis) < 2 or not (np.diff(axis) > 0.0).all():
                raise ValueError(f"the positions along {name} do not increase, or are fewer than two")
        if not np.isfinite(self.depth).all() or (self.depth < 0.0).any() or not (self.depth > 0.0).any():
            raise ValueError("a depth is negative or not a number, or all are 0")

    @classmethod
    def read(cls, path: Path) -> DepthMap:
        """Read a CSV table: a word and positions along x in the first line, then y and depths; mm.

        Raises
        ------
        ValueError
            The table is invalid; the message names the problem.
        """
        lines = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
        if len(lines) < 3 or len({len(line) for line in lines}) != 1 or len(lines[0]) < 3:
            raise ValueError("it is not a table of two or more positions along x and y")
        lines[0][0] = "0"
        table = np.array([[float(cell) for cell in line] for line in lines])
        return cls(table[0, 1:] / MM, table[1:, 0] / MM, table[1:, 1:])

    def at(self, points: Array) -> Array:
        """Return the depth at points, one per row, m: linear interpolation, constant beyond the edge."""
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
    desired: DepthMap,
    footprint: float,
) -> Array:
    """Return feeds for the removal of a depth map, by least squares over the footprint of the ball.

    The contact pressure is that of Hertz, so at the distance d from its center it wears by
    `sqrt(1 - (d / footprint)^2)` of the central depth. The mean depth is that of the constant `feed`. The
    feeds are `SLOWEST` to `FASTEST` times `feed`. The rim is reached only by a part of the footprint.

    Parameters
    ----------
    points, normals, tool_radius, feed, sweep
        As in `even`.
    desired : DepthMap
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
    target = desired.at(points) * rim
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
    """Return the path length of the ball center per path length of its contact, at every point."""
    centres = points + tool_radius * normals
    steps = [np.linalg.norm(np.diff(places, axis=0), axis=1) for places in (centres, points)]
    ratio = steps[0] / steps[1]
    return np.append(ratio, ratio[-1])


def _feeds(way: Array | float, ratio: Array, feed: float, sweep: float) -> Array:
    """Return the feeds with a sliding distance of `way` times the contact path."""
    across = np.sqrt(np.maximum(np.square(way) - ratio**2, (sweep / (FASTEST * feed)) ** 2))
    feeds: Array = sweep / across
    return feeds


def _linear(knots: Array, along: Array) -> Any:
    """Return the sparse matrix of linear interpolation from knots to positions."""
    from scipy.sparse import csr_array

    before, share = _place(knots, along)
    rows = np.arange(len(along))
    parts = [(1.0 - share, (rows, before)), (share, (rows, before + 1))]
    return sum(csr_array(part, shape=(len(along), len(knots))) for part in parts)


def _place(axis: Array, values: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the indices before values on an axis, and the fractions of the distance to the next one."""
    before = np.clip(np.searchsorted(axis, values, side="right") - 1, 0, len(axis) - 2)
    share = (values - axis[before]) / (axis[before + 1] - axis[before])
    return before, np.clip(share, 0.0, 1.0)
