"""Contours of round parts as samples of one revolution: lobes, roughness and dirt."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

SAMPLES = 8192
"""Number of samples per revolution."""
ANGLES: NDArray[np.float64] = np.linspace(0.0, 2.0 * math.pi, SAMPLES, endpoint=False, dtype=np.float64)
"""Their angles, rad."""


def lobed(radius: float, waves: Mapping[int, float], random: Generator) -> NDArray[np.float64]:
    """Radius of a part with `waves` (amplitude by number of waves per revolution) and random phases."""
    contour = np.full(SAMPLES, radius)
    for count, amplitude in waves.items():
        contour += amplitude * np.cos(count * ANGLES + random.uniform(0.0, 2.0 * math.pi))
    return contour


def dirty(radius: float, height: float, width: float, share: float, random: Generator) -> NDArray[np.float64]:
    """Height of particles on a part: round bumps at random positions on a fraction of the circumference."""
    contour = np.zeros(SAMPLES)
    count = math.ceil(share * 2.0 * math.pi * radius / width)
    for place in random.uniform(0.0, 2.0 * math.pi, count):
        distance = radius * np.abs((ANGLES - place + math.pi) % (2.0 * math.pi) - math.pi)
        bump = 0.5 * height * (1.0 + np.cos(2.0 * math.pi * distance / width))
        np.maximum(contour, np.where(distance < 0.5 * width, bump, 0.0), out=contour)
    return contour
