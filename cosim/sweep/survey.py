"""What the rows of a sweep say together: counts, success rate, distributions; and their tables on disk."""

from __future__ import annotations

import csv
import importlib
import json
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.loop.result import plain
from cosim.sweep.plan import Plan
from cosim.sweep.sensitivity import Influence, influences
from cosim.sweep.store import DONE, Row, Store

QUANTILES = {"minimum": 0.0, "median": 0.5, "95 %": 0.95, "99 %": 0.99, "maximum": 1.0}
NORMAL_95 = 1.959964
"""Half width of 95 % of a normal distribution, in standard deviations."""


@dataclass
class Survey:
    """Counts and numbers of a sweep.

    Parameters
    ----------
    wanted
        Runs of the study.
    statuses
        Number of runs by status.
    values
        Values of each metric, of the runs that gave a result.
    units
        Units of the metrics.
    held
        Number of results in which each criterion held.
    troubles
        Status and reason of what gave no result: how often, and the first run.
    influences
        How the varied keys move the metrics.
    """

    wanted: int
    statuses: Counter[str] = field(default_factory=Counter)
    values: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    held: Counter[str] = field(default_factory=Counter)
    troubles: dict[tuple[str, str], tuple[int, int]] = field(default_factory=dict)
    influences: list[Influence] = field(default_factory=list)

    @property
    def rows(self) -> int:
        """Number of runs that have a row."""
        return self.statuses.total()

    @property
    def results(self) -> int:
        """Number of runs that gave a result."""
        return sum(self.statuses[status] for status in DONE)

    @property
    def passed(self) -> bool:
        """Whether every run of the study passed."""
        return self.statuses["passed"] == self.wanted

    def to_dict(self) -> dict[str, Any]:
        """Return the survey as plain data for JSON."""
        low, high = confidence(self.statuses["passed"], self.rows)
        return {
            "runs": self.wanted,
            "rows": self.rows,
            "statuses": dict(self.statuses),
            "success": {"rate": self.statuses["passed"] / max(1, self.rows), "low": low, "high": high},
            "metrics": {
                name: {
                    "unit": self.units[name],
                    **{key: plain(value) for key, value in quantiles(values).items()},
                }
                for name, values in self.values.items()
            },
            "criteria": {name: {"held": count, "of": self.results} for name, count in self.held.items()},
            "sensitivity": [influence.to_dict() for influence in self.influences],
            "passed": self.passed,
        }

    def to_json(self) -> str:
        """Return the survey as strict JSON."""
        return json.dumps(self.to_dict(), indent=2, allow_nan=False) + "\n"


def survey(plan: Plan, store: Store) -> Survey:
    """Read all rows of a study once."""
    found = Survey(len(plan.runs))
    values: dict[str, list[float]] = {}
    for row in rows(plan, store):
        found.statuses[row["status"]] += 1
        for name, value in row.get("metrics", {}).items():
            values.setdefault(name, []).append(float(value))
        found.units |= row.get("units", {})
        for name, held in row.get("criteria", {}).items():
            found.held[name] += held
        if row["status"] not in DONE:
            trouble = (row["status"], row["reason"])
            count, first = found.troubles.get(trouble, (0, row["run"]))
            found.troubles[trouble] = (count + 1, first)
    found.values = {name: np.array(column) for name, column in values.items()}
    found.influences = influences(plan, rows(plan, store))
    return found


def rows(plan: Plan, store: Store) -> Iterator[Row]:
    """Rows of a study in the order of its runs."""
    return (row for run in plan.runs if (row := store.row(run)) is not None)


def quantiles(values: NDArray[np.float64]) -> dict[str, float]:
    """Quantiles of the finite values."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return dict.fromkeys(QUANTILES, math.nan)
    return {name: float(np.quantile(finite, share)) for name, share in QUANTILES.items()}


def confidence(successes: int, count: int) -> tuple[float, float]:
    """Interval that holds the true rate with 95 % confidence (Wilson)."""
    if not count:
        return 0.0, 1.0
    rate, square = successes / count, NORMAL_95**2 / count
    middle = (rate + square / 2.0) / (1.0 + square)
    half = math.sqrt(square * (rate * (1.0 - rate) + square / 4.0)) / (1.0 + square)
    return max(0.0, middle - half), min(1.0, middle + half)


def columns(plan: Plan) -> dict[str, tuple[str, str]]:
    """Columns of the tables: name, and where its value stands in a row (part, key)."""
    keys = list(dict.fromkeys(key for run in plan.runs for key in run.changes))
    scenario = plan.build(plan.base)
    return {
        **{name: ("", name) for name in ("run", "case", "seed", "status", "reason")},
        **{key: ("set", key) for key in keys},
        **{f"metric.{metric.name}": ("metrics", metric.name) for metric in scenario.metric},
        **{f"criterion.{entry.id}": ("criteria", entry.id) for entry in scenario.criterion},
        **{name: ("", name) for name in ("engine", "simulated_s", "wall_s", "hash")},
    }


def cell(row: Row, part: str, key: str) -> Any:
    """Value of one column of a row; None if it has none."""
    value = (row.get(part, {}) if part else row).get(key)
    return float(value) if part == "metrics" and value is not None else value


def save_csv(plan: Plan, store: Store, file: Path) -> None:
    """Write `summary.csv`: one line for each run that has a row.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    places = columns(plan)
    partial = file.with_name(f".{file.name}.partial")
    try:
        with partial.open("w", newline="", encoding="utf-8") as lines:
            writer = csv.writer(lines)
            writer.writerow(places)
            for row in rows(plan, store):
                writer.writerow([shown(cell(row, *place)) for place in places.values()])
        partial.replace(file)
    except OSError as error:
        raise CosimError(f"cannot write `{file}`: {error.strerror or error}") from None


def shown(value: Any) -> Any:
    """Value in a CSV file: as TOML where that is something else."""
    return str(value).lower() if isinstance(value, bool) else value


def save_parquet(plan: Plan, store: Store, file: Path) -> bool:
    """Write `summary.parquet`, the same table with types; False if pyarrow is not installed.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    try:
        pyarrow: Any = importlib.import_module("pyarrow")
        parquet: Any = importlib.import_module("pyarrow.parquet")
    except ImportError:
        return False
    found = list(rows(plan, store))
    table = {
        name: typed(pyarrow, [cell(row, *place) for row in found]) for name, place in columns(plan).items()
    }
    try:
        parquet.write_table(pyarrow.table(table), file)
    except OSError as error:
        raise CosimError(f"cannot write `{file}`: {error.strerror or error}") from None
    return True


def typed(pyarrow: Any, values: list[Any]) -> Any:
    """Column of one type; of texts where the values have several."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        values = [None if value is None else float(value) for value in values]
    elif len(kinds) > 1:
        values = [None if value is None else str(value) for value in values]
    return pyarrow.array(values)
