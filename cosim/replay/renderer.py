"""Pictures of a model without a screen."""

from __future__ import annotations

import importlib
import math
import os
import sys
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cosim import extras
from cosim.closing import Closing
from cosim.errors import CosimError, closest
from cosim.physics import CHOICE
from cosim.trace.columns import Array

Picture = NDArray[np.uint8]
"""Red, green and blue, shape (height, width, 3)."""

BACKENDS = {"linux": "egl", "darwin": "cgl", "win32": "glfw"}
HINT = (
    "Install a rendering library: on Debian or Ubuntu `apt-get install libegl1 libgl1-mesa-dri`; "
    f"`{CHOICE}` selects `egl` or, with a screen, `glfw`"
)
DEFAULT_COLOR = (0.5, 0.5, 0.5, 1.0)
"""MuJoCo's default color of a geom."""
COLORS = ((0.36, 0.51, 0.68), (0.79, 0.60, 0.33), (0.47, 0.62, 0.48), (0.67, 0.45, 0.48), (0.55, 0.52, 0.66))
"""Colors of the bodies of a machine without colors in the MJCF."""
ABOVE, BELOW = np.array([226.0, 232.0, 238.0]), np.array([158.0, 170.0, 182.0])
"""Background from top to bottom."""
AZIMUTH, ELEVATION = 125.0, -22.0
"""Direction of the free camera, degrees."""
OVERVIEW, CLOSEUP = "overview", "closeup"
"""Default cameras of an MJCF: the second with the first in a corner."""
INSET = 0.36
"""Size of the overview relative to the close-up."""
SELDOM = 5
"""Pictures of the close-up per picture of the overview."""
FRAME = 2
"""Pixels around it."""


class Renderer(Closing):
    """Renderer of a model in a size in pixels; a context manager, because it holds graphics resources.

    Missing light and colors are added to the model. An empty `camera` is its `closeup` with its `overview` in
    a corner, one of them if it has only one, otherwise a view of everything in all `poses`, shape (poses,
    coordinates).
    """

    def __init__(self, model: Any, data: Any, size: tuple[int, int], camera: str, poses: Array) -> None:
        self.model, self.data = model, data
        add_light_and_colors(model)
        model.vis.global_.offwidth, model.vis.global_.offheight = size
        first, self.inset = cameras(model, camera)
        self.camera = first or free_camera(model, data, size, poses)
        self.rectangle = mujoco.MjrRect(0, 0, *size)
        self.scene = mujoco.MjvScene(model, maxgeom=10000)
        self.background = background(size[1], size[0])
        self.drawn, self.overview = 0, self.background
        self.options = mujoco.MjvOption()
        # sites are positions in the machine, not parts of it
        self.options.sitegroup[:] = 0
        self.context = graphics(size)
        try:
            self.drawer: Any = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        except Exception as error:
            self.context.free()
            raise CosimError(f"no picture can be drawn here: {error}", HINT) from error
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self.drawer)
        self.drawer.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR.value

    def close(self) -> None:
        """Release the graphics resources."""
        self.drawer.free()
        self.context.free()

    def picture(self, qpos: Array, draw: Callable[[], None] = lambda: None) -> Picture:
        """Draw the model with these coordinates, after `draw` moved the parts that are only drawn."""
        set_pose(self.model, self.data, qpos, draw)
        picture = self._render(self.camera, self.rectangle, self.background)
        if self.inset is not None:
            width, height = (round(INSET * side) for side in (self.rectangle.width, self.rectangle.height))
            if self.drawn % SELDOM == 0:
                rectangle = mujoco.MjrRect(0, 0, width, height)
                self.overview = self._render(self.inset, rectangle, background(height, width))
            picture[: height + FRAME, -width - FRAME :] = 255
            picture[:height, -width:] = self.overview
        self.drawn += 1
        return picture

    def _render(self, camera: Any, rectangle: Any, behind: Picture) -> Picture:
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(self.model, self.data, self.options, None, camera, everything, self.scene)
        mujoco.mjr_render(rectangle, self.scene, self.drawer)
        shape = (rectangle.height, rectangle.width)
        colors, depth = np.empty((*shape, 3), np.uint8), np.empty(shape, np.float32)
        mujoco.mjr_readPixels(colors, depth, rectangle, self.drawer)
        # graphics count lines from below, and nothing is as far as it gets
        colors, nothing = colors[::-1], depth[::-1] == 0.0
        np.copyto(colors, behind, where=nothing[..., None])
        return colors


