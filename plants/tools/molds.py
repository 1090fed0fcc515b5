"""Molds as analytic surfaces: a spherical cap or a saddle, with Gaussian dimples.

The frame of a mold is that of its CL data: z points out of the cavity along its axis from the surface.
The paper gives an LED lens mold of 4 mm diameter with several concave areas. Radii, depths and positions
below are defaults of this project.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Dimple:
    """A Gaussian hollow.

    Parameters
    ----------
    x, y : float
        Its center, m.
    depth : float
        Depth in its center, m.
    sigma : float
        Distance from the center at which 61 % of the depth are left, m.
    """

    x: float
    y: float
    depth: float
    sigma: float


@dataclass(frozen=True)
class Mold:
    """A surface `z(x, y)`.

    Parameters
    ----------
    cap_radius : float
        Radius of a concave spherical cap, m; infinite for none.
    saddle_radius : float
        Radius of curvature of a saddle, concave along x and convex along y, m; infinite for none.
    dimples : tuple of Dimple
        Additional hollows.
    aperture : float
        Distance from the axis up to which the mold is polished, m.
    """

    cap_radius: float = math.inf
    saddle_radius: float = math.inf
    dimples: tuple[Dimple, ...] = ()
    aperture: float = 1.8e-3

    def height(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Height of the surface, m."""
        return self._height(x, y) - self._height(0.0, 0.0)

    def gradient(self, x: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """Slope of the surface along x and along y."""
        x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        # z of the centre of the cap over the point, and 1 / radius is 0 for a plane
        rise = np.sqrt(1.0 - (x * x + y * y) / self.cap_radius**2)
        along_x = x / self.cap_radius / rise + x / self.saddle_radius
        along_y = y / self.cap_radius / rise - y / self.saddle_radius
        for dimple in self.dimples:
            steep = self._hollow(dimple, x, y) / dimple.sigma**2
            along_x, along_y = along_x + (x - dimple.x) * steep, along_y + (y - dimple.y) * steep
        return along_x, along_y

    def normal(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Return the unit normal out of the material, last axis x, y, z."""
        along_x, along_y = self.gradient(x, y)
        normal: Array = np.stack([-along_x, -along_y, np.ones_like(along_x)], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        return normal

    def _height(self, x: ArrayLike, y: ArrayLike) -> Array:
        x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        square = x * x + y * y
        # the cap without the difference of two large numbers
        cap = square / self.cap_radius / (1.0 + np.sqrt(1.0 - square / self.cap_radius**2))
        height: Array = cap + (x * x - y * y) / (2.0 * self.saddle_radius)
        for dimple in self.dimples:
            height = height - self._hollow(dimple, x, y)
        return height

    @staticmethod
    def _hollow(dimple: Dimple, x: Array, y: Array) -> Array:
        square = (x - dimple.x) ** 2 + (y - dimple.y) ** 2
        hollow: Array = dimple.depth * np.exp(-square / (2.0 * dimple.sigma**2))
        return hollow


MOLDS = {
    "sphere": Mold(cap_radius=3e-3),
    "led": Mold(
        cap_radius=3e-3,
        dimples=(
            Dimple(0.9e-3, 0.1e-3, 40e-6, 0.45e-3),
            Dimple(-0.5e-3, 0.8e-3, 30e-6, 0.40e-3),
            Dimple(-0.3e-3, -0.9e-3, 35e-6, 0.42e-3),
        ),
    ),
    "saddle": Mold(saddle_radius=6e-3),
    "freeform": Mold(
        cap_radius=4e-3,
        saddle_radius=20e-3,
        dimples=(
            Dimple(0.8e-3, 0.5e-3, 30e-6, 0.45e-3),
            Dimple(-0.7e-3, 0.7e-3, 25e-6, 0.40e-3),
            Dimple(-0.9e-3, -0.5e-3, 35e-6, 0.50e-3),
            Dimple(0.3e-3, -1.0e-3, 20e-6, 0.40e-3),
            Dimple(1.2e-3, -0.4e-3, 25e-6, 0.45e-3),
        ),
    ),
    "steep": Mold(cap_radius=2.3e-3),
}
"""Molds by name; `led` is that of the paper, with three concave areas, not symmetric about its axis."""
