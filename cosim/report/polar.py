"""Polar charts as SVG: values over an angle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape

import numpy as np

from cosim.report import drawing
from cosim.report.drawing import CHART, COLOURS, WIDTH, Kind
from cosim.trace.columns import Array

X, Y = WIDTH / 2, CHART / 2
RADIUS = CHART / 2 - 34
SPOKES = 12


def chart(
    lines: Sequence[tuple[Array, Array]],
    kind: Kind,
    places: Sequence[tuple[float, str]] = (),
    levels: Sequence[tuple[float, str]] = (),
) -> str:
    """Draw values over angles in rad, the values in axis coordinates.

    Parameters
    ----------
    places
        Marked angles.
    levels
        Marked values, each a circle with text.
    """
    known = [values for _, values in lines] + [np.array([level for level, _ in levels], dtype=float)]
    low, high = drawing.extent(known)
    # a logarithm has no natural middle; another value has 0
    low = np.floor(low) if kind.log else min(0.0, low)

    def radius(value: Array) -> Array:
        return RADIUS * (value - low) / ((high - low) or 1.0)

    parts = list(grid(low, high, kind.log))
    parts += [spoke(angle, "event") for angle, _ in places]
    for level, label in levels:
        at = RADIUS * (level - low) / ((high - low) or 1.0)
        parts.append(f'<circle class="limit" cx="{X:.0f}" cy="{Y:.0f}" r="{at:.0f}"/>')
        parts.append(f'<text class="mark" x="{WIDTH - 16}" y="{CHART - 16}">{escape(label)}</text>')
    for i, (angles, values) in enumerate(lines):
        across, down = X + radius(values) * np.cos(angles), Y - radius(values) * np.sin(angles)
        parts.append(f'<path class="line c{i % COLOURS}" d="{drawing.curve(across, down)}"/>')
    return f'<svg viewBox="0 0 {WIDTH} {CHART}" role="img">{"".join(parts)}</svg>'


def grid(low: float, high: float, log: bool) -> Iterator[str]:
    """Circles at round values with their numbers, and spokes."""
    for tick in drawing.ticks(low, high, 4):
        at = RADIUS * (tick - low) / ((high - low) or 1.0)
        label = drawing.label(10.0**tick if log else tick)
        yield f'<circle class="grid" cx="{X:.0f}" cy="{Y:.0f}" r="{at:.0f}"/>'
        yield f'<text x="{X + 4:.0f}" y="{Y - at - 4:.0f}">{label}</text>'
    for i in range(SPOKES):
        yield spoke(2.0 * np.pi * i / SPOKES, "grid")


def spoke(angle: float, kind: str) -> str:
    """Line from the center to the rim."""
    across, down = X + RADIUS * np.cos(angle), Y - RADIUS * np.sin(angle)
    return f'<path class="{kind}" d="M{X:.0f} {Y:.0f}L{across:.0f} {down:.0f}"/>'
