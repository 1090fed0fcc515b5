"""Removal by polishing: Preston's law on a height map of a mold with milling cusps.

The contact is that of Hertz: ball in a hollow, wood on steel with paste. Higher points have more pressure:
`p = hertz + selectivity (h - mean)`, scaled to the load. Without that term Preston's law removes everywhere
equally and no cusp is removed. All results depend on it: compare cases, and do not rely on the scale.
Heights are along the normal of the surface, and areas are true ones, not their projections.

>>> surface = Surface(MOLDS["led"])
>>> surface.polish(*(trace[f"plant.{name}"] for name in ("contact_x", "contact_y", "slid", "rubbed")))
>>> roughness(surface, 0.2e-3, 1.6e-3).mean, evenness(surface, 0.2e-3, 1.6e-3)
"""

import math
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

import machining_native as _native
from plants.tools.dwell import DepthMap
from plants.tools.molds import MOLDS, Mold

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Process:
    """Tool, paste and milled surface.

    Parameters
    ----------
    preston : float
        Removed depth per pressure and distance in all passes together, m2/N. Default: without stick-slip
        motion two thirds of the cusps remain.
    passes : int
        Passes over the same path, which divide `preston` equally. Default: in a single pass the step of some
        micrometers between polished and unpolished surface would shift the pressure.
    modulus : float
        Contact modulus of wood and paste on steel, Pa. Assumed.
    radius : float
        Of the equivalent ball on a plane for the ball in its hollow, m. Derived: 1 / (1 / 0.5 mm - 1 / 3 mm).
    pick : float
        Distance of the milling grooves, m. Assumed.
    selective : bool
        Whether higher points carry more pressure.
    """

    preston: float = 4e-11
    passes: int = 5
    modulus: float = 1e9
    radius: float = 0.6e-3
    pick: float = 0.1e-3
    selective: bool = True

    @classmethod
    def of_contact(cls, stiffness: float, load: float, radius: float = 0.6e-3) -> Self:
        """Process with the contact of the plant: the Hertz contact with its stiffness at a load.

        Parameters
        ----------
        stiffness : float
            Parameter `contact_stiffness` of the plant, N/m.
        load : float
            N.
        radius : float
            Of ball and hollow, m.
        """
        # stiffness = 2 modulus a with a^3 = 3/4 load radius / modulus
        modulus = (0.5 * stiffness) ** 1.5 / math.sqrt(0.75 * load * radius)
        return cls(modulus=modulus, radius=radius)

    def footprint(self, load: float) -> float:
        """Radius of the contact under a load (N), m: Hertz."""
        return math.cbrt(0.75 * load * self.radius / self.modulus)

    @property
    def selectivity(self) -> float:
        """Pressure per height of a cusp, Pa/m: response of the half-space to a wave of the length `pick`."""
        return math.pi * self.modulus / self.pick if self.selective else 0.0

    @property
    def abrasion(self) -> tuple[float, float, float, float]:
        """Arguments of the native function."""
        return self.preston, self.modulus, self.radius, self.selectivity

    @property
    def cusp(self) -> float:
        """Height of the cusps, m."""
        return self.pick**2 / (8.0 * self.radius)


class Surface:
    """Height map of a mold, from the nominal surface along its normal.

    Parameters
    ----------
    mold : Mold
        The nominal surface.
    process : Process
        Tool, paste and cusps.
    cusps : {"raster", "concentric"}
        Grooves of the ball-end mill along x, or around the axis.
    radius : float
        Distance from the axis to the edge of the map, m.
    pitch : float
        Distance of its points, m.

    Attributes
    ----------
    x, y : Array
        Positions of rows and columns, m.
    height : Array
        Present height, row by x and column by y, m.
    before : Array
        Height before polishing, m.
    area : Array
        True area of each point, 0 outside of the mold, m2.
    """

    def __init__(
        self,
        mold: Mold,
        process: Process | None = None,
        cusps: Literal["raster", "concentric"] = "raster",
        radius: float = 2e-3,
        pitch: float = 10e-6,
    ) -> None:
        self.process = Process() if process is None else process
        self.pitch = pitch
        count = round(radius / pitch)
        self.x: Array = pitch * np.arange(-count, count + 1, dtype=np.float64)
        self.y = self.x
        place = np.meshgrid(self.x, self.y, indexing="ij")
        across = place[1] if cusps == "raster" else np.hypot(*place)
        groove = across - self.process.pick * np.round(across / self.process.pick)
        self.before: Array = np.square(groove, dtype=np.float64) / (2.0 * self.process.radius)
        self.height = self.before.copy()
        inside = np.hypot(*place) <= radius
        x, y = (np.where(inside, axis, 0.0) for axis in place)
        self._nominal: list[float] = np.where(inside, mold.height(x, y), np.inf).ravel().tolist()
        slope = np.hypot(*mold.gradient(x, y))
        self.area: Array = np.where(inside, pitch**2 * np.hypot(1.0, slope), 0.0)
        self._area: list[float] = self.area.ravel().tolist()
        self._mold = mold

    @property
    def removed(self) -> Array:
        """Depth removed by polishing, m."""
        return self.before - self.height

    @property
    def volume(self) -> float:
        """Volume removed by polishing, m3."""
        return float((self.removed * self.area).sum())

    def polish(
        self, x: ArrayLike, y: ArrayLike, slid: ArrayLike, rubbed: ArrayLike, share: float = 1.0
    ) -> None:
        """Polish along a logged path.

        Parameters
        ----------
        x, y : array
            Contact points in the frame of the mold, m.
        slid : array
            Slip distance so far, m.
        rubbed : array
            Integral of load times slip speed so far, N.m.
        share : float
            Factor of the removal.
        """
        x, y, slid, rubbed = (np.asarray(column, dtype=np.float64) for column in (x, y, slid, rubbed))
        way, work = np.diff(slid), np.diff(rubbed)
        z = self._mold.height(x, y)
        rubs = work > 0.0
        columns = [(0.5 * (place[1:] + place[:-1]))[rubs] for place in (x, y, z)]
        columns += [work[rubs] / way[rubs], share / self.process.passes * way[rubs]]
        strokes = list(zip(*(column.tolist() for column in columns), strict=True))
        grid, height = (float(self.x[0]), self.pitch), self.height.ravel().tolist()
        for _ in range(self.process.passes):
            points = self._nominal, self._area, height
            height = _native.wear(grid, points, strokes, self.process.abrasion)
        self.height = np.reshape(height, self.before.shape)


