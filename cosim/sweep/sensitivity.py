"""Sensitivity of each metric to each varied key: rank correlation, and Sobol indices if possible.

Sobol indices divide the variance of a metric among the keys. The first-order index is the fraction that
vanishes if one key is known, `S_i = V[E[f | x_i]] / V[f]`; the total index the fraction that remains if all
others are known, `T_i = E[V[f | all but x_i]] / V[f]`. They follow from two independent sets of points,
A and B, and for each key the set A with the values of that key from B (AB_i). As f(B) and f(AB_i) share only
x_i, their covariance is V[E[f | x_i]]; as f(A) and f(AB_i) share all but x_i, half the mean square of their
difference is E[V[f | all but x_i]].

Saltelli et al. (2010), Variance based sensitivity analysis of model output, Comput. Phys. Commun. 181.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.formatting.strict import plain
from cosim.study.store import DONE
from cosim.sweep.designs import generator
from cosim.sweep.export import Table
from cosim.sweep.plan import Plan

Array = NDArray[np.float64]

FEWEST_CASES = 10
"""Minimum number of cases with a result; with fewer the interval would be nearly -1 .. 1."""
RESAMPLES = 400
"""Number of bootstrap samples; the ends of a 95 % interval are then accurate to a tenth of its width."""
INTERVAL = (0.025, 0.975)
NORMAL_95 = 1.959964
"""Half width of the 95 % interval of a normal distribution, in standard deviations."""


@dataclass(frozen=True)
class Sensitivity:
    """Effect of one key on one metric."""

    metric: str
    key: str
    rank: Estimate
    """Rank correlation (Spearman), -1 .. 1: how monotonic the metric is in the key."""
    first: Estimate | None = None
    total: Estimate | None = None
    """Sobol indices; None if the design has none."""

    @property
    def strength(self) -> float:
        """Sort key: the total index, otherwise the absolute rank correlation."""
        value = abs(self.rank.value) if self.total is None else self.total.value
        return value if math.isfinite(value) else -1.0

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data for JSON."""
        found: dict[str, Any] = plain(asdict(self))
        return {name: value for name, value in found.items() if value is not None}


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % confidence interval."""

    value: float
    low: float
    high: float


UNKNOWN = Estimate(math.nan, math.nan, math.nan)


def sensitivities(plan: Plan, table: Table) -> list[Sensitivity]:
    """Effect of every varied number on every metric that varies, the strongest key of a metric first.

    Empty with too few results.
    """
    # the repeats of a case share its values: counted one by one, noise would look like an effect
    lines: dict[int, list[int]] = defaultdict(list)
    for line, (case, status) in enumerate(zip(table["case"], table["status"], strict=True)):
        if status in DONE:
            lines[case].append(line)
    if len(lines) < FEWEST_CASES:
        return []
    keys = {key: column for key in plan.varying if varies(column := means(table[key], lines))}
    names = [metric.name for metric in plan.scenario.metric]
    metrics = {name: column for name in names if varies(column := means(table[f"metric.{name}"], lines))}
    found = []
    for metric, values in metrics.items():
        indices = sobol_of(plan, dict(zip(lines, values, strict=True)))
        correlations = {key: rank(column, values) for key, column in keys.items()}
        effects = [
            Sensitivity(metric, key, value, *indices.get(key, ())) for key, value in correlations.items()
        ]
        found += sorted(effects, key=lambda effect: -effect.strength)
    return found


def means(column: Sequence[Any], lines: Mapping[int, Sequence[int]]) -> Array:
    """Mean of the finite numbers of each case; NaN for texts and without a number."""
    known = [isinstance(value, int | float) and math.isfinite(value) for value in column]
    numbers = [[column[line] for line in own if known[line]] for own in lines.values()]
    return np.array([math.fsum(own) / len(own) if own else math.nan for own in numbers])


def varies(column: Array) -> bool:
    """Whether a column has different finite numbers."""
    return np.unique(column[np.isfinite(column)]).size > 1


def rank(x: Array, y: Array) -> Estimate:
    """Rank correlation of the cases with two finite values.

    Its interval is that of Bonett and Wright (2000): `artanh r` is normal with the variance
    `(1 + r^2 / 2) / (n - 3)`.
    """
    both = np.isfinite(x) & np.isfinite(y)
    count = int(np.sum(both))
    if count < FEWEST_CASES or not varies(x[both]) or not varies(y[both]):
        return UNKNOWN
    value = float(np.clip(np.corrcoef(ranks(x[both]), ranks(y[both]))[0, 1], -1.0, 1.0))
    half = NORMAL_95 * math.sqrt((1.0 + value**2 / 2.0) / (count - 3))
    # 1 is where artanh is infinite
    middle = math.atanh(math.copysign(min(abs(value), 1.0 - 1e-12), value))
    return Estimate(value, math.tanh(middle - half), math.tanh(middle + half))


def ranks(column: Array) -> Array:
    """Rank of each number, from 1; equal numbers have their mean rank."""
    # as scipy.stats.rankdata, whose import takes longer than a short sweep
    _, group, sizes = np.unique(column, return_inverse=True, return_counts=True)
    means: Array = np.cumsum(sizes) - (sizes - 1) / 2
    return means[group]


def sobol_of(plan: Plan, means: Mapping[int, float]) -> dict[str, tuple[Estimate, Estimate]]:
    """Sobol indices of a metric by key, from its means by case; only complete samples count."""
    if plan.study.design.kind != "saltelli":
        return {}
    keys = [vary.key for vary in plan.study.vary]
    table = np.array([means.get(case, math.nan) for case in range(len(plan.cases))])
    table = table.reshape((-1, len(keys) + 2))
    table = table[np.all(np.isfinite(table), axis=1)]
    if len(table) < FEWEST_CASES:
        return {}
    return dict(zip(keys, sobol(table, plan.study.seed), strict=True))


def sobol(table: Array, seed: int) -> list[tuple[Estimate, Estimate]]:
    """First-order and total indices of each key, with bootstrap intervals.

    `scipy.stats.sobol_indices` gives the same indices, but takes no number of samples other than powers of
    two, which one lost run breaks, and no seed for its intervals. The table has the values at the points of a
    design `saltelli`, shape (samples, keys + 2): f(A), f(B), f(AB_1), ...
    """
    rows = generator(seed).integers(len(table), size=(RESAMPLES, len(table)))
    ends = np.nanquantile([indices(table[row]) for row in rows], INTERVAL, axis=0)
    parts = np.stack([indices(table), *ends], axis=-1)
    first, total = ([Estimate(*key) for key in order] for order in parts.tolist())
    return list(zip(first, total, strict=True))


def indices(table: Array) -> Array:
    """First-order and total indices of each key, shape (2, keys)."""
    a, b, mixed = table[:, 0], table[:, 1], table[:, 2:].T
    # less scatter than with the values as they are
    b = b - np.mean(table[:, :2])
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.mean([b * (mixed - a), 0.5 * np.square(a - mixed)], axis=-1)
        fractions: Array = parts / np.var(table[:, :2])
    return fractions
