"""Frequency responses: an open loop with its crossover and margins, also derived from a closed loop."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cosim.trace.columns import Array

DENSE = 200
"""Number of interpolated points per measured one, for crossings."""


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