def heights(
    x: ArrayLike, y: ArrayLike, slid: ArrayLike, rubbed: ArrayLike
) -> dict[str, tuple[Array, Array, Array]]:
    """Heights of the center of the LED mold before and after a logged path, as maps of 20 um.

    Parameters are those of `Surface.polish`.

    Returns
    -------
    dict
        For `before` and `after` the edges of the cells along x and y, m, and the heights above the deepest
        remaining point, m, shape (y, x).
    """
    surface = Surface(MOLDS["led"], radius=1e-3)
    surface.polish(x, y, slid, rubbed)
    # without the rim, where half of a contact has nothing below it; cells of two points each way
    shown = slice(30, -31)
    edges = np.append(surface.x[shown][::2], surface.x[-31]) - 0.5 * surface.pitch
    count = len(edges) - 1
    cells = (count, 2, count, 2)
    maps = {
        name: height[shown, shown].reshape(cells).mean(axis=(1, 3)).T
        for name, height in (("before", surface.before), ("after", surface.height))
    }
    deepest = min(height.min() for height in maps.values())
    return {name: (edges, edges, height - deepest) for name, height in maps.items()}


@dataclass(frozen=True)
class Roughness:
    """Heights without waviness.

    Parameters
    ----------
    mean, worst : float
        Range from 1 to 99 % of the heights in a tile: mean and 95 % of the tiles, m.
    rms : float
        Standard deviation, m.
    """

    mean: float
    worst: float
    rms: float


def roughness(surface: Surface, inner: float, outer: float, before: bool = False) -> Roughness:
    """Roughness of the tiles between two distances from the axis, m; optionally `before` polishing."""
    height = surface.before if before else surface.height
    rough = height - _smooth(height, 0.12e-3 / surface.pitch)
    tiles = _tiles(surface, rough, inner, outer)
    low, high = np.percentile(tiles, (1.0, 99.0), axis=1)
    worst = float(np.percentile(high - low, 95.0))
    return Roughness(float(np.mean(high - low)), worst, float(np.std(tiles)))


def evenness(surface: Surface, inner: float, outer: float) -> tuple[float, float]:
    """Mean removed depth in m and its variation from tile to tile over the mean."""
    depths = _tiles(surface, surface.removed, inner, outer).mean(axis=1)
    return float(depths.mean()), float(depths.std() / depths.mean())


def mismatch(surface: Surface, wanted: DepthMap, inner: float, outer: float) -> float:
    """Variation of the ratio of removed to desired depth from tile to tile, relative to its mean."""
    place = np.meshgrid(surface.x, surface.y, indexing="ij")
    depth = wanted.at(np.stack(place, axis=-1).reshape(-1, 2)).reshape(surface.removed.shape)
    ratios = np.divide(
        *(_tiles(surface, values, inner, outer).mean(axis=1) for values in (surface.removed, depth))
    )
    return float(ratios.std() / ratios.mean())


def _tiles(surface: Surface, values: Array, inner: float, outer: float, width: float = 0.2e-3) -> Array:
    """Values of all square tiles between two distances from the axis, one tile per row."""
    size = round(width / surface.pitch)
    middle = (len(surface.x) - 1) // 2
    reach = int(outer / width)
    found = []
    for i in range(-reach, reach):
        for j in range(-reach, reach):
            near = math.hypot(min(abs(i), abs(i + 1)), min(abs(j), abs(j + 1))) * width
            far = math.hypot(max(abs(i), abs(i + 1)), max(abs(j), abs(j + 1))) * width
            if near >= inner and far <= outer:
                row, column = middle + i * size, middle + j * size
                found.append(values[row : row + size, column : column + size].ravel())
    if not found:
        raise ValueError(f"no tile of `{width:g}` m between `{inner:g}` m and `{outer:g}` m from the axis")
    return np.array(found)


def _smooth(values: Array, sigma: float) -> Array:
    """Gaussian mean of `sigma` points; the edges use the existing points."""
    reach = math.ceil(4.0 * sigma)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)

    def along(rows: Array) -> Array:
        return np.array([np.convolve(row, weights, "same") for row in rows])

    ones = np.convolve(np.ones(values.shape[0]), weights, "same")
    smooth: Array = along(along(values).T).T
    return smooth / np.outer(ones, ones)
