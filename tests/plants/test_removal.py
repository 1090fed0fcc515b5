"""Removal on a height map against closed forms."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from plants.tools.molds import MOLDS, Mold
from plants.tools.removal import Process, Surface, evenness, heights, roughness

Matrix = np.ndarray[Any, Any]

PLANE = Mold()
PLAIN = Process(selective=False)
HERTZ = (0.75 * 5.0 * 0.6e-3 / 1e9) ** (1.0 / 3.0)
"""Radius of the contact under 5 N, m."""


def lines(reach: float, pick: float) -> tuple[Matrix, Matrix]:
    """Zigzag over a square of half the width `reach`, a point every 5 um."""
    along = np.arange(-reach, reach, 5e-6)
    rows = np.arange(-reach, reach + 1e-9, pick)
    x = np.concatenate([along[:: 1 if k % 2 == 0 else -1] for k in range(len(rows))])
    return x, np.repeat(rows, len(along))


def polish(surface: Surface, x: Matrix, y: Matrix, load: float = 5.0, share: float = 1.0) -> Matrix:
    """Polish along a path of constant load; returns the way so far."""
    slid = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    surface.polish(x, y, slid, load * slid, share)
    return slid


@pytest.mark.parametrize("selective", [True, False])
@pytest.mark.parametrize("mold", ["sphere", "saddle", "steep"])
def test_the_volume_is_that_of_preston(mold: str, selective: bool) -> None:
    surface = Surface(MOLDS[mold], Process(selective=selective))
    angle = np.linspace(0.0, 6.0, 800)
    slid = polish(surface, 1.2e-3 * np.cos(angle), 1.2e-3 * np.sin(angle), load=4.0)
    assert surface.volume == pytest.approx(4e-11 * 4.0 * slid[-1], rel=1e-9)


def test_a_process_has_the_contact_of_the_plant() -> None:
    # Hertz: load = 4/3 modulus sqrt(radius) indentation^1.5
    process = Process.of_contact(1.2e6, 5.0)
    indentation = (0.75 * 5.0 / (process.modulus * math.sqrt(process.radius))) ** (2.0 / 3.0)
    loads = [
        4.0 / 3.0 * process.modulus * math.sqrt(process.radius) * (indentation + d) ** 1.5
        for d in (-1e-9, 1e-9)
    ]
    assert (loads[1] - loads[0]) / 2e-9 == pytest.approx(1.2e6, rel=1e-6)


def test_the_contact_is_that_of_hertz() -> None:
    # the longest distance through the contact is in the middle of a straight line
    surface = Surface(PLANE, PLAIN)
    slid = polish(surface, np.linspace(-1e-3, 1e-3, 1000), np.zeros(1000))
    half = HERTZ
    depth = surface.removed[200]
    assert not depth[abs(surface.y) > half + 10e-6].any()
    # integral of 1.5 p (1 - r^2 / a^2)^(1/2) along the line: 3 F / (4 a) (1 - y^2 / a^2)
    wanted = 4e-11 * 0.75 * 5.0 / half * np.maximum(0.0, 1.0 - (surface.y / half) ** 2)
    assert depth == pytest.approx(wanted, abs=0.02 * wanted.max())
    assert slid[-1] == pytest.approx(2e-3, rel=2e-3)


def test_close_lines_remove_evenly_and_by_load_over_pick() -> None:
    surface = Surface(PLANE, PLAIN, radius=0.7e-3)
    polish(surface, *lines(0.5e-3, 25e-6))
    depth, variation = evenness(surface, 0.0, 0.3e-3)
    assert depth == pytest.approx(4e-11 * 5.0 / 25e-6, rel=0.01)
    assert variation < 0.01


def test_without_selectivity_cusps_stay_and_with_it_they_go() -> None:
    left = {}
    for selective in (False, True):
        surface = Surface(PLANE, Process(selective=selective), radius=0.7e-3)
        polish(surface, *lines(0.5e-3, 25e-6))
        before, after = (roughness(surface, 0.0, 0.3e-3, first) for first in (True, False))
        assert before.mean == pytest.approx(0.1e-3**2 / (8.0 * 0.6e-3), rel=0.03)
        left[selective] = after.mean / before.mean
    assert 0.98 < left[False] < 1.05
    assert left[True] < 0.2


def test_a_cusp_wears_at_the_rate_of_its_pressure() -> None:
    # dh/dway = -preston selectivity h for a load spread evenly: exp(-preston selectivity time over the point)
    process = replace(Process(), preston=2e-12)
    surface = Surface(PLANE, process, radius=0.7e-3)
    polish(surface, *lines(0.5e-3, 25e-6))
    # of one line the contact passes a point on 2 (a^2 - y^2)^(1/2); all lines: pi a^2 / pick
    way = math.pi * HERTZ**2 / 25e-6
    before, after = (roughness(surface, 0.0, 0.3e-3, first) for first in (True, False))
    assert after.rms / before.rms == pytest.approx(math.exp(-2e-12 * process.selectivity * way), rel=0.03)


def test_passes_keep_pressure_from_running_ahead_of_the_path() -> None:
    # a path that proceeds along x, 8 um deep
    slopes = []
    for passes in (1, 5):
        surface = Surface(PLANE, Process(passes=passes), radius=0.7e-3)
        y, x = lines(0.5e-3, 25e-6)
        polish(surface, x, y)
        inside = abs(surface.x) < 0.3e-3
        mean = surface.removed[inside][:, inside].mean(axis=1)
        slopes.append(np.polyfit(surface.x[inside], mean, 1)[0] * 0.6e-3 / mean.mean())
    assert slopes[0] > 0.05
    assert abs(slopes[1]) < 0.4 * slopes[0]


def test_a_fraction_of_a_pass_removes_that_fraction() -> None:
    whole, half = Surface(PLANE, PLAIN, radius=0.7e-3), Surface(PLANE, PLAIN, radius=0.7e-3)
    x, y = lines(0.2e-3, 50e-6)
    polish(whole, x, y)
    for _ in range(2):
        polish(half, x, y, share=0.5)
    assert half.removed == pytest.approx(whole.removed, abs=1e-18)


def test_nothing_is_removed_without_motion_or_load() -> None:
    surface = Surface(MOLDS["led"])
    still = np.full(100, 0.3e-3)
    surface.polish(still, still, np.zeros(100), np.zeros(100))
    surface.polish(np.linspace(0.0, 1e-3, 100), still, np.linspace(0.0, 1e-3, 100), np.zeros(100))
    assert surface.volume == 0.0
    assert np.array_equal(surface.height, surface.before)


@pytest.mark.parametrize("cusps", ["raster", "concentric"])
def test_cusps_are_those_of_the_mill(cusps: Any) -> None:
    surface = Surface(MOLDS["led"], cusps=cusps)
    assert surface.before.min() == 0.0
    assert surface.before.max() == pytest.approx(Process().cusp, rel=1e-9)
    assert Process().cusp == pytest.approx(2.083e-6, rel=1e-3)
    fresh = roughness(surface, 0.2e-3, 1.6e-3)
    assert fresh == roughness(surface, 0.2e-3, 1.6e-3, before=True)
    # a parabola of the height c has the deviation c (4 / 45)^(1/2)
    assert fresh.rms == pytest.approx(2.083e-6 * math.sqrt(4.0 / 45.0), rel=0.06)


def test_a_path_beyond_the_map_is_no_error() -> None:
    surface = Surface(MOLDS["led"])
    polish(surface, np.linspace(1.9e-3, 2.2e-3, 100), np.zeros(100))
    assert np.isfinite(surface.height).all()


def test_tiles_must_fit_between_the_radii() -> None:
    with pytest.raises(ValueError, match=r"no tile of `0.0002` m between `0.001` m and `0.0011` m"):
        evenness(Surface(PLANE), 1.0e-3, 1.1e-3)


def test_the_maps_of_a_path_show_where_it_went() -> None:
    # along x at a quarter of the map above its middle
    x = np.linspace(-0.4e-3, 0.4e-3, 200)
    way = x - x[0]
    maps = heights(x, np.full(200, 0.3e-3), way, 5.0 * way)
    (across, up, before), (_, _, after) = maps["before"], maps["after"]
    assert before.shape == after.shape == (len(up) - 1, len(across) - 1)
    assert (across[0], across[-1]) == pytest.approx((-0.705e-3, 0.695e-3))
    gone = before - after
    assert gone.min() >= 0.0
    row, column = np.unravel_index(np.argmax(gone), gone.shape)
    assert 0.5 * (up[row] + up[row + 1]) == pytest.approx(0.3e-3, abs=0.05e-3)
    assert abs(across[column]) < 0.4e-3
    assert not gone[up[:-1] < 0.1e-3].any()
