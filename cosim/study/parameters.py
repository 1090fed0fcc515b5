"""Common parts of studies and optimizations: one scenario and its varied keys."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import NormalDist
from typing import Any, Literal, NoReturn

from cosim import paths
from cosim.errors import ScenarioError
from cosim.pool.limits import MAX_MEMORY, Limits
from cosim.scenario.ranges import FINITE, NOT_NAN, NOT_NEGATIVE_COUNT, POSITIVE, limited
from cosim.scenario.tables import Fail

MEMORY = {**POSITIVE, "maximum": MAX_MEMORY / 1e6, "demand": f"be positive and at most {MAX_MEMORY / 1e6:g}"}
MAX_OF_UNIT = math.nextafter(1.0, 0.0)
MAX_EXACT = 2.0**53
"""Maximum integer up to which 64-bit floats are exact."""


@dataclass(frozen=True)
class Vary:
    """One key and its values: `values`, or a range with its distribution.

    Parameters
    ----------
    key
        Key of the scenario, as for `--set`.
    values
        Values; sampled with equal probability unless the design is a grid.
    minimum, maximum
        Ends of the range; for `normal` the truncation.
    points
        Number of values of the range in a grid, both ends included.
    distribution
        Between the ends; in a grid `log-uniform` is a geometric series.
    mean, deviation
        Mean and standard deviation of `normal`, before the truncation.
    integer
        Whether values are integers.
    """

    key: str
    values: tuple[Any, ...] = ()
    minimum: float | None = limited(NOT_NAN, None)
    maximum: float | None = limited(NOT_NAN, None)
    points: int | None = None
    distribution: Literal["uniform", "log-uniform", "normal"] = "uniform"
    mean: float | None = limited(FINITE, None)
    deviation: float | None = limited(POSITIVE, None)
    integer: bool = False

    @property
    def range(self) -> tuple[float, float]:
        """Both ends; infinite if not given."""
        low = -math.inf if self.minimum is None else self.minimum
        return low, math.inf if self.maximum is None else self.maximum


@dataclass(frozen=True)
class RunLimits:
    """Limits of one run: wall time in s, memory of its process in MB, and whether it has its own process."""

    timeout: float = limited(POSITIVE, 600.0)
    memory: float | None = limited(MEMORY, None)
    process_per_run: bool = False

    def of_workers(self) -> Limits:
        """Return them for workers."""
        memory = None if self.memory is None else 1e6 * self.memory
        return Limits(self.timeout, memory, self.process_per_run)


@dataclass(frozen=True, kw_only=True)
class VariedScenario:
    """A scenario, by name or as a file relative to this one, that runs with varied keys.

    Parameters
    ----------
    seed
        Seed of the random values.
    set
        Values of keys in all runs.
    vary
        Varied keys with their values.
    limits
        Limits of a run.
    """

    scenario: str
    title: str = ""
    description: str = ""
    seed: int = limited(NOT_NEGATIVE_COUNT, 1)
    set: dict[str, Any] = field(default_factory=dict)
    vary: tuple[Vary, ...] = ()
    limits: RunLimits = RunLimits()
    file: Path = field(default=Path(), metadata={"key": ""})

    @property
    def name(self) -> str:
        """Stem of the file."""
        return self.file.stem

    @property
    def full_title(self) -> str:
        """Title, otherwise the name."""
        return self.title or self.name


def failing(file: Path) -> Fail:
    """Return the function that raises the error of a key in a file."""

    def fail(key: str, problem: str, hint: str = "") -> NoReturn:
        raise ScenarioError(f"`{paths.shown(file)}`: `{key}` {problem}", hint)

    return fail


def check_ranges(varied: VariedScenario, kind: str, fail: Fail) -> None:
    """Check that each key is given once, and its range; `kind` is the design."""
    keys = [*varied.set, *(vary.key for vary in varied.vary)]
    for index, vary in enumerate(varied.vary):
        if vary.key in keys[: len(varied.set) + index]:
            fail(f"vary[{index}].key", f"= `{vary.key}` is given twice", "Set each key once.")
        check_values(vary, f"vary[{index}]", kind, fail)


def check_values(vary: Vary, key: str, kind: str, fail: Any) -> None:
    """Check that values, range and distribution of one key agree."""
    if vary.values:
        for name in ("minimum", "maximum", "points", "mean", "deviation", "distribution", "integer"):
            if getattr(vary, name) != getattr(Vary, name):
                fail(f"{key}.{name}", "cannot be used with `values`", "Give values or a range.")
        return
    low, high = vary.range
    if not low < high:
        fail(f"{key}.maximum", f"is `{high}`, it must be above `minimum` = `{low}`")
    normal = vary.distribution == "normal"
    if normal != (vary.mean is not None and vary.deviation is not None):
        problem = f"is `{vary.distribution}`; `mean` and `deviation` belong to `normal`, both of them"
        fail(f"{key}.distribution", problem)
    ends = [end for end in (low, high) if math.isfinite(end)]
    if not normal and len(ends) < 2:
        fail(key, f"needs `minimum` and `maximum` of `{vary.key}`, both finite")
    if len(ends) == 2 and not math.isfinite(high - low):
        fail(key, f"is `{low}` .. `{high}`, whose width is too large")
    if vary.distribution == "log-uniform" and low <= 0.0:
        fail(f"{key}.minimum", f"is `{low}`; a logarithmic range must start above 0")
    if vary.integer and not all(end.is_integer() for end in ends):
        fail(f"{key}.integer", f"is true, but `{low}` .. `{high}` does not end at integers")
    if vary.integer and any(abs(end) > MAX_EXACT for end in ends):
        problem = f"is true, but beyond {MAX_EXACT:.0f} not every number of `{low}` .. `{high}` is one"
        fail(f"{key}.integer", problem)
    if (kind == "grid") != (vary.points is not None):
        fail(f"{key}.points", "belongs to a range in a `grid`, and only there")
    if vary.points is not None and (vary.points < 2 or normal):
        fail(f"{key}.points", f"is `{vary.points}`; a grid needs at least 2 points of a bounded range")


def value_at(vary: Vary, share: float) -> Any:
    """Quantile `share` of the distribution of a key; 0 and 1 are the ends of its range."""
    if vary.values:
        return vary.values[int(min(share, MAX_OF_UNIT) * len(vary.values))]
    low, high = vary.range
    if vary.distribution == "normal":
        value = normal_at(vary, share)
    elif vary.distribution == "log-uniform":
        value = math.exp(math.log(low) + share * (math.log(high) - math.log(low)))
    elif vary.integer:
        # every integer of the range is equally likely
        return int(low) + int(min(share, MAX_OF_UNIT) * (int(high) - int(low) + 1))
    else:
        value = low + share * (high - low)
    value = min(max(value, low), high)
    return round(value) if vary.integer else value


def normal_at(vary: Vary, share: float) -> float:
    """Value of a truncated normal distribution."""
    mean, deviation = vary.mean or 0.0, vary.deviation or 0.0
    low, high = vary.range
    if low > mean:
        # probabilities close to 1 have lost their digits, those of the mirrored range have not
        mirrored = replace(vary, minimum=2.0 * mean - high, maximum=2.0 * mean - low)
        return 2.0 * mean - normal_at(mirrored, 1.0 - share)
    # `NormalDist.cdf` has no digits either, far below the mean
    below, up_to = (0.5 * math.erfc((mean - end) / (math.sqrt(2.0) * deviation)) for end in (low, high))
    tiny = 1e-300
    return NormalDist(mean, deviation).inv_cdf(min(max(below + share * (up_to - below), tiny), MAX_OF_UNIT))
