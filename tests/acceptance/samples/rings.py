"""Samples of rings that were not used for tuning: from a seed, run on all cores, summarized in one line."""

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
Range = tuple[float, float]

SLACK = 0.3e-6
"""Allowed excess of the actual eccentricity of a centered ring over the tolerance, m."""
PROBE_AT_PUSHER = 0.02
NOISE = 2e-7
"""Configured noise of a measurement, m."""
FORM_ORDERS = (2, 20)
"""Waves per revolution of the added form."""
FEET = 0.85
"""Radius of the feet, in radii of the ring."""
RESAMPLES = 2000
LENGTHS = ("eccentricity", "measurement_error", "overshoot")


@dataclass(frozen=True)
class Rings:
    """A population of rings and machines; every pair is a range with even density.

    The friction of the ring is that of the paper, 0.15 to 0.25. The paper gives no initial eccentricity
    and no other property of its parts; the defaults are typical values.
    """

    mass: Range = (0.75, 1.5)
    """kg; even over the logarithm."""
    eccentricity: Range = (1e-4, 6e-4)
    """At the start, m."""
    radius: Range = (0.04, 0.09)
    """m."""
    mu_static: Range = (0.15, 0.25)
    mu_pusher: Range = (0.08, 0.20)
    lobes: tuple[float, float, float] = (3e-6, 3e-6, 1e-6)
    """Largest amplitudes of 2, 3 and 5 lobes, m."""
    speed: float = 20.0
    """rpm."""
    both_directions: bool = False
    radius_error: float = 0.0
    """The controller knows the radius within +- this, relative."""
    probe_error: float = 0.0
    """The controller knows the position of the probe relative to the pusher within +- this, m."""
    spindle_error: float = 0.0
    """Error motion of the spindle, m."""
    dirt: float = 0.0
    """Height of particles on 2 % of the circumference, m."""
    spikes: float = 0.0
    """Height of electrical spikes on 2 % of the samples, m."""
    form: float = 0.0
    """Largest amplitude of the added form, m: one order of 2 to 20, or all between two of these."""
    noise_factor: float = 1.0
    """The noise of a measurement is configured within this factor, in either direction."""

    def draw(self, seed: int) -> list[str]:
        """Return the overrides of a scenario for the ring of this seed."""
        random = np.random.default_rng(seed)
        mass = math.exp(random.uniform(*np.log(self.mass)))
        radius, eccentricity = random.uniform(*self.radius), random.uniform(*self.eccentricity)
        mu_static, mu_pusher = random.uniform(*self.mu_static), random.uniform(*self.mu_pusher)
        lobe_2, lobe_3, lobe_5 = random.uniform(0.0, self.lobes)
        radius_error, probe_error = random.uniform(-1.0, 1.0, 2) * (self.radius_error, self.probe_error)
        turning = -1.0 if self.both_directions and random.uniform() < 0.5 else 1.0
        values = {
            "loop.seed": seed,
            "plant.mass": mass,
            "plant.radius": radius,
            "plant.feet_radius": FEET * radius,
            "plant.eccentricity": eccentricity,
            "plant.mu_static": mu_static,
            "plant.pusher_friction": mu_pusher,
            "plant.lobe_2": lobe_2,
            "plant.lobe_3": lobe_3,
            "plant.lobe_5": lobe_5,
            "plant.spindle_speed": turning * self.speed * math.pi / 30.0,
            "plant.spindle_error": self.spindle_error,
            "plant.dirt_height": self.dirt,
            "plant.spike_height": self.spikes,
            "controller.ring.radius": radius * (1.0 + radius_error),
            "controller.probe.at_pusher": PROBE_AT_PUSHER + probe_error,
        }
        if self.form > 0.0:
            first, last = sorted(random.integers(*FORM_ORDERS, 2, endpoint=True))
            alone = random.uniform() < 0.5
            values |= {
                "plant.form": random.uniform(0.2 * self.form, self.form),
                "plant.form_first": float(first),
                "plant.form_last": float(first if alone else last),
                "controller.estimator.noise": NOISE * self.noise_factor ** random.uniform(-1.0, 1.0),
            }
        return [f"{key}={value}" for key, value in values.items()]


