"""Replay of a trace in MuJoCo's viewer."""

from __future__ import annotations

import importlib
import time
import warnings
from functools import partial
from typing import Any

from cosim import extras
from cosim.errors import CosimError
from cosim.replay.enlarge import enlargement
from cosim.replay.motion import Recorded, motion
from cosim.replay.playback import RATE, ReplayOptions, time_scale
from cosim.replay.renderer import add_light_and_colors, set_pose


def show(recorded: Recorded, options: ReplayOptions) -> None:
    """Show a run repeatedly in a window until it is closed. The mouse moves the camera."""
    moved = motion(recorded)
    scale = time_scale(moved.times, options.seconds, options.begin, options.end)
    larger = enlargement(moved, options.enlarge)
    add_light_and_colors(moved.model)
    with open_window(moved.model, moved.data) as viewer:
        begun = time.monotonic()
        while viewer.is_running():
            picture = round(RATE * (time.monotonic() - begun))
            with viewer.lock():
                row = int(scale.rows[picture % len(scale.rows)])
                draw = partial(moved.draw, row, larger.value)
                set_pose(moved.model, moved.data, larger.qpos[row], draw)
            viewer.sync()
            time.sleep(1.0 / RATE)


def open_window(model: Any, data: Any) -> Any:
    """Window of MuJoCo's viewer that steps nothing by itself."""
    extras.needed("glfw", "the viewer needs the package `glfw`", extras.hint("replay"))
    hint = "Use a screen, or make a video with `cosim video`."
    try:
        with warnings.catch_warnings():
            # reported once, as the error
            warnings.simplefilter("ignore")
            started = importlib.import_module("glfw").init()
        if not started:
            raise CosimError("the viewer cannot open a window", hint)
        viewer = importlib.import_module("mujoco.viewer")
        # panels that would change what is only shown
        return viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)
    except CosimError:
        raise
    except Exception as error:  # system libraries may be missing
        raise CosimError(f"the viewer cannot open a window: {' '.join(str(error).split())}", hint) from error
