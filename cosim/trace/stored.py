"""Traces read back from files."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim import paths
from cosim.errors import CosimError
from cosim.trace.columns import Columns, whole
from cosim.units import restored

LABELS = ("units", "items", "descriptions")
"""Metadata of columns by name: unit, enumeration items and description."""


@dataclass(frozen=True)
class StoredTrace:
    """A trace from a file: its columns by name, `time` among them, with units and items if the file has them.

    The columns of a Parquet file are read on access. `about` is the metadata of the run: scenario, title,
    seed, simulated time, FMUs, versions.
    """

    file: Path
    data: Columns
    units: dict[str, str] = field(default_factory=dict)
    items: dict[str, dict[str, int]] = field(default_factory=dict)
    about: dict[str, Any] = field(default_factory=dict)

    @property
    def columns(self) -> list[str]:
        """Names of the columns except the time."""
        return [name for name in self.data if name != "time"]

    @functools.cached_property
    def times(self) -> NDArray[np.float64]:
        """Increasing times of the rows, s."""
        return self.data["time"]

    @property
    def trace(self) -> NDArray[Any]:
        """The whole trace in memory, a structured array as `Result.trace`."""
        return whole(self.data)


def with_labels(file: Path, data: Columns, about: Any) -> StoredTrace:
    """Trace with the metadata of the run and of the columns; a `ValueError` if they are not tables."""
    if not isinstance(about, dict) or not all(isinstance(about.get(label, {}), dict) for label in LABELS):
        raise ValueError(f"its metadata are not a table with {', '.join(LABELS)}")
    units = {name: str(unit) for name, unit in about.get("units", {}).items()}
    units = restored(units, about.get("definitions", {}))
    items = {name: entry for name, entry in about.get("items", {}).items() if isinstance(entry, dict)}
    return StoredTrace(file, data, units, items, facts(about))


def facts(about: dict[str, Any]) -> dict[str, Any]:
    """Metadata of the run, without those of its columns."""
    return {name: value for name, value in about.items() if name not in LABELS}


def check(found: StoredTrace) -> None:
    """Check that there are rows, and that their times increase."""
    shown = paths.shown(found.file)
    if "time" not in found.data:
        known = ", ".join(f"`{name}`" for name in found.columns[:8])
        raise CosimError(f"`{shown}` has no column `time`", f"Its columns are {known}.")
    if not len(found.times):
        raise CosimError(f"`{shown}` has no rows")
    if not np.all(np.isfinite(found.times)) or np.any(np.diff(found.times) <= 0.0):
        raise CosimError(f"the times in `{shown}` do not increase from row to row")
