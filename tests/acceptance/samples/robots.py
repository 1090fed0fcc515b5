"""Robots and castings from seeds that were not used for tuning; patterns learned on the same robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import cosim

from .runs import WORKERS, value

Changes = tuple[str, ...]
Array = NDArray[np.float64]

# these seeds were not used for tuning
MACHINES = tuple(range(71_001, 71_011))
BURRS = tuple(range(72_001, 72_051))

BAND = (-0.5e-3, 1.0e-3)
"""Finishing accuracy of castings for cars, m (paper)."""
STALLED = 16_000.0
"""Tool speed below which a run has failed, rpm (default; see `limits.spindle_speed_min`)."""

DELAYS: dict[int, Changes] = {
    0: ("loop.compute_delay=0", "controller.io_delay=0"),
    1: ("loop.compute_delay=1", "controller.io_delay=1"),
}
"""Samples between a command and its action, for plant and controller."""
PLAIN: dict[int, Changes] = {
    0: ("controller.law='Paper'",),
    1: (
        "controller.expert.learn.law='Plain'",
        "controller.expert.learn.lead=0",
        "controller.expert.lookup.preview=0",
    ),
}
"""The published control law; with a delay it keeps the best repetition, which the printed one does not."""


def errors(result: cosim.Result) -> tuple[float, float]:
    """Largest errors of the axes 1 and 3 at the tip, m."""
    return value(result, "error_1"), value(result, "error_3")


def machine(case: int, spread: float = 0.2) -> Changes:
    """Sample a robot, its drives within a spread, its tool and the hardness of its castings."""
    random = np.random.default_rng(case)
    values = {
        "drive_gain": random.uniform(1.0 - spread, 1.0 + spread),
        "drive_frequency": 280.0 * random.uniform(1.0 - spread, 1.0 + spread),
        "payload": random.uniform(3.0, 8.0),
        "spindle_time": random.uniform(0.1, 0.25),
        "cutting_pressure": 9e8 * random.uniform(0.8, 1.8),
    }
    return tuple(f"plant.{name}={float(value)!r}" for name, value in values.items())


def learning(bank: Path, *changes: str, speed: float = 0.1, repetitions: int = 19) -> cosim.Scenario:
    """Scenario that learns five speeds in air and writes the patterns to a bank."""
    # a repetition of five speeds takes 45.7 s at 100 mm/s, 15.6 s of them during the return and at rest
    duration = round((30.1 * 0.1 / speed + 15.6) * (repetitions + 1) * 1.01 + 5.0, 2)
    settings = (
        f"loop.duration={duration}",
        'loop.stop_when=\'controller.state == "Done" or controller.state == "Fault"\'',
        "signal.controller.mode.times=[0.0]",
        "signal.controller.mode.values=['Learn']",
        "signal.plant.workpiece.times=[0.0]",
        "signal.plant.workpiece.values=[0.0]",
        "controller.expert.learn.law='LeadFilter'",
        "controller.expert.learn.identify=false",
        "controller.expert.learn.tolerance=0.0",
        "controller.expert.learn.decrease=0.0",
        f"controller.learn.repetitions={repetitions}",
        f"controller.bank.export='{bank}'",
    )
    return cosim.load("deburr/learn", set=[*settings, *changes])


def learn(bank: Path, *changes: str, speed: float = 0.1, repetitions: int = 19) -> cosim.Result:
    """Learn, and check that all speeds were learned and written."""
    result = cosim.run(learning(bank, *changes, speed=speed, repetitions=repetitions), engine="native")
    assert result.trace is not None
    assert result.trace["controller.learn.done"][-1] == 1.0
    assert bank.exists()
    return result


@dataclass(frozen=True)
class Sample:
    """Outcomes of castings, lengths in m and speeds in rpm."""

    seeds: tuple[int, ...]
    results: tuple[cosim.Result, ...]

    def metric(self, name: str) -> Array:
        """Metric of every casting."""
        return np.array([result.metrics[name].value for result in self.results])

    @property
    def good(self) -> NDArray[np.bool_]:
        """Whether the finish is in the band, and the tool kept its speed."""
        low, high = BAND
        finished: NDArray[np.bool_] = np.equal(self.metric("good"), 1.0)
        inside = (self.metric("finish_low") >= low) & (self.metric("finish_high") <= high)
        return finished & inside & (self.metric("spindle") > STALLED)

    def __str__(self) -> str:
        errors = [1e3 * self.metric(f"error_{axis}") for axis in (1, 3)]
        feed, slowest = 1e3 * self.metric("feed"), 1e3 * self.metric("feed_low")
        return (
            f"{self.good.sum()} of {len(self.good)} good; e1 median {np.median(errors[0]):.3f}, "
            f"most {errors[0].max():.3f}, e3 most {errors[1].max():.3f} mm; "
            f"finish {1e3 * self.metric('finish_low').min():+.3f} to "
            f"{1e3 * self.metric('finish_high').max():+.3f} mm; feed mean {feed.mean():.1f} "
            f"({slowest.min():.1f}) mm/s; tool >= {self.metric('spindle').min():.0f} rpm"
        )


def sample(seeds: Sequence[int], *changes: str, name: str = "deburr") -> Sample:
    """Deburr a casting for each seed on one machine."""
    results = cosim.run_many(cosim.load(name, set=changes), seeds, workers=WORKERS)
    return Sample(tuple(seeds), tuple(results))


def joined(samples: Sequence[Sample]) -> Sample:
    """All castings of several machines."""
    seeds = tuple(seed for part in samples for seed in part.seeds)
    return Sample(seeds, tuple(result for part in samples for result in part.results))
