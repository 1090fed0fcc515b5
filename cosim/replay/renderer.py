"""Pictures of a model without a screen."""

from __future__ import annotations

import importlib
import math
import os
import sys
from types import TracebackType
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cosim import extras
from cosim.errors import CosimError, closest
from cosim.trace.columns import Array

Picture = NDArray[np.uint8]
"""Red, green and blue, shape (height, width, 3)."""

CHOICE = "MUJOCO_GL"
"""Variable of the environment with which MuJoCo lets choose what draws."""
BACKENDS = {"linux": "egl", "darwin": "cgl", "win32": "glfw"}
HINT = (
    "on Debian or Ubuntu `apt-get install libegl1 libgl1-mesa-dri` draws without a screen; "
    f"`{CHOICE}` chooses `egl`, `osmesa` or `glfw`"
)
DEFAULT_COLOUR = (0.5, 0.5, 0.5, 1.0)
"""What MuJoCo gives a geom that the MJCF gives none."""
COLOURS = ((0.36, 0.51, 0.68), (0.79, 0.60, 0.33), (0.47, 0.62, 0.48), (0.67, 0.45, 0.48), (0.55, 0.52, 0.66))
"""Colours of the bodies of a machine whose MJCF names none, in turns."""
ABOVE, BELOW = np.array([226.0, 232.0, 238.0]), np.array([158.0, 170.0, 182.0])
"""Background from top to bottom."""
AZIMUTH, ELEVATION = 125.0, -22.0
"""Where the free camera looks, degrees."""
OVERVIEW = "overview"
"""Camera of an MJCF that is taken where none is asked for."""


class Renderer:
    """Draws a model; a context manager, because the graphics of the system must be given back.

    Parameters
    ----------
    model, data
        MuJoCo's; light and colours that the model does not have are added to it.
    size
        Width and height, pixels.
    camera
        Name of a camera of the model; empty is `overview` if there is one, else one that sees all of it.
    poses
        Coordinates at which everything shall be in sight of that one, shape (poses, coordinates).

    Raises
    ------
    CosimError
        Nothing here can draw, or the model has no such camera.
    """

    def __init__(self, model: Any, data: Any, size: tuple[int, int], camera: str, poses: Array) -> None:
        self.model, self.data = model, data
        light(model)
        colour(model)
        model.vis.global_.offwidth, model.vis.global_.offheight = size
        self.camera = named_camera(model, camera) or free_camera(model, data, size, poses)
        self.rectangle = mujoco.MjrRect(0, 0, *size)
        self.scene = mujoco.MjvScene(model, maxgeom=10000)
        self.background = background(size[1], size[0])
        self.options = mujoco.MjvOption()
        self.context = graphics(size)
        try:
            self.drawer: Any = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        except Exception as error:
            self.context.free()
            raise CosimError(f"no picture can be drawn here: {error}", HINT) from error
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self.drawer)
        self.drawer.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR.value

    def __enter__(self) -> Renderer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.drawer.free()
        self.context.free()

    def picture(self, qpos: Array) -> Picture:
        """Draw the model with these coordinates."""
        place(self.model, self.data, qpos)
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(self.model, self.data, self.options, None, self.camera, everything, self.scene)
        mujoco.mjr_render(self.rectangle, self.scene, self.drawer)
        shape = (self.rectangle.height, self.rectangle.width)
        colours, depth = np.empty((*shape, 3), np.uint8), np.empty(shape, np.float32)
        mujoco.mjr_readPixels(colours, depth, self.rectangle, self.drawer)
        # graphics count lines from below, and nothing is as far as it gets
        colours, nothing = colours[::-1], depth[::-1] == 0.0
        return np.where(nothing[..., None], self.background, colours)


def place(model: Any, data: Any, qpos: Array) -> None:
    """Move a model to coordinates, as far as drawing it needs."""
    data.qpos[:] = qpos
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_camlight(model, data)
    mujoco.mj_tendon(model, data)


def graphics(size: tuple[int, int]) -> Any:
    """Context of the graphics of this system, ready to draw.

    Raises
    ------
    CosimError
        A package or a library of the system is missing.
    """
    name = os.environ.get(CHOICE, "").strip().lower() or BACKENDS.get(sys.platform, "egl")
    if name not in ("egl", "osmesa", "glfw", "cgl"):
        raise CosimError(f"no picture can be drawn here: `{CHOICE}` is `{name}`", HINT)
    package = "glfw" if name == "glfw" else "OpenGL"
    if name != "cgl":
        extras.needed(package, f"pictures need the package `{package}`", extras.hint("replay"))
    try:
        context = importlib.import_module(f"mujoco.{name}").GLContext(*size)
        context.make_current()
    except Exception as error:  # whatever is missing of it
        problem = " ".join(str(error).split()) or type(error).__name__
        raise CosimError(f"no picture can be drawn here: `{name}` fails: {problem}", HINT) from error
    return context


def light(model: Any) -> None:
    """Give light to a model that has none of its own."""
    if model.nlight == 0:
        model.vis.headlight.ambient[:] = 0.35
        model.vis.headlight.diffuse[:] = 0.6
        model.vis.headlight.specular[:] = 0.25


def colour(model: Any) -> None:
    """Give a colour by its body to every geom that has neither colour nor material."""
    bodies = {body: turn for turn, body in enumerate(dict.fromkeys(model.geom_bodyid.tolist()))}
    for geom in range(model.ngeom):
        if model.geom_matid[geom] < 0 and np.allclose(model.geom_rgba[geom], DEFAULT_COLOUR):
            model.geom_rgba[geom, :3] = COLOURS[bodies[int(model.geom_bodyid[geom])] % len(COLOURS)]


def background(height: int, width: int) -> Picture:
    """Sky without a horizon."""
    down = np.linspace(0.0, 1.0, height)[:, None, None]
    shade = (1.0 - down) * ABOVE + down * BELOW
    return np.broadcast_to(shade.astype(np.uint8), (height, width, 3))


def named_camera(model: Any, name: str) -> Any:
    """Camera of the model, None where none is asked for and there is no overview."""
    known = [model.camera(i).name for i in range(model.ncam)]
    if name and name not in known:
        raise CosimError(
            f"the model has no camera `{name}`", closest(name, known) or "the MJCF names its cameras"
        )
    wanted = name or OVERVIEW
    if wanted not in known:
        return None
    camera = mujoco.MjvCamera()
    camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED.value, known.index(wanted)
    return camera


def free_camera(model: Any, data: Any, size: tuple[int, int], poses: Array) -> Any:
    """Camera that sees all geoms in all poses."""
    low, high = np.full(3, math.inf), np.full(3, -math.inf)
    # a plane has no size of its own
    seen = (model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE) & (model.geom_rgba[:, 3] > 0.0)
    for qpos in poses:
        place(model, data, qpos)
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
