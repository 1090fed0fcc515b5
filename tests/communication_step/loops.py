"""The five closed loops with the quality number of each."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from cosim import Result


def value(result: Result, metric: str) -> float:
    """Value of a metric."""
    return float(result.metrics[metric].value)


@dataclass(frozen=True)
class Loop:
    """One closed loop.

    Parameters
    ----------
    name
        Its controller and the heading of its table.
    scenario
        The scenario that is run.
    period
        Sample period of the controller, s.
    timestep
        The plant's own step, s; a shorter one is taken where it does not fill the communication step.
    number
        Quality, the smaller the better, in `unit`, from the ground truth of the plant.
    is_done
        Whether the cycle ended as it should.
    seeds
        Runs of a cell; the worst counts.
    what
        What the number is.
    remark
        What the machine makes of a longer or shorter step, empty if nothing.
    """

    name: str
    scenario: str
    period: float
    timestep: float
    number: Callable[[Result], float]
    unit: str
    is_done: Callable[[Result], bool]
    seeds: int
    what: str
    remark: str = ""


def scaled(metric: str, factor: float, result: Result) -> float:
    """Value of a metric in another unit."""
    return value(result, metric) * factor


def holds(metric: str, result: Result) -> bool:
    """Whether a metric that is 0 or 1 is 1."""
    return bool(value(result, metric))


def contact_found(result: Result) -> bool:
    """Whether the contact was found, and not before the touch."""
    return holds("done", result) and not holds("early", result)


def force_error(result: Result) -> float:
    """Root mean square of the true force about the set one, N."""
    return math.hypot(value(result, "force_mean") - 5.0, value(result, "force_std"))


def finish_error(result: Result) -> float:
    """Higher of the burr that is left and deeper of the gouges, um."""
    return max(value(result, "finish_high"), -value(result, "finish_low")) * 1e6


LOOPS = (
    Loop(
        "dob", "dob", 1e-4, 5e-5, partial(scaled, "depth", 1e9), "nm", contact_found, 5,
        "travel of the slide beyond the first possible touch",
    ),
    Loop(
        "centering", "centering", 1e-3, 1e-4, partial(scaled, "eccentricity", 1e6), "um",
        partial(holds, "centered"), 3, "final actual eccentricity",
        "The servo of the plant continues at the set velocity for 1 ms (`setpoint_period`), then stops, as "
        "a motion board does whose controller is late.",
    ),
    Loop(
        "fts", "fts", 1e-4, 2e-5, partial(scaled, "tip", 1e6), "um", partial(holds, "good"), 2,
        "true error of the tool, rms over five revolutions",
    ),
    Loop(
        "polish", "polish", 1e-3, 1e-4, force_error, "N", partial(holds, "done"), 2,
        "deviation of the true normal force from 5 N, rms",
        "A pulse lasts one sample. Of a step with several samples the importing tool receives only the last "
        "and loses the others. The drives distribute them over 1 ms (`pulse_period`).",
    ),
    Loop(
        "deburr", "deburr/learn", 1e-2, 1e-3, finish_error, "um", partial(holds, "good"), 1,
        "remaining burr or gouge, after learning in the same loop",
        "A bank that was learned with another `io_delay` is rejected, so every cell learns its own.",
    ),
)  # fmt: skip
