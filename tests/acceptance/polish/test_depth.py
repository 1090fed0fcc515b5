"""Even and mapped depth on every mold: whole cavities, polished along CL data with a feed that dwells."""

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from plants.tools.cl_path import Spiral, cl_text
from plants.tools.dwell import DepthMap
from plants.tools.molds import MOLDS
from plants.tools.removal import Surface, evenness, mismatch, roughness

from ..measured.store import measured
from ..samples.polishing import polish

pytestmark = [pytest.mark.acceptance, pytest.mark.full]

SWEEP = 6.6e-3
"""Mean speed of the ball across the path in scenario `polish`, m/s: 67 um at 50 Hz."""


@cache
def polished(mold: str, seed: int, planned: bool) -> Surface:
    """Polish a whole cavity along a path that is made for it."""
    removal = hollows() if planned else None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "path.cls")
        text = cl_text(mold, Spiral(outer=MOLDS[mold].aperture), sweep=SWEEP, removal=removal)
        path.write_text(text, encoding="ascii")
        done = polish(
            "polish",
            f"plant.mold='{mold}'",
            f"controller.path.file='{path}'",
            "controller.expert.feed.source='File'",
            "loop.duration=80.0",
            seed=seed,
        )
    assert done.done, str(done)
    surface = Surface(MOLDS[mold])
    columns = ("contact_x", "contact_y", "slid", "rubbed")
    surface.polish(*(done.rows[f"plant.{name}"] for name in columns))
    return surface


def hollows() -> DepthMap:
    """Return a map of 0.7 to 1.6 of a depth: a slope along x and a hollow of 0.4 mm."""
    axis = np.linspace(-2e-3, 2e-3, 81)
    x, y = np.meshgrid(axis, axis)
    hollow = np.exp(-((x + 0.5e-3) ** 2 + (y - 0.4e-3) ** 2) / (2.0 * 0.4e-3**2))
    return DepthMap(axis, axis, 1.0 + 0.3 * x / 1.6e-3 + 0.3 * hollow)


@pytest.mark.parametrize("mold", MOLDS)
def test_depth_is_even_on_every_mold(mold: str) -> None:
    surface = polished(mold, 64_001, planned=False)
    depth, variation = evenness(surface, 0.2e-3, 1.6e-3)
    left = roughness(surface, 0.2e-3, 1.6e-3)
    print(f"{mold}: depth {1e6 * depth:.2f} um +- {1e2 * variation:.2f} %, Rz {1e6 * left.mean:.2f} um")
    assert variation <= 0.015
    # of 2.08 um
    assert left.mean <= 0.2 * 2.08e-6
    measured("polish-depth", mold, variation=100.0 * variation, left=1e6 * left.mean)


@pytest.mark.parametrize("mold", MOLDS)
def test_depth_follows_a_map(mold: str) -> None:
    even, planned = (
        mismatch(polished(mold, seed, planned=seed != 64_001), hollows(), 0.2e-3, 1.6e-3)
        for seed in (64_001, 64_002)
    )
    print(f"{mold}: {1e2 * planned:.2f} % from the map, {1e2 * even:.1f} % with an even feed")
    assert planned <= 0.03
    assert even >= 0.1
    measured("polish-map", mold, even=100.0 * even, planned=100.0 * planned)