class Sample:
    """Outcomes of one population; the time of a ring that was not centered is infinite.

    Parameters
    ----------
    scenarios
        One for each ring.
    outcomes
        Their results.
    """

    def __init__(
        self, scenarios: Sequence[cosim.Scenario], outcomes: Sequence[cosim.Result | cosim.CosimError]
    ):
        self.seeds = [scenario.loop.seed for scenario in scenarios]
        self.outcomes = outcomes
        self.limit = scenarios[0].controller.parameters["tolerance"] + SLACK

    def metric(self, name: str) -> Array:
        """Metric of every ring, NaN where the run failed."""
        return np.array(
            [o.metrics[name].value if isinstance(o, cosim.Result) else math.nan for o in self.outcomes]
        )

    @cached_property
    def reported(self) -> NDArray[np.bool_]:
        """Whether the controller reported the ring as centered."""
        return np.equal(self.metric("centered"), 1.0)

    @cached_property
    def centered(self) -> NDArray[np.bool_]:
        """Whether it was reported as centered and is, within the slack."""
        near: NDArray[np.bool_] = self.metric("eccentricity") <= self.limit
        return self.reported & near

    @property
    def falsely(self) -> list[int]:
        """Seeds of the rings that were reported as centered and are not."""
        return self._seeds(self.reported & ~self.centered)

    @property
    def missed(self) -> list[int]:
        """Seeds of the rings that were not reported as centered."""
        return self._seeds(~self.reported)

    @cached_property
    def times(self) -> Array:
        """Time to center, s."""
        return np.where(self.centered, self.metric("time_to_center"), math.inf)

    def time(self, share: float) -> float:
        """Time in which `share` percent of the rings were centered, s."""
        return float(percentile(self.times, share))

    def worst(self, metric: str) -> float:
        """Largest magnitude of a metric among the rings that were reported as centered."""
        return float(np.max(np.abs(self.metric(metric)[self.reported]), initial=0.0))

    def _seeds(self, chosen: NDArray[np.bool_]) -> list[int]:
        return [seed for seed, is_chosen in zip(self.seeds, chosen, strict=True) if is_chosen]

    def reasons(self) -> list[str]:
        """Return the reason for every ring that was not centered."""
        return [
            f"seed {seed}: {reason(outcome)}"
            for seed, outcome, centered in zip(self.seeds, self.outcomes, self.centered, strict=True)
            if not centered
        ]

    def columns(self) -> dict[str, str]:
        """Return how many were centered, the times and the pushes; intervals are of 95 %."""
        low, high = share_interval(int(self.centered.sum()), len(self.centered))
        pushes = self.metric("pushes")[self.reported]
        return {
            "centered": f"{self.centered.sum()} of {len(self.centered)} ({low:.0f} .. {high:.0f} %)",
            "median": f"{self.time(50):.1f} s{interval_text(self.times, 50)}",
            "95 %": f"{self.time(95):.1f} s{interval_text(self.times, 95)}",
            "max": f"{self.time(100):.1f} s",
            "pushes": f"{percentile(pushes, 50):.0f} / {percentile(pushes, 95):.0f}",
            "falsely": str(len(self.falsely)),
        }

    def __str__(self) -> str:
        texts = [f"{name} {text}" for name, text in self.columns().items()]
        lengths = [f"{name} <= {1e6 * self.worst(name):.2f} um" for name in LENGTHS]
        return ", ".join([*texts, *lengths, f"wait <= {self.worst('wait'):.2f} revolutions"])


def sample(rings: Rings, seeds: Sequence[int], *changes: str, name: str = "centering") -> Sample:
    """Run a scenario with a ring for each seed; `changes` are overrides for all of them."""
    scenarios = [cosim.load(name, set=[*rings.draw(seed), *changes]) for seed in seeds]
    return Sample(scenarios, cosim.run_each(scenarios, WORKERS))


def reason(outcome: cosim.Result | cosim.CosimError) -> str:
    """Why a ring was not centered."""
    if isinstance(outcome, cosim.CosimError):
        return outcome.message
    left = f"{1e6 * outcome.metrics['eccentricity'].value:.2f} um remaining"
    if outcome.metrics["centered"].value:
        return f"reported as centered, {left}"
    names = {number: name for name, number in outcome.items["controller.fault"].items()}
    return f"fault `{names[int(outcome.metrics['fault_code'].value)]}`, {left}"


def percentile(values: Array, share: float) -> Any:
    """Percentile `share` of the values; always a value of the sample, so that infinity is possible."""
    return np.percentile(values, share, method="inverted_cdf") if len(values) else math.nan


def interval_text(values: Array, share: float) -> str:
    """Bootstrap interval of 95 % of a percentile; the largest value has none."""
    if share == 100 or len(values) < 10:
        return ""
    picks = np.random.default_rng(1).integers(len(values), size=(RESAMPLES, len(values)))
    found = np.percentile(values[picks], share, axis=1, method="inverted_cdf")
    return " ({:.1f} .. {:.1f})".format(*np.percentile(found, (2.5, 97.5), method="inverted_cdf"))


def share_interval(hits: int, count: int) -> Range:
    """Wilson's interval of 95 % for a ratio, in percent."""
    z, share = 1.96, hits / count
    middle = share + z * z / (2 * count)
    half = z * math.sqrt(share * (1.0 - share) / count + z * z / (4 * count * count))
    scale = 100.0 / (1.0 + z * z / count)
    return scale * (middle - half), scale * (middle + half)
