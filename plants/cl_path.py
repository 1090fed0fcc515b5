"""Cutter location data for a mold: a spiral from its axis outwards, as a CAM's main processor writes it.

    python -m plants.cl_path led led.cls
    python -m plants.cl_path saddle - --outer 0.5e-3

A CAM knows the mold and the tool, not the controller that reads the file, so this lives beside the molds. The
file names contact points with unit normals out of the material (`GOTO/x,y,z,i,j,k`), lengths in mm.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plants.molds import MOLDS, Mold

Array = NDArray[np.float64]

FINE = 10
"""Steps of the spiral in one spacing of its points."""
MM = 1e3


@dataclass(frozen=True)
class Spiral:
    """A spiral over a mold; all lengths in m.

    Parameters
    ----------
    pick_feed : float
        Distance of neighbouring turns along the surface.
    inner, outer : float
        Distance from the axis at the start and at the end.
    spacing : float
        Distance of the points along the path.
    """

    pick_feed: float = 1e-4
    inner: float = 5e-5
    outer: float = 1.8e-3
    spacing: float = 2e-5

    def contact_points(self, mold: Mold) -> Array:
        """Contact points in equal distances, one a row."""
        plan = np.array(list(self._plan(mold)))
        fine = on(mold, plan[:, 0], plan[:, 1])
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))])
        stops = np.linspace(0.0, way[-1], max(math.ceil(way[-1] / self.spacing), 1) + 1)
        return on(mold, np.interp(stops, way, plan[:, 0]), np.interp(stops, way, plan[:, 1]))

    def _plan(self, mold: Mold) -> Iterator[tuple[float, float]]:
        radius, angle = self.inner, 0.0
        while radius < self.outer:
            x, y = radius * math.cos(angle), radius * math.sin(angle)
            yield x, y
            along_x, along_y = mold.gradient(x, y)
            steep = (float(along_x) * x + float(along_y) * y) / radius
            turn = self.spacing / FINE / radius
            # the pick feed counts along the surface
            radius += self.pick_feed / math.tau / math.hypot(1.0, steep) * turn
            angle += turn


def on(mold: Mold, x: Array, y: Array) -> Array:
    """Points of the surface over x and y, one a row."""
    return np.stack([x, y, mold.height(x, y)], axis=-1)


def leant(normals: Array, angle: float) -> Array:
    """Turn normals by an angle about the x-axis, rad: what a mold set up askew, or a wrong CAM, gives."""
    cosine, sine = math.cos(angle), math.sin(angle)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
    turned: Array = normals @ about_x.T
    return turned


def cl_lines(name: str, points: Array, normals: Array, tool_diameter: float, feed: float) -> Iterator[str]:
    """Lines of a CL file.

    Parameters
    ----------
    name : str
        Name of the part.
    points, normals : array
        Contact points, m, and unit normals, one a row.
    tool_diameter : float
        Diameter of the ball, m.
    feed : float
        Feed of the contact point, m/s.
    """
    yield f"PARTNO/{name.upper()}"
    yield "$$ contact points and unit normals out of the material"
    yield "UNITS/MM"
    yield f"CUTTER/{MM * tool_diameter:g}"
    yield f"FEDRAT/{60.0 * MM * feed:g},MMPM"
    for row in np.hstack([MM * points, normals]):
        # no -0.000000
        yield "GOTO/" + ",".join(f"{number:.6f}" for number in np.round(row, 6) + 0.0)
    yield "FINI"


def main() -> None:
    """Write the CL file that the command line asks for."""
    parser = argparse.ArgumentParser("python -m plants.cl_path", description="Write CL data for a mold.")
    parser.add_argument("mold", choices=sorted(MOLDS), help="the mold")
    parser.add_argument("file", help="the file, - for the standard output")
    lengths = {
        "pick-feed": (Spiral.pick_feed, "distance of the turns along the surface, m"),
        "inner": (Spiral.inner, "distance from the axis at the start, m"),
        "outer": (None, "distance from the axis at the end, m (the aperture of the mold)"),
        "spacing": (Spiral.spacing, "distance of the points along the path, m"),
        "tool-diameter": (1e-3, "diameter of the ball, m"),
        "feed": (2e-3, "feed, m/s"),
    }
    for option, (default, text) in lengths.items():
        parser.add_argument(f"--{option}", type=positive, default=default, help=f"{text}; default {default}")
    parser.add_argument("--lean", type=float, default=0.0, help="angle by which the normals are wrong, rad")
    chosen = parser.parse_args()
    mold = MOLDS[chosen.mold]
    outer = min(chosen.outer or mold.aperture, mold.aperture)
    if chosen.inner >= outer:
        parser.error(f"--inner is {chosen.inner:g} m, it must be less than the end of the path, {outer:g} m")
    spiral = Spiral(chosen.pick_feed, chosen.inner, outer, chosen.spacing)
    points = spiral.contact_points(mold)
    normals = leant(mold.normal(points[:, 0], points[:, 1]), chosen.lean)
    text = "\n".join(cl_lines(chosen.mold, points, normals, chosen.tool_diameter, chosen.feed)) + "\n"
    if chosen.file == "-":
        sys.stdout.write(text)
    else:
        Path(chosen.file).write_text(text, encoding="ascii")


def positive(text: str) -> float:
    """Read a positive number."""
    number = float(text)
    if not 0.0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"`{text}` is not a positive number")
    return number


if __name__ == "__main__":
    main()
