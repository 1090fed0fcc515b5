"""Curves of charts: paths, spectra, peaks, distributions, thresholds and frequency responses."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cosim.formatting.quantity import round_down
from cosim.scenario.model import Chart
from cosim.trace.columns import BUCKETS, Array, extremes

MAX_POINTS = 2 * BUCKETS
SEEN = 0.1
"""Size of the largest enlarged error relative to the path."""
ORDERS = 40
"""Maximum waves per revolution of a spectrum over an angle."""
PER_TURN = 512
"""Samples per revolution of a spectrum over an angle."""
MAX_LINES = 12
"""Maximum lines of a split path; the last one holds all further values."""
DENSE = 200
"""Number of interpolated points per measured one, for crossings."""


class Line(NamedTuple):
    """One line of a chart: its points, in the units of the axes."""

    name: str
    x: Array
    y: Array


class Cells(NamedTuple):
    """Values in the cells of a plane, relative to the largest, shape (y, x); `x`, `y` are the edges."""

    x: Array
    y: Array
    parts: Array


Evaluate = Callable[[str], Array]
"""Value of an expression in each row."""


def path(chart: Chart, name: str, y: Array, mask: Any, value: Evaluate) -> list[Line]:
    """One value over another in the order of the rows; one line for each value of the split."""
    x = value(chart.x)
    if chart.error:
        return enlarged_error(name, x[mask], y[mask], value(chart.error)[mask])
    if not chart.split:
        return [Line(name, *decimated(x[mask], y[mask]))]
    split = value(chart.split)
    parts = np.unique(split[mask & np.isfinite(split)])
    last = parts[min(len(parts), MAX_LINES) - 1] if len(parts) else np.nan
    prefix = f"{name}, " if len(chart.y) > 1 or len(chart.parts) > 1 else ""
    found = []
    for part in parts[:MAX_LINES]:
        rest = part == last and len(parts) > MAX_LINES
        rows = mask & (split >= part if rest else split == part)
        label = f"{chart.split_name} {part:g}{' and on' if rest else ''}".strip()
        found.append(Line(prefix + label, *decimated(x[rows], y[rows])))
    return found


def enlarged_error(name: str, x: Array, y: Array, error: Array) -> list[Line]:
    """Nominal path and its enlarged normal error; empty without motion."""
    along = np.gradient(x) + 1j * np.gradient(y) if len(x) > 1 else np.zeros(len(x))
    moved = np.abs(along) > 0.0
    if not moved.any():
        return []
    left = 1j * along[moved] / np.abs(along[moved])
    wanted, error = (x + 1j * y)[moved] - error[moved] * left, error[moved]
    size, most = np.ptp(wanted.real) + np.ptp(wanted.imag), np.max(np.abs(error), initial=0.0)
    factor = round_down(SEEN * size / most) if most > 0.0 else 1.0
    drawn = wanted + factor * error * left
    return [
        Line("nominal", *decimated(wanted.real, wanted.imag)),
        Line(f"{name}, its error {factor:g} x larger", *decimated(drawn.real, drawn.imag)),
    ]


def decimated(x: Array, y: Array) -> tuple[Array, Array]:
    """Decimated points: the rows with minimum and maximum `x` and `y` in equal intervals."""
    if len(y) <= MAX_POINTS:
        return x, y
    rows = np.unique(np.concatenate([extremes(each, MAX_POINTS // 4) for each in (x, y)]))
    return x[rows], y[rows]


def spectrum(chart: Chart, name: str, y: Array, mask: Any, value: Evaluate) -> list[Line]:
    """Amplitudes by frequency in Hz, or by waves per revolution over an angle, without the mean.

    An angle is cut to whole revolutions. Both use the longest interval without a gap.
    """
    if not chart.x:
        rows = longest_interval(mask & np.isfinite(y))
        times = value("time")[rows]
        return [by_frequency(name, times, y[rows])] if len(times) > 3 else []
    angle = value(chart.x)
    rows = longest_interval(mask)
    rows = rows[np.isfinite(angle[rows]) & np.isfinite(y[rows])]
    angle, y = np.abs(angle[rows] - angle[rows][:1]), y[rows]
    turns = int(angle[-1] / (2.0 * np.pi)) if len(angle) else 0
    if turns < 1 or np.any(np.diff(angle) < 0.0):
        return []
    # the last turns: what came before may not have settled
    even = angle[-1] - 2.0 * np.pi * np.arange(turns * PER_TURN)[::-1] / PER_TURN
    waves = np.abs(np.fft.rfft(np.interp(even, angle, y))) * 2.0 / len(even)
    orders = np.arange(1, ORDERS + 1)
    return [Line(name, orders.astype(float), waves[orders * turns])]


def longest_interval(mask: Any) -> NDArray[np.int64]:
    """Rows of the longest interval of a mask without a gap."""
    rows = np.flatnonzero(mask)
    return max(np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1), key=len)


def by_frequency(name: str, times: Array, y: Array) -> Line:
    """Amplitudes of sines under a Hann window: a sine between two frequencies has up to 15 % less."""
    window = np.hanning(len(y))
    waves = np.abs(np.fft.rfft((y - y.mean()) * window)) * 2.0 / window.sum()
    frequencies = np.fft.rfftfreq(len(y), float(times[1] - times[0])).astype(np.float64)
    return Line(name, *decimated(frequencies[1:], waves[1:]))


def peaks(chart: Chart, name: str, y: Array, mask: Any, value: Evaluate) -> list[Line]:
    """Largest absolute value for each value of the split."""
    split = value(chart.split)
    parts = np.unique(split[mask & np.isfinite(split)])
    return [Line(name, parts, np.array([np.max(np.abs(y[mask & (split == part)])) for part in parts]))]


def share(chart: Chart, name: str, y: Array, mask: Any, value: Evaluate) -> list[Line]:
    """Fraction of the rows with at most a value."""
    return [Line(name, *points) for points in cumulative(y[mask])]


def cumulative(values: Array) -> list[tuple[Array, Array]]:
    """Sorted values and the cumulative fraction; empty without a number."""
    found = np.sort(values[np.isfinite(values)])
    if not len(found):
        return []
    at = np.unique(np.linspace(0, len(found) - 1, MAX_POINTS).astype(int))
    return [(found[at], (at + 1) / len(found))]


def roc(name: str, y: Array, quiet: Any, sought: Any) -> list[Line]:
    """Fraction of event rows above a threshold over that of quiet rows, for all thresholds."""
    both = [np.sort(y[rows & np.isfinite(y)]) for rows in (quiet, sought)]
    if not all(map(len, both)):
        return []
    # from the largest down, and beyond both
    thresholds = np.append(np.unique(np.concatenate(both))[::-1], -np.inf)
    thresholds = thresholds[np.unique(np.linspace(0, len(thresholds) - 1, MAX_POINTS).astype(int))]
    return [Line(name, *(1.0 - np.searchsorted(each, thresholds, side="right") / len(each) for each in both))]


class Margin(NamedTuple):
    """Margin at a crossing: the factor of the gain, or the angle in rad; and its frequency."""

    frequency: float
    value: float


@dataclass(frozen=True)
class Response:
    """Gain (above 0) and phase (rad, without jumps) of an open loop over ascending frequencies above 0."""

    frequency: Array
    gain: Array
    phase: Array

    def dense(self) -> tuple[Array, Array, Array]:
        """Interpolated points: straight lines over the logarithm of the frequency."""
        given = np.log(self.frequency)
        dense = np.linspace(given[0], given[-1], DENSE * len(given), dtype=np.float64)
        gain = np.exp(np.interp(dense, given, np.log(self.gain)))
        return np.exp(dense), gain, np.interp(dense, given, self.phase)

    def phase_margin(self) -> Margin | None:
        """Minimum angle from the gain 1 to -180 degrees; None without a crossover."""
        frequency, gain, phase = self.dense()
        at = crossings(np.log(gain))
        found = [Margin(frequency[i], math.remainder(phase[i] - math.pi, 2.0 * math.pi)) for i in at]
        return min(found, key=lambda one: abs(one.value), default=None)

    def gain_margin(self) -> Margin | None:
        """Minimum factor above 1 from the gain at -180 degrees to 1; None without one."""
        frequency, gain, phase = self.dense()
        # the distance from -180 degrees jumps at half a revolution
        away = np.remainder(phase, 2.0 * np.pi) - np.pi
        at = [i for i in crossings(away) if abs(away[i]) < 0.5 * np.pi and gain[i] < 1.0]
        return min((Margin(frequency[i], 1.0 / gain[i]) for i in at), key=lambda one: one.value, default=None)

    def margins(self) -> Iterator[tuple[float, str]]:
        """Frequencies of the margins with their texts."""
        if phase := self.phase_margin():
            yield phase.frequency, f"phase margin {math.degrees(phase.value):.1f} degrees"
        if gain := self.gain_margin():
            yield gain.frequency, f"gain margin {gain.value:.2f} ({20.0 * math.log10(gain.value):.1f} dB)"


def crossings(values: Array) -> list[int]:
    """Return indices after which the sign changes."""
    return np.flatnonzero(np.diff(np.sign(values))).tolist()


def response(frequency: Array, gain: Array, phase: Array, closed: bool) -> Response | None:
    """Open loop of measured points; None without two of them.

    `closed`: gain and phase are those of the closed loop T. With the error desired minus measured,
    T = L / (1 + L), so the open loop is L = T / (1 - T), with every delay in it.
    """
    measured = gain * np.exp(1j * phase)
    with np.errstate(divide="ignore", invalid="ignore"):
        loop = measured / (1.0 - measured) if closed else measured
    known = np.isfinite(loop) & (np.abs(loop) > 0.0) & (frequency > 0.0)
    order = np.argsort(frequency[known])
    if len(order) < 2:
        return None
    loop = loop[known][order]
    turns = np.unwrap(np.angle(loop))
    # as it is drawn: from -360 degrees to 0 at the first frequency
    turns -= 2.0 * np.pi * math.ceil(turns[0] / (2.0 * np.pi))
    return Response(frequency[known][order], np.abs(loop).astype(np.float64), turns.astype(np.float64))
