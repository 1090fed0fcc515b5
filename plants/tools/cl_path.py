"""Cutter location data for a mold: an outward spiral from its axis, in the format of a CAM main processor.

    python -m plants.tools.cl_path led led.cls
    python -m plants.tools.cl_path saddle - --outer 0.5e-3
    python -m plants.tools.cl_path saddle dwelling.cls --sweep 6.6e-3
    python -m plants.tools.cl_path led planned.cls --sweep 6.6e-3 --removal depth.csv

A CAM knows the mold and the tool, not the controller, so this module belongs to the molds. The
file has contact points with unit normals out of the material (`GOTO/x,y,z,i,j,k`), lengths in mm.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plants.tools import dwell
from plants.tools.molds import MOLDS, Mold
from plants.tools.removal import Process

Array = NDArray[np.float64]

FINE = 2
"""Steps of the spiral in one spacing of its points."""
MM = 1e3
FOOTPRINT = Process().footprint(5.0)
"""Radius of the contact at the default force of `fmu-polish`, m."""


@dataclass(frozen=True)
class Spiral:
    """A spiral over a mold; all lengths in m.

    Parameters
    ----------
    pick_feed : float
        Distance of neighboring turns along the surface.
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
        """Contact points in equal distances, one per row."""
        radius, angle = np.array(list(self._polar(mold))).T
        fine = on(mold, radius, angle)
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))])
        stops = np.linspace(0.0, way[-1], max(math.ceil(way[-1] / self.spacing), 1) + 1)
        return on(mold, np.interp(stops, way, radius), np.interp(stops, way, angle))

    def _polar(self, mold: Mold) -> Iterator[tuple[float, float]]:
        radius, angle = self.inner, 0.0
        while radius < self.outer:
            yield radius, angle
            x, y = radius * math.cos(angle), radius * math.sin(angle)
            along_x, along_y = mold.gradient(x, y)
            steep = (float(along_x) * x + float(along_y) * y) / radius
            turn = self.spacing / FINE / radius
            # the pick feed counts along the surface
            radius += self.pick_feed / math.tau / math.hypot(1.0, steep) * turn
            angle += turn


def on(mold: Mold, radius: Array, angle: Array) -> Array:
    """Return the points of the surface at a distance and an angle from the axis, one per row."""
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    return np.stack([x, y, mold.height(x, y)], axis=-1)


def leant(normals: Array, angle: float) -> Array:
    """Rotate normals by an angle about the x-axis, rad, as for a tilted mold or an error of the CAM."""
    cosine, sine = math.cos(angle), math.sin(angle)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
    turned: Array = normals @ about_x.T
    return turned


def cl_text(
    name: str,
    spiral: Spiral,
    tool_diameter: float = 1e-3,
    feed: float = 2e-3,
    lean: float = 0.0,
    sweep: float = 0.0,
    removal: dwell.DepthMap | None = None,
    footprint: float = FOOTPRINT,
) -> str:
    """Return the CL file of a spiral over a mold.

    Parameters
    ----------
    name : str
        Name of the mold in `MOLDS`.
    spiral : Spiral
        The path.
    tool_diameter : float
        Diameter of the ball, m.
    feed : float
        Feed of the contact point, m/s.
    lean : float
        Angle error of the normals, rad.
    sweep : float
        Mean speed of the stick-slip motion of the ball across the path, m/s: above 0 the feed varies along
        the path such that the sliding distance per path length is constant.
    removal : DepthMap, optional
        Desired depths; the default is even. `sweep` must be above 0.
    footprint : float
        Radius of the contact of ball and mold, m.
    """
    mold = MOLDS[name]
    points = spiral.contact_points(mold)
    upright = mold.normal(points[:, 0], points[:, 1])
    normals = leant(upright, lean)
    # adding zero makes -0 a 0
    rows = np.round(np.hstack([MM * points, normals]), 6) + 0.0
    lines = [
        f"PARTNO/{name.upper()}",
        "$$ contact points and unit normals out of the material",
        "UNITS/MM",
        f"CUTTER/{MM * tool_diameter:g}",
        f"FEDRAT/{60.0 * MM * feed:g},MMPM",
    ]
    goto = ["GOTO/" + ",".join(f"{number:.6f}" for number in row) for row in rows]
    if sweep > 0.0:
        path = points, upright, 0.5 * tool_diameter, feed, sweep
        feeds = dwell.even(*path) if removal is None else dwell.planned(*path, removal, footprint)
        fedrat = [f"FEDRAT/{60.0 * MM * value:.3f},MMPM" for value in feeds]
        goto = [line for pair in zip(fedrat, goto, strict=True) for line in pair]
    lines += [*goto, "FINI"]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the CL file of the command line."""
    parser = argparse.ArgumentParser(
        "python -m plants.tools.cl_path", description="Write CL data for a mold."
    )
    parser.add_argument("mold", choices=sorted(MOLDS), help="the mold")
    parser.add_argument("file", help="the file, - for the standard output")
    lengths = {
        "pick-feed": (Spiral.pick_feed, "distance of the turns along the surface, m"),
        "inner": (Spiral.inner, "distance from the axis at the start, m"),
        "outer": (None, "distance from the axis at the end, m (the aperture of the mold)"),
        "spacing": (Spiral.spacing, "distance of the points along the path, m"),
        "tool-diameter": (1e-3, "diameter of the ball, m"),
        "feed": (2e-3, "feed, m/s"),
        "footprint": (FOOTPRINT, "radius of the contact, m"),
    }
    for option, (default, text) in lengths.items():
        shown = text if default is None else f"{text}; default {default:.3g}"
        parser.add_argument(f"--{option}", type=positive, default=default, help=shown)
    parser.add_argument("--lean", type=float, default=0.0, help="angle error of the normals, rad")
    parser.add_argument(
        "--sweep",
        type=positive,
        default=0.0,
        help="speed of the ball across the path, m/s; the feed varies with it",
    )
    parser.add_argument(
        "--removal",
        type=depth_map,
        metavar="FILE",
        help="CSV table of desired depths in any unit: x in mm in its first line, "
        "y in mm in its first column; needs --sweep",
    )
    chosen = parser.parse_args()
    outer = chosen.outer or MOLDS[chosen.mold].aperture
    if chosen.inner >= outer:
        parser.error(f"--inner is {chosen.inner:g} m; it must be less than the end of the path, {outer:g} m")
    if outer > MOLDS[chosen.mold].aperture:
        parser.error(f"--outer is {outer:g} m, but the mold ends at {MOLDS[chosen.mold].aperture:g} m")
    if chosen.removal is not None and chosen.sweep == 0.0:
        parser.error("--removal needs --sweep, the speed of the ball across the path")
    if chosen.removal is not None and find_spec("scipy") is None:
        parser.error("--removal needs scipy, which is not installed")
    spiral = Spiral(chosen.pick_feed, chosen.inner, outer, chosen.spacing)
    text = cl_text(
        chosen.mold,
        spiral,
        chosen.tool_diameter,
        chosen.feed,
        chosen.lean,
        chosen.sweep,
        chosen.removal,
        chosen.footprint,
    )
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


def depth_map(text: str) -> dwell.DepthMap:
    """Read a file of desired depths."""
    try:
        return dwell.DepthMap.read(Path(text))
    except (OSError, ValueError) as error:
        raise argparse.ArgumentTypeError(f"cannot read `{text}`: {error}") from None


if __name__ == "__main__":
    main()
