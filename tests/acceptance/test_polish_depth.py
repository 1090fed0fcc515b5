"""Even depth on every mold: whole cavities, polished along CL data whose feed dwells."""

from pathlib import Path

import pytest

from plants.tools.cl_path import Spiral, cl_text
from plants.tools.molds import MOLDS
from plants.tools.removal import Surface, evenness, roughness

from .measured.store import measured
from .samples.polishing import polish

pytestmark = [pytest.mark.acceptance, pytest.mark.full]

SWEEP = 6.6e-3
"""Mean speed of the ball across the path in scenario `polish`, m/s: 67 um at 50 Hz."""


@pytest.mark.parametrize("mold", MOLDS)
def test_depth_is_even_on_every_mold(mold: str, tmp_path: Path) -> None:
    path = tmp_path / f"{mold}.cls"
    path.write_text(cl_text(mold, Spiral(outer=MOLDS[mold].aperture), sweep=SWEEP), encoding="ascii")
    done = polish(
        "polish",
        f"plant.mold='{mold}'",
        f"controller.path.file='{path}'",
        "controller.feed.source='File'",
        "loop.duration=80.0",
        seed=64_001,
    )
    assert done.done, str(done)
    surface = Surface(MOLDS[mold])
    columns = ("contact_x", "contact_y", "slid", "rubbed")
    surface.polish(*(done.rows[f"plant.{name}"] for name in columns))
    depth, variation = evenness(surface, 0.2e-3, 1.6e-3)
    left = roughness(surface, 0.2e-3, 1.6e-3)
    print(
        f"{mold}: depth {1e6 * depth:.2f} um +- {1e2 * variation:.2f} %, Rz {1e6 * left.mean:.2f} um; {done}"
    )
    assert variation <= 0.015
    # of 2.08 um
    assert left.mean <= 0.2 * 2.08e-6
    measured("polish-depth", mold, variation=100.0 * variation, left=1e6 * left.mean)
