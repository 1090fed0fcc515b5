"""Random burr of a casting: height and thickness along its edge."""

import math

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from plants.cylindrical_robot_parameters import CylindricalRobotParameters

Array = NDArray[np.float64]

# the bell over which the burr is smooth ends here, in correlation lengths
REACH = 3.0


def draw(p: CylindricalRobotParameters, length: float, random: Generator) -> tuple[Array, Array]:
    """Height and thickness of every bin of a burr `length` m long, m.

    Both are uniform between their limits at every point, smooth over the correlation length (Gaussian
    copula), and independent of each other. In a gap the height is 0.
    """
    count = max(round(length / p.burr_pitch), 1)
    smooth = p.burr_correlation / p.burr_pitch
    thickness = p.burr_thickness_least + _uniform(count, smooth, random) * (
        p.burr_thickness_most - p.burr_thickness_least
    )
    height = p.burr_height_least + _uniform(count, smooth, random) * (
        p.burr_height_most - p.burr_height_least
    )
    place = p.burr_pitch * np.arange(count)
    for _ in range(random.integers(0, int(p.burr_gaps) + 1)):
        gap = random.uniform(p.burr_gap_least, p.burr_gap_most)
        begin = random.uniform(0.0, max(length - gap, 0.0))
        height[(place >= begin) & (place < begin + gap)] = 0.0
    return height, thickness


def _uniform(count: int, smooth: float, random: Generator) -> Array:
    """Generate uniform numbers from 0 to 1 with a correlation length of `smooth` points."""
    # white noise under a bell of this width is correlated as exp(-(d / smooth)^2)
    reach = max(round(REACH * smooth), 1)
    bell = [math.exp(-2.0 * (place / smooth) ** 2) for place in range(-reach, reach + 1)]
    size = math.sqrt(math.fsum(share**2 for share in bell))
    white, normal = random.standard_normal(count + 2 * reach), np.zeros(count)
    # tap by tap: without BLAS, whose last bit depends on the processor, and in the memory of the noise
    for tap, share in enumerate(bell):
        normal += (share / size) * white[tap : tap + count]
    return np.array([0.5 * (1.0 + math.erf(value / math.sqrt(2.0))) for value in normal])
