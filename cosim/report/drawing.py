"""Panels as SVG, for print and before anything can be zoomed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape

import numpy as np

from cosim.report.series import thinned
from cosim.trace.columns import Array

WIDTH, HEIGHT = 1200, 300
LEFT, RIGHT, TOP, BOTTOM = 130, 16, 14, 46
COLOURS = 8
"""Colours of the style sheet, each with its own dashes."""
POINTS = 150


def panel(
    lines: Sequence[Array],
    time: tuple[float, float],
    log: bool,
    items: Mapping[str, int],
    events: Sequence[float],
) -> str:
    """Draw one panel.

    Parameters
    ----------
    lines
        Values of each column over equal times, as the axis takes them.
    time
        First and last of them, s.
    log
        Whether the values are logarithms.
    items
        Names of the values, where they are those of an enumeration.
    events
        Times that are marked, s.
    """
    shown = [thinned(line, POINTS) for line in lines]
    low, high = extent(shown)
    inside_x, inside_y = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM
    span = time[1] - time[0] or 1.0

    def x(t: float) -> float:
        return LEFT + inside_x * (t - time[0]) / span

    def y(value: float) -> float:
        return TOP + inside_y * (high - value) / (high - low)

    parts = []
    present = {number for line in shown for number in np.unique(line[np.isfinite(line)])} if items else set()
    named = [(float(number), name) for name, number in items.items() if number in present]
    round_ones = [(tick, label(10.0**tick if log else tick)) for tick in ticks(low, high, 4)]
    for value, name in named or round_ones:
        at = y(value)
        parts.append(f'<path class="grid" d="M{LEFT} {at:.0f}H{WIDTH - RIGHT}"/>')
        parts.append(f'<text class="y" x="{LEFT - 8}" y="{at + 7:.0f}">{escape(name)}</text>')
    for tick in ticks(*time, 6):
        parts.append(f'<text class="x" x="{x(tick):.0f}" y="{HEIGHT - 16}">{label(tick)}</text>')
    parts += [f'<path class="event" d="M{x(t):.0f} {TOP}V{HEIGHT - BOTTOM}"/>' for t in events]
    for i, line in enumerate(shown):
        times = np.linspace(LEFT, WIDTH - RIGHT, len(line))
        parts.append(f'<path class="line c{i % COLOURS}" d="{course(times, [y(v) for v in line])}"/>')
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img">{"".join(parts)}</svg>'


def course(x: Array, y: Sequence[float]) -> str:
    """Path through points, interrupted where there is no number."""
    words, pen = [], "M"
    for across, down in zip(x, y, strict=True):
        if not math.isfinite(down):
            pen = "M"
            continue
        words.append(f"{pen}{across:.0f} {down:.0f}")
        pen = "L"
    return "".join(words)


def extent(lines: Sequence[Array]) -> tuple[float, float]:
    """Limits of an axis that holds all finite values, with some room."""
    finite = np.concatenate([line[np.isfinite(line)] for line in lines])
    if not finite.size:
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    room = 0.05 * (high - low) or 0.5 * abs(low) or 1.0
    return low - room, high + room


def ticks(low: float, high: float, count: int) -> list[float]:
    """Round numbers between two limits, about so many."""
    raw = (high - low) / count
    if not (raw > 0.0 and math.isfinite(raw)):
        return [low]
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= raw * (1.0 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [n * step for n in range(first, last + 1)]


def label(value: float) -> str:
    """Format a number at an axis."""
    return f"{value:.4g}" if abs(value) > 1e-12 else "0"
