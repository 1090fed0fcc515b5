"""Panels as SVG, for print and for browsers without scripts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from typing import Any

import numpy as np

from cosim.report.series import thinned
from cosim.trace.columns import Array

WIDTH, HEIGHT = 1200, 300
LEFT, RIGHT, TOP, BOTTOM = 130, 16, 14, 46
COLOURS = 8
"""Number of colors in the style sheet, each with its own dashes."""
POINTS = 100
LEAST = 0.02
"""Minimum relative value of a drawn cell."""
SHADES = 20
"""Number of shades of cells in a drawing; the interactive plot has all."""
CHART = 560
"""Height of a chart that is not a time series."""


@dataclass(frozen=True)
class Frame:
    """Axes of a drawing: minimum and maximum of `x` and `y`."""

    x: tuple[float, float]
    y: tuple[float, float]
    height: int = HEIGHT

    def across(self, x: Any) -> Any:
        """Position in the picture from the left."""
        low, high = self.x
        return LEFT + (WIDTH - LEFT - RIGHT) * (x - low) / ((high - low) or 1.0)

    def down(self, y: Any) -> Any:
        """Position in the picture from the top."""
        low, high = self.y
        return TOP + (self.height - TOP - BOTTOM) * (high - y) / (high - low)

    def grid(
        self, named: Sequence[tuple[float, str]], log: bool, x_log: bool = False, whole: bool = False
    ) -> Iterator[str]:
        """Grid lines and numbers at round values, or the names of values."""
        for value, name in named or [
            (tick, label(10.0**tick if log else tick)) for tick in ticks(*self.y, 4)
        ]:
            at = self.down(value)
            yield f'<path class="grid" d="M{LEFT} {at:.0f}H{WIDTH - RIGHT}"/>'
            yield f'<text class="y" x="{LEFT - 8}" y="{at + 7:.0f}">{escape(name)}</text>'
        for tick in ticks(*self.x, 6, 1.0 if whole else 0.0):
            shown = label(10.0**tick if x_log else tick)
            yield f'<text class="x" x="{self.across(tick):.0f}" y="{self.height - 16}">{shown}</text>'

    def picture(self, parts: Sequence[str]) -> str:
        """SVG of the parts."""
        return f'<svg viewBox="0 0 {WIDTH} {self.height}" role="img">{"".join(parts)}</svg>'


def panel(
    lines: Sequence[Array],
    time: tuple[float, float],
    log: bool,
    items: Mapping[str, int],
    events: Sequence[float],
    limits: Sequence[float] = (),
) -> str:
    """Draw one panel.

    Parameters
    ----------
    lines
        Values of each column at equal times, in axis coordinates.
    time
        First and last of them, s.
    log
        Whether the values are logarithms.
    items
        Names of the values of an enumeration.
    events
        Marked times, s.
    limits
        Marked values.
    """
    shown = [thinned(line, POINTS) for line in lines]
    frame = Frame(time, extent([*shown, np.array(limits, dtype=float)]))
    present = {number for line in shown for number in np.unique(line[np.isfinite(line)])} if items else set()
    named = [(float(number), name) for name, number in items.items() if number in present]
    parts = list(frame.grid(named, log))
    parts += [f'<path class="event" d="M{frame.across(t):.0f} {TOP}V{HEIGHT - BOTTOM}"/>' for t in events]
    parts += [f'<path class="limit" d="M{LEFT} {frame.down(v):.0f}H{WIDTH - RIGHT}"/>' for v in limits]
    for i, line in enumerate(shown):
        times = np.linspace(LEFT, WIDTH - RIGHT, len(line))
        parts.append(f'<path class="line c{i % COLOURS}" d="{curve(times, frame.down(line))}"/>')
    return frame.picture(parts)


@dataclass(frozen=True)
class Kind:
    """Style of a chart of values over values.

    Parameters
    ----------
    x_log, log
        Whether `x` and `y` are logarithms.
    equal
        Whether both axes have the same scale.
    points
        Whether every point has a marker.
    whole
        Whether `x` are whole numbers.
    """

    x_log: bool = False
    log: bool = False
    equal: bool = False
    points: bool = False
    whole: bool = False


def chart(
    lines: Sequence[tuple[Array, Array]],
    kind: Kind,
    marks: Sequence[tuple[float, str]] = (),
    levels: Sequence[tuple[float, str]] = (),
) -> str:
    """Draw values over values, both in axis coordinates.

    Parameters
    ----------
    marks
        Marked positions of `x` with texts.
    levels
        Marked values with texts.
    """
    ends = extent([*(y for _, y in lines), np.array([level for level, _ in levels], dtype=float)])
    sides = extent([*(x for x, _ in lines), np.array([place for place, _ in marks], dtype=float)])
    frame = framed(sides, ends, kind.equal)
    parts = list(frame.grid([], kind.log, kind.x_log, kind.whole))
    for level, words in levels:
        at = frame.down(level)
        parts.append(f'<path class="limit" d="M{LEFT} {at:.0f}H{WIDTH - RIGHT}"/>')
        parts.append(f'<text class="mark" x="{WIDTH - RIGHT}" y="{at - 6:.0f}">{escape(words)}</text>')
    for i, (place, words) in enumerate(marks):
        at = f"{frame.across(place):.0f}"
        parts.append(f'<path class="event" d="M{at} {TOP}V{CHART - BOTTOM}"/>')
        parts.append(f'<text class="mark" x="{WIDTH - RIGHT}" y="{TOP + 24 + 26 * i}">{escape(words)}</text>')
    for i, (across, values) in enumerate(lines):
        places, heights = frame.across(across), frame.down(values)
        parts.append(f'<path class="line c{i % COLOURS}" d="{curve(places, heights)}"/>')
        if kind.points:
            known = np.isfinite(places) & np.isfinite(heights)
            dots = "".join(f"M{a:.0f} {b:.0f}h0" for a, b in zip(places[known], heights[known], strict=True))
            parts.append(f'<path class="dots c{i % COLOURS}" d="{dots}"/>')
    return frame.picture(parts)


@dataclass(frozen=True)
class Cells:
    """Values in the cells of a plane.

    Parameters
    ----------
    x, y
        Edges of the columns and rows.
    parts
        Values relative to the largest, shape (y, x).
    """

    x: Array
    y: Array
    parts: Array


def cells(found: Cells, equal: bool) -> str:
    """Draw cells with a darkness that increases with the value.

    `equal` states whether both axes have the same scale.
    """
    x, y, parts = found.x, found.y, found.parts
    frame = framed((float(x[0]), float(x[-1])), (float(y[0]), float(y[-1])), equal)
    high = float(frame.down(y[0]) - frame.down(y[1]))
    shades: dict[float, list[str]] = {}
    # merge adjacent cells with the same shade
    steps = np.where(parts > LEAST, np.ceil(parts * SHADES), 0.0)
    for row, line in enumerate(steps):
        top = frame.down(y[row + 1])
        ends = [0, *(np.flatnonzero(np.diff(line)) + 1), len(line)]
        for first, last in pairwise(ends):
            if line[first] > 0.0:
                left, right = frame.across(x[first]), frame.across(x[last])
                way = f"{right - left + 1:.0f}"
                places = shades.setdefault(line[first] / SHADES, [])
                places.append(f"M{left:.0f} {top:.0f}h{way}v{high + 1:.0f}h-{way}")
    painted = (
        f'<path class="cell" opacity="{shade:g}" d="{"".join(places)}"/>' for shade, places in shades.items()
    )
    return frame.picture([*frame.grid([], False), *painted])


def framed(x: tuple[float, float], y: tuple[float, float], equal: bool) -> Frame:
    """Axes of a chart that is not a time series."""
    if not equal:
        return Frame(x, y, CHART)
    # a unit is as many pixels across as down
    wide = (WIDTH - LEFT - RIGHT) / (CHART - TOP - BOTTOM)
    half = 0.5 * max(x[1] - x[0], wide * (y[1] - y[0]))
    across, up = 0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])
    return Frame((across - half, across + half), (up - half / wide, up + half / wide), CHART)


def curve(x: Array, y: Array) -> str:
    """Path through points, interrupted at NaN; a level section has two points."""
    pieces: list[list[tuple[int, int]]] = [[]]
    for across, down in zip(x, y, strict=True):
        if not (math.isfinite(down) and math.isfinite(across)):
            pieces.append([])
            continue
        point, piece = (round(float(across)), round(float(down))), pieces[-1]
        if len(piece) > 1 and piece[-2][1] == piece[-1][1] == point[1]:
            (before, _), (last, _) = piece[-2:]
            if (last - before) * (point[0] - last) >= 0:
                piece.pop()
        piece.append(point)
    return "".join("M" + "L".join(f"{across} {down}" for across, down in piece) for piece in pieces if piece)


def extent(lines: Sequence[Array]) -> tuple[float, float]:
    """Limits of an axis for all finite values, with a margin."""
    finite = np.concatenate([line[np.isfinite(line)] for line in lines])
    if not finite.size:
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    room = 0.05 * (high - low) or 0.5 * abs(low) or 1.0
    return low - room, high + room


def ticks(low: float, high: float, count: int, least: float = 0.0) -> list[float]:
    """Round numbers between two limits, with an approximate count and a minimum spacing."""
    raw = (high - low) / count
    if not (raw > 0.0 and math.isfinite(raw)):
        return [low]
    power = 10.0 ** math.floor(math.log10(raw))
    step = max(least, next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= raw * (1.0 - 1e-9)))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [n * step for n in range(first, last + 1)]


def label(value: float) -> str:
    """Format a number at an axis."""
    return f"{value:.4g}" if abs(value) > 1e-12 else "0"
