"""Off-nominal robots and molds, sampled from a seed, and the quality of a polishing run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cosim

from .runs import WORKERS

Array = NDArray[np.float64]
Columns = Any
Changes = tuple[str, ...]

RAMP = 0.3
"""Time after the start of the feed from which forces and errors are evaluated, s."""
WINDOW = 50
"""Samples over which position errors are averaged: a multiple of the period of the stick-slip motion."""


def drawn(seed: int) -> Changes:
    """Sample a robot and a mold; the controller keeps its values."""
    random = np.random.default_rng(seed)
    direction, lean = random.normal(size=3), random.uniform(0.0, math.tau)
    shift = random.uniform(0.0, 1e-4) * direction / np.linalg.norm(direction)
    tilt = random.uniform(0.0, math.radians(2.0))
    plant = {
        "tip_stiffness": random.uniform(100e3, 300e3),
        "friction": random.uniform(0.1, 0.4),
        "shift_x": shift[0],
        "shift_y": shift[1],
        "shift_z": shift[2],
        "tilt_x": tilt * math.cos(lean),
        "tilt_y": tilt * math.sin(lean),
        "drive_gain": random.uniform(0.8, 1.2),
        "drive_friction": random.uniform(0.5, 4.0),
    }
    return (f"loop.seed={seed}", *(f"plant.{name}={float(number)!r}" for name, number in plant.items()))


@dataclass(frozen=True)
class Run:
    """One polishing run; forces are true normal forces unless stated otherwise."""

    result: cosim.Result
    target: float = 5.0

    @cached_property
    def rows(self) -> Columns:
        """Trace of the run."""
        assert self.result.trace is not None
        return self.result.trace

    def during(self, state: str) -> NDArray[np.bool_]:
        """Rows in which the controller is in a state."""
        here: NDArray[np.bool_] = (
            self.rows["controller.state"] == self.result.items["controller.state"][state]
        )
        return here

    @cached_property
    def follow(self) -> NDArray[np.bool_]:
        """Evaluated rows: the path is followed, and the feed has started."""
        here = self.during("Follow")
        begin = self.rows["time"][here][0] if here.any() else math.inf
        counted: NDArray[np.bool_] = here & (self.rows["time"] > begin + RAMP)
        return counted

    @cached_property
    def force(self) -> Array:
        """True normal force in the evaluated rows, N."""
        force: Array = self.rows["plant.contact_force"][self.follow]
        return force

    @property
    def fault(self) -> str:
        """Name of the last fault."""
        names = {number: name for name, number in self.result.items["controller.fault"].items()}
        return names[int(self.rows["controller.fault"][-1])]

    @property
    def done(self) -> bool:
        """Whether the path was polished to its end."""
        return bool(self.during("Done")[-1]) and self.fault == "None"

    @property
    def settle(self) -> float:
        """From the first touch to the start of the feed, s."""
        return float(self.result.metrics["settle"].value)

    @property
    def overshoot(self) -> float:
        """Largest force above the target before the feed starts, N."""
        return float(self.rows["plant.contact_force"][self.during("Settle")].max() - self.target)

    @property
    def force_error(self) -> float:
        """Force error of the controller, rms, N."""
        return rms(self.rows["controller.force.error"][self.follow])

    @property
    def least(self) -> float:
        """Smallest force from the start of the feed, N."""
        return float(self.rows["plant.contact_force"][self.during("Follow")].min())

    @property
    def lateral(self) -> float:
        """Error along and across the path by the encoders, averaged over 50 ms, rms, m."""
        window = np.full(WINDOW, 1.0 / WINDOW)
        means = [
            np.convolve(self.rows[f"controller.error.{name}"][self.follow], window, "valid")
            for name in ("tangential", "lateral")
        ]
        return rms(np.hypot(*means))

    @property
    def gain(self) -> float:
        """Sliding distance of the ball in contact over the length of its path."""
        here = self.during("Follow")
        path = np.linalg.norm(
            np.diff([self.rows[f"controller.desired.{axis}"][here] for axis in "xyz"]), axis=0
        )
        slid = self.rows["plant.slid"][here]
        return float((slid[-1] - slid[0]) / path.sum())

    def last(self, output: str) -> float:
        """Value of an output at the end."""
        return float(self.rows[f"controller.{output}"][-1])

    def __str__(self) -> str:
        if not self.follow.any():
            return f"fault `{self.fault}` before the feed"
        return (
            f"{'done' if self.done else self.fault}, settle {self.settle:.3f} s, "
            f"over {self.overshoot:.2f} N, N {self.force.mean():.2f} +- {self.force.std():.3f} "
            f"({self.force.min():.2f} .. {self.force.max():.2f}), minimum {self.least:.2f} N, "
            f"rms {self.force_error:.3f} N, lateral {1e6 * self.lateral:.1f} um, gain {self.gain:.2f}"
        )


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def polish(name: str, *changes: str, seed: int | None = None) -> Run:
    """Run one scenario with overrides."""
    return Run(cosim.run(cosim.load(name, set=changes), seed, engine="native"))


def sample(name: str, seeds: Sequence[int], *changes: str) -> list[Run]:
    """Run a scenario with a robot and a mold for each seed; `changes` are overrides for all of them."""
    scenarios = [cosim.load(name, set=[*drawn(seed), *changes]) for seed in seeds]
    outcomes = cosim.run_each(scenarios, WORKERS, keep_trace=True)
    failed = [outcome for outcome in outcomes if isinstance(outcome, cosim.CosimError)]
    assert not failed, failed[0].message
    return [Run(outcome) for outcome in outcomes if isinstance(outcome, cosim.Result)]


def worst(runs: Sequence[Run]) -> str:
    """Summarize the worst values of the runs."""
    found = {
        "settle": max(run.settle for run in runs),
        "over": max(run.overshoot for run in runs),
        "sd median": float(np.median([run.force.std() for run in runs])),
        "sd": max(float(run.force.std()) for run in runs),
        "rms": max(run.force_error for run in runs),
        "minimum": min(run.least for run in runs),
        "maximum": max(float(run.force.max()) for run in runs),
        "lateral um": 1e6 * max(run.lateral for run in runs),
        "gain minimum": min(run.gain for run in runs),
    }
    return f"{sum(run.done for run in runs)} of {len(runs)} done; " + ", ".join(
        f"{name} {value:.3f}" for name, value in found.items()
    )
