"""Pictures of the machines in motion, for the first page."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PIL import Image

import cosim
from cosim.replay.motion import RECORD, motion, of_result
from cosim.replay.renderer import Renderer

LOOPS = ("centering", "deburr", "dob", "fts", "polish")
SIZE = (264, 198)
"""Width and height, pixels: three side by side."""
FINER = 3
"""Rendered pixels per output pixel along a side."""


def store(folder: Path) -> None:
    """Draw each machine in the middle of its nominal run, as `<name>.jpg`."""
    for loop in LOOPS:
        scenario = cosim.load(loop, [RECORD])
        moved = motion(of_result(scenario, cosim.run(scenario, engine="native")))
        row = len(moved.qpos) // 2
        draw = partial(moved.draw, row, lambda name, value: value)
        width, height = SIZE
        with Renderer(moved.model, moved.data, (FINER * width, FINER * height), "", moved.qpos) as drawer:
            picture = Image.fromarray(drawer.picture(moved.qpos[row], draw))
        picture.resize(SIZE, Image.Resampling.LANCZOS).save(folder / f"{loop}.jpg", quality=90)
