"""Replay of a trace in MuJoCo's viewer."""

from __future__ import annotations

import importlib
import time
import warnings
from functools import partial
from typing import Any

from cosim import extras
from cosim.errors import CosimError
from cosim.replay import enlarge
from cosim.replay.motion import Recorded, motion
from cosim.replay.pace import RATE, pace
from cosim.replay.renderer import colour, light, place
from cosim.replay.video_file import Shot


def show(recorded: Recorded, shot: Shot, again: bool = True) -> None:
    """Show a run in a window until it is closed.

    Parameters
    ----------
    shot
        Part, pace and enlargement of the run; the camera is moved with the mouse.
    again
        Whether it repeats.

    Raises
    ------
    CosimError
        Its coordinates are not in the trace, or there is no screen.
    """
    moved = motion(recorded)
    paced = pace(moved.times, shot.seconds, shot.begin, shot.end)
    factors = enlarge.given(shot.enlarge, moved) if shot.enlarge else enlarge.chosen(moved)
    qpos, drawn = enlarge.enlarged(moved, factors), enlarge.one(moved, factors)
    light(moved.model)
    colour(moved.model)
    viewer = opened(moved.model, moved.data)
    try:
        begun = time.monotonic()
        while viewer.is_running():
            picture = round(RATE * (time.monotonic() - begun))
            if picture >= len(paced.rows) and not again:
                return
            with viewer.lock():
                row = int(paced.rows[picture % len(paced.rows)])
                place(moved.model, moved.data, qpos[row], partial(moved.draw, row, drawn))
            viewer.sync()
            time.sleep(1.0 / RATE)
    finally:
        viewer.close()


def opened(model: Any, data: Any) -> Any:
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
