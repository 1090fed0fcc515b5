"""Solids for drawing: meshes of revolution, of a surface and of an outline."""

import math
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BOX, CYLINDER = (getattr(mujoco.mjtGeom, f"mjGEOM_{kind}") for kind in ("BOX", "CYLINDER"))
AROUND = 96
"""Segments per revolution."""


def add(
    body: Any, spec: Any, name: str, vertices: Array, faces: Any, material: str, at: Any = (0, 0, 0)
) -> Any:
    """Add a mesh to a body; return its geom.

    Parameters
    ----------
    vertices : numpy.ndarray
        Points in m, one per row.
    faces : array of int
        Three points each, counterclockwise seen from outside.
    at : sequence of float
        Position in the frame of the body, m.
    """
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    mesh.uservert, mesh.userface = np.ravel(vertices).tolist(), np.ravel(faces).astype(int).tolist()
    mesh_geom = mujoco.mjtGeom.mjGEOM_MESH
    looks = spec.find_default("looks")
    return body.add_geom(looks, name=name, type=mesh_geom, meshname=name, material=material, pos=list(at))


def lathe(profile: Array, around: int = AROUND) -> tuple[Array, Array]:
    """Turn a closed profile of (radius, height), counterclockwise, about z."""
    angle = 2.0 * math.pi * np.arange(around) / around
    radius, height = np.asarray(profile, dtype=float).T
    points = np.stack(
        [np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius), np.tile(height, (around, 1))], -1
    )
    return points.reshape(-1, 3), grid(around, len(radius), True)


def disc(
    height: Callable[[Array, Array], Array],
    radius: float,
    below: float,
    rings: int = 40,
    around: int = AROUND,
) -> tuple[Array, Array]:
    """Solid under a surface `height(x, y)` within a radius, down to `below`."""
    angle = 2.0 * math.pi * np.arange(around) / around
    # the axis, the surface, the rim below and the axis again
    reach = np.concatenate([np.linspace(0.0, radius, rings), [radius, 0.0]])
    x, y = np.outer(np.cos(angle), reach), np.outer(np.sin(angle), reach)
    z = height(x, y)
    z[:, -2:] = below
    return np.stack([x, y, z], -1).reshape(-1, 3), grid(around, len(reach), False)[:, ::-1]


def prism(outline: Array, below: float, above: float) -> tuple[Array, Array]:
    """Solid from `below` to `above` an outline of points (x, y, z).

    The outline is counterclockwise and star-shaped about its mean.
    """
    count = len(outline)
    hub = np.mean(outline, axis=0)
    corners = [(x, y, z + rise) for rise in (below, above) for x, y, z in (*outline, hub)]
    i = np.arange(count)
    j = (i + 1) % count
    top = count + 1
    bottom, lid = np.stack([j, i, i * 0 + count], 1), np.stack([i + top, j + top, i * 0 + count + top], 1)
    sides = [np.stack([i, j, j + top], 1), np.stack([i, j + top, i + top], 1)]
    return np.array(corners), np.concatenate([bottom, lid, *sides])


def grid(around: int, count: int, closed: bool) -> Array:
    """Faces of a grid with closed columns, and optionally closed rows."""
    faces = []
    for i in range(around):
        here, there = i * count, (i + 1) % around * count
        for j in range(count if closed else count - 1):
            k = (j + 1) % count
            faces += [(here + j, there + j, there + k), (here + j, there + k, here + k)]
    return np.array(faces)