def set_pose(model: Any, data: Any, qpos: Array, draw: Callable[[], None] = lambda: None) -> None:
    """Set the coordinates of a model for drawing; `draw` moves the parts that are only drawn."""
    data.qpos[:] = qpos
    draw()
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_camlight(model, data)
    mujoco.mj_tendon(model, data)


def graphics(size: tuple[int, int]) -> Any:
    """Context of the graphics of this system, ready to draw; its packages and libraries may be missing."""
    name = os.environ.get(CHOICE, "").strip().lower() or BACKENDS.get(sys.platform, "egl")
    if name not in ("egl", "osmesa", "glfw", "cgl"):
        raise CosimError(f"no picture can be drawn here: `{CHOICE}` is `{name}`", HINT)
    package = "glfw" if name == "glfw" else "OpenGL"
    if name != "cgl":
        extras.needed(package, f"pictures need the package `{package}`", extras.hint("replay"))
    try:
        context = importlib.import_module(f"mujoco.{name}").GLContext(*size)
        context.make_current()
    except Exception as error:  # parts of it may be missing
        problem = " ".join(str(error).split()) or type(error).__name__
        raise CosimError(f"no picture can be drawn here: `{name}` fails: {problem}", HINT) from error
    return context


def add_light_and_colors(model: Any) -> None:
    """Add light to a model without light, and a color by body to every geom without color and material."""
    if model.nlight == 0:
        model.vis.headlight.ambient[:] = 0.35
        model.vis.headlight.diffuse[:] = 0.6
        model.vis.headlight.specular[:] = 0.25
    bodies = {body: number for number, body in enumerate(dict.fromkeys(model.geom_bodyid.tolist()))}
    for geom in range(model.ngeom):
        if model.geom_matid[geom] < 0 and np.allclose(model.geom_rgba[geom], DEFAULT_COLOR):
            model.geom_rgba[geom, :3] = COLORS[bodies[int(model.geom_bodyid[geom])] % len(COLORS)]


def background(height: int, width: int) -> Picture:
    """Sky without a horizon."""
    down = np.linspace(0.0, 1.0, height)[:, None, None]
    shade = (1.0 - down) * ABOVE + down * BELOW
    return np.broadcast_to(shade.astype(np.uint8), (height, width, 3))


def cameras(model: Any, name: str) -> tuple[Any, Any]:
    """Camera of the picture and of its inset; None for a missing camera."""
    known = [model.camera(i).name for i in range(model.ncam)]
    if name and name not in known:
        hint = closest(name, known) or "Use a camera of the MJCF."
        raise CosimError(f"the model has no camera `{name}`", hint)
    found = []
    for wanted in [name] if name else [one for one in (CLOSEUP, OVERVIEW) if one in known]:
        camera = mujoco.MjvCamera()
        camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED.value, known.index(wanted)
        found.append(camera)
    return tuple((*found, None, None)[:2])


def free_camera(model: Any, data: Any, size: tuple[int, int], poses: Array) -> Any:
    """Camera with all geoms in view in all poses."""
    low, high = np.full(3, math.inf), np.full(3, -math.inf)
    # a plane has no size of its own
    seen = (model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE) & (model.geom_rgba[:, 3] > 0.0)
    for qpos in poses:
        set_pose(model, data, qpos)
        if seen.any():
            low = np.minimum(low, (data.geom_xpos - model.geom_rbound[:, None])[seen].min(axis=0))
            high = np.maximum(high, (data.geom_xpos + model.geom_rbound[:, None])[seen].max(axis=0))
    camera = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, camera)
    if np.all(np.isfinite(low)):
        camera.lookat[:] = (low + high) / 2.0
        half = math.radians(model.vis.global_.fovy / 2.0)
        narrow = min(1.0, size[0] / size[1])
        camera.distance = 0.75 * float(np.linalg.norm(high - low)) / 2.0 / (math.sin(half) * narrow)
    camera.azimuth, camera.elevation = AZIMUTH, ELEVATION
    return camera
