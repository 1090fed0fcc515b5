"""Pictures of the machines in motion, for the first page."""

from __future__ import annotations

import tempfile
from pathlib import Path

import cosim
from cosim.replay import film
from cosim.replay.motion import RECORD, of_result

LOOPS = ("centering", "deburr", "dob", "fts", "polish")
SIZE = (320, 240)
SECONDS = 4.0


def store(folder: Path) -> None:
    """Film the nominal run of each loop, and keep the picture in the middle of the film as `<loop>.jpg`."""
    for loop in LOOPS:
        scenario = cosim.load(loop, [RECORD])
        recorded = of_result(scenario, cosim.run(scenario, engine="native"))
        with tempfile.TemporaryDirectory() as place:
            film.save(recorded, film.Shot(SIZE, SECONDS), Path(place, "film.mp4"))
            (folder / f"{loop}.jpg").write_bytes(film.still(Path(place, "film.mp4")))
