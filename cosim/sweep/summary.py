"""Summary of the rows of a sweep: counts, success rate, distributions."""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.formatting.quantity import text
from cosim.formatting.strict import plain
from cosim.formatting.verdicts import STATUSES
from cosim.study.store import DONE, Row, Store
from cosim.sweep.export import Table
from cosim.sweep.plan import Plan
from cosim.sweep.sensitivity import NORMAL_95, Sensitivity, sensitivities
from cosim.units import restored

QUANTILES = {"minimum": 0.0, "median": 0.5, "95 %": 0.95, "99 %": 0.99, "maximum": 1.0}
RANDOM = ("latin-hypercube", "sobol", "monte-carlo")
"""Designs whose cases are a random sample of the ranges."""


@dataclass
class Summary:
    """Counts and numbers of a sweep."""

    runs: int
    """Runs of the study."""
    samples: int = 0
    """Independent random samples with a row; 0 if the runs are none, as those of a grid."""
    columns: Table = field(default_factory=dict)
    """Table of all rows; see `locations`."""
    statuses: Counter[str] = field(default_factory=Counter)
    """Number of runs by status."""
    values: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    """Values of each metric, of the runs with a result."""
    units: dict[str, str] = field(default_factory=dict)
    """Units of the metrics."""
    held: Counter[str] = field(default_factory=Counter)
    """Number of results that passed each criterion."""
    troubles: dict[tuple[str, str], tuple[int, int]] = field(default_factory=dict)
    """Status and reason of runs without result: count and first run."""
    sensitivities: list[Sensitivity] = field(default_factory=list)
    """Effects of the varied keys on the metrics."""

    def count(self, status: str, reason: str, run: int) -> None:
        """Count a run by its status, and by the reason if it has no result."""
        self.statuses[status] += 1
        if status not in DONE:
            count, first = self.troubles.get((status, reason), (0, run))
            self.troubles[status, reason] = count + 1, first

    @property
    def rows(self) -> int:
        """Number of runs that have a row."""
        return self.statuses.total()

    @property
    def results(self) -> int:
        """Number of runs with a result."""
        return sum(self.statuses[status] for status in DONE)

    @property
    def rate(self) -> float:
        """Fraction of the rows that passed."""
        return self.statuses["passed"] / max(1, self.rows)

    def interval(self, rate: float) -> tuple[float, float] | tuple[()]:
        """Confidence interval (95 %) of a rate (Wilson); empty if the runs are no random sample.

        The repeats of a case are not independent: an interval of the cases is the wider one.
        """
        if not self.samples:
            return ()
        square = NORMAL_95**2 / self.samples
        middle = (rate + square / 2.0) / (1.0 + square)
        half = math.sqrt(square * (rate * (1.0 - rate) + square / 4.0)) / (1.0 + square)
        return max(0.0, middle - half), min(1.0, middle + half)

    @property
    def passed(self) -> bool | None:
        """Whether every run of the study passed; None if all were completed without criteria."""
        if self.runs and self.statuses["done"] == self.runs:
            return None
        return self.statuses["passed"] == self.runs

    def to_dict(self) -> dict[str, Any]:
        """Return the summary as plain data for JSON."""
        return {
            "runs": self.runs,
            "rows": self.rows,
            "statuses": dict(self.statuses),
            "success": {"rate": self.rate}
            | dict(zip(("low", "high"), self.interval(self.rate), strict=False)),
            "metrics": {
                name: {
                    "unit": self.units[name],
                    **{key: plain(value) for key, value in quantiles(values).items()},
                }
                for name, values in self.values.items()
            },
            "criteria": {name: {"held": count, "of": self.results} for name, count in self.held.items()},
            "sensitivity": [entry.to_dict() for entry in self.sensitivities],
            "status": STATUSES[self.passed] if self.results else CosimError.status,
            "passed": self.passed,
        }

    def to_json(self) -> str:
        """Return the summary as strict JSON."""
        return strict.text(self.to_dict())


def summarize(plan: Plan, store: Store) -> Summary:
    """Read all rows of a study once."""
    found = Summary(len(plan.numbers))
    where = locations(plan)
    found.columns = {name: [] for name in where}
    for row in rows(plan, store):
        for name, (part, key) in where.items():
            found.columns[name].append(cell(row, part, key))
        found.units |= restored(row.get("units", {}), row.get("definitions", {}))
        found.count(row["status"], row["reason"], row["run"])
        for name, held in row.get("criteria", {}).items():
            found.held[name] += held
    for name in found.units:
        values = [value for value in found.columns.get(f"metric.{name}", ()) if value is not None]
        found.values[name] = np.array(values, dtype=np.float64)
    if plan.study.design.kind in RANDOM:
        found.samples = len(set(found.columns["case"]))
    found.sensitivities = sensitivities(plan, found.columns)
    return found


def rows(plan: Plan, store: Store) -> Iterator[Row]:
    """Rows of a study in the order of its runs."""
    runs = (plan.runs[number] for number in plan.numbers)
    return (row for run in runs if (row := store.row(run, plan.criteria(run))) is not None)


def locations(plan: Plan) -> dict[str, tuple[str, str]]:
    """Columns of the table: name, and location of its value within a row (part, key)."""
    return {
        **{name: ("", name) for name in ("run", "case", "seed", "status", "reason")},
        **{key: ("set", key) for key in plan.varying},
        **{f"metric.{metric.name}": ("metrics", metric.name) for metric in plan.scenario.metric},
        **{f"criterion.{entry.id}": ("criteria", entry.id) for entry in plan.scenario.criterion},
        **{name: ("", name) for name in ("engine", "simulated_s", "wall_s", "hash")},
    }


def cell(row: Row, part: str, key: str) -> Any:
    """Value of one column of a row; None if it has none."""
    value = (row.get(part, {}) if part else row).get(key)
    if part == "metrics" and value is not None:
        return float(value)
    # the same few texts in all rows
    return sys.intern(value) if isinstance(value, str) else value


def quantiles(values: NDArray[np.float64]) -> dict[str, float]:
    """Quantiles of the finite values."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return dict.fromkeys(QUANTILES, math.nan)
    return {name: float(np.quantile(finite, share)) for name, share in QUANTILES.items()}


def quantities(found: Summary) -> dict[str, NDArray[np.float64]]:
    """Values of the metrics that are not Boolean."""
    return {
        name: values
        for name, values in found.values.items()
        if found.units[name] not in ("", "1") or not np.all(np.isin(values[np.isfinite(values)], (0.0, 1.0)))
    }


def spread(found: Summary) -> list[tuple[str, ...]]:
    """Names of the metrics that are not Boolean, each with the texts of its quantiles."""
    return [
        (name, *(text(value, found.units[name]) for value in quantiles(values).values()))
        for name, values in quantities(found).items()
    ]
