"""The beginning of a scenario."""

from __future__ import annotations

import cosim
from cosim.scenario.model import Scenario


def part(name: str, longest: int) -> Scenario:
    """Load a scenario that ends after at most `steps` steps."""
    loop = cosim.load(name).loop
    return cosim.load(name, set=[f"loop.duration={min(loop.steps, longest) * loop.step!r}"])
