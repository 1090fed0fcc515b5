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
FIRST, LAST = ("run", "case", "seed", "status", "reason"), ("engine", "simulated_s", "wall_s", "hash")
"""Columns of the table before and after keys, metrics and criteria."""
RANDOM = ("latin-hypercube", "sobol", "monte-carlo")
"""Designs whose cases are a random sample of the ranges."""


@dataclass
class Summary:
    """Counts and numbers of a sweep."""

    runs: int
    samples: int = 0
    """Independent random samples with a row; 0 if the runs are none, as those of a grid."""
    columns: Table = field(default_factory=dict)
    statuses: Counter[str] = field(default_factory=Counter)
    values: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    """Values of each metric, of the runs with a result."""
    units: dict[str, str] = field(default_factory=dict)
    held: Counter[str] = field(default_factory=Counter)
    """Number of results that passed each criterion."""
    troubles: dict[tuple[str, str], tuple[int, int]] = field(default_factory=dict)
    """Status and reason of runs without result: count and first run."""
    sensitivities: list[Sensitivity] = field(default_factory=list)

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
            "success": {
                "rate": self.rate,
                **dict(zip(("low", "high"), self.interval(self.rate), strict=False)),
            },
            "metrics": {
                name: {"unit": self.units[name], **plain(quantiles(values))}
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
    metrics = (f"metric.{metric.name}" for metric in plan.scenario.metric)
    criteria = (f"criterion.{entry.id}" for entry in plan.scenario.criterion)
    names = (*FIRST, *plan.varying, *metrics, *criteria, *LAST)
    found.columns = {name: [] for name in names}
    for row in rows(plan, store):
        values = flat(row)
        for name, column in found.columns.items():
            column.append(values.get(name))
        found.units |= restored(row.get("units", {}), row.get("definitions", {}))
        found.count(row["status"], row["reason"], row["run"])
        for name, held in row.get("criteria", {}).items():
            found.held[name] += held
    for name in found.units:
        column = found.columns.get(f"metric.{name}", [])
        found.values[name] = np.array([value for value in column if value is not None], dtype=np.float64)
    if plan.study.design.kind in RANDOM:
        found.samples = len(set(found.columns["case"]))
    found.sensitivities = sensitivities(plan, found.columns)
    return found


def rows(plan: Plan, store: Store) -> Iterator[Row]:
    """Rows of a study in the order of its runs."""
    runs = (plan.runs[number] for number in plan.numbers)
    return (row for run in runs if (row := store.row(run, plan.criteria(run))) is not None)


def flat(row: Row) -> Row:
    """Values of a row by the names of their columns."""
    metrics = {f"metric.{name}": float(value) for name, value in row.get("metrics", {}).items()}
    criteria = {f"criterion.{name}": held for name, held in row.get("criteria", {}).items()}
    values = {**row, **row["set"], **metrics, **criteria}
    # the same few texts in all rows
    return {name: sys.intern(value) if isinstance(value, str) else value for name, value in values.items()}


def finite(values: Any) -> Any:
    """Return only the finite values."""
    return values[np.isfinite(values)]


def is_logical(values: Any) -> bool:
    """Whether all finite values are 0 or 1."""
    return bool(np.all(np.isin(finite(values), (0.0, 1.0))))


def quantiles(values: NDArray[np.float64]) -> dict[str, float]:
    """Quantiles of the finite values."""
    known = finite(values)
    ends = np.quantile(known, [*QUANTILES.values()]).tolist() if known.size else [math.nan] * len(QUANTILES)
    return dict(zip(QUANTILES, ends, strict=True))


def quantities(found: Summary) -> dict[str, NDArray[np.float64]]:
    """Values of the metrics that are not Boolean."""
    plain = {name for name, unit in found.units.items() if unit in ("", "1")}
    return {
        name: values for name, values in found.values.items() if name not in plain or not is_logical(values)
    }


def spread(found: Summary) -> list[tuple[str, ...]]:
    """Names of the metrics that are not Boolean, each with the texts of its quantiles."""
    return [
        (name, *(text(value, found.units[name]) for value in quantiles(values).values()))
        for name, values in quantities(found).items()
    ]
