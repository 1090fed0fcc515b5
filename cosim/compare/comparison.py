"""Results of a comparison."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.compare.tolerance import Tolerances
from cosim.compare.tube import Tube
from cosim.formatting import strict
from cosim.formatting.verdicts import STATUSES


@dataclass(frozen=True)
class Deviation:
    """Deviation of one quantity, at its largest ratio to the tolerance.

    `reference` is the nearest value within the time shift. The distance `deviation` is infinite if one side
    is NaN. `at` is a time in s or a run number, None for a single number. `outside` values of all `compared`
    ones exceed their tolerance.
    """

    name: str
    unit: str
    reference: float
    value: float
    deviation: float
    tolerance: float
    at: float | None
    outside: int
    compared: int

    @property
    def ratio(self) -> float:
        """Deviation relative to the tolerance."""
        return float(ratio(np.float64(self.deviation), np.float64(self.tolerance)))

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data for JSON."""
        return {"name": self.name, "unit": self.unit, "within": not self.outside} | asdict(self)


@dataclass(frozen=True)
class ComparedColumn:
    """A column of a trace with its tube and enumeration items, for table and plot."""

    times: NDArray[np.float64]
    values: NDArray[np.float64]
    tube: Tube
    items: dict[str, int]


@dataclass
class Comparison:
    """Two things compared with the `allowed` deviations; `kind` is `traces`, `results` or `sweeps`.

    `reference` and `other` are the names of the compared files, as the user gave them. `deviations` has the
    quantities that both have, `differences` all others, one sentence each. `notes` are no differences.
    """

    kind: str
    reference: str
    other: str
    allowed: Tolerances
    deviations: list[Deviation] = field(default_factory=list)
    differences: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    curves: dict[str, ComparedColumn] = field(default_factory=dict)

    @property
    def outside(self) -> list[Deviation]:
        """Quantities beyond their tolerance."""
        return [found for found in self.deviations if found.outside]

    @property
    def within(self) -> bool:
        """Whether nothing differs by more than its tolerance."""
        return not self.outside and not self.differences

    def to_json(self) -> str:
        """Return the comparison as strict JSON."""
        found = {
            "kind": self.kind,
            "reference": self.reference,
            "other": self.other,
            "status": STATUSES[self.within],
            "within": self.within,
            "quantities": [found.to_dict() for found in self.deviations],
            "differences": self.differences,
            "notes": self.notes,
        }
        return strict.text(found)

    def note_extra(self, reference: Iterable[str], other: Iterable[str]) -> None:
        """Note the names that the reference does not have, unless the compared names are selected."""
        known = set(reference)
        extra = [f"`{name}`" for name in other if name not in known]
        if extra and not self.allowed.only:
            self.notes.append("not in the reference: " + ", ".join(extra))

    def add_metric(
        self,
        name: str,
        units: tuple[str, str],
        values: tuple[Sequence[Any], Sequence[Any]],
        at: NDArray[np.float64] | None = None,
    ) -> None:
        """Compare the values of a metric, also texts such as `NaN`; of each pair the reference is first."""
        self.differences += same_units(name, *units)
        before, now = (np.array([number_of(value) for value in side]) for side in values)
        atol, rtol, _ = self.allowed.of(name)
        around = Tube(before, before, np.isnan(before), atol, rtol)
        self.deviations.append(worst(name, units[0], around, now, at))


def worst(
    name: str, unit: str, tube: Tube, values: NDArray[np.float64], at: NDArray[np.float64] | None
) -> Deviation:
    """Deviation of values from a tube: the first with the largest ratio to its tolerance."""
    deviation, tolerance = tube.deviation(values), tube.tolerance(values)
    order = np.lexsort((-np.arange(len(values)), deviation, ratio(deviation, tolerance)))
    index = int(order[-1])
    nearest = tube.high if values[index] > tube.high[index] else tube.low
    inside = deviation[index] == 0.0
    return Deviation(
        name,
        unit,
        float(values[index] if inside else nearest[index]),
        float(values[index]),
        float(deviation[index]),
        float(tolerance[index]),
        None if at is None else float(at[index]),
        int(np.sum(deviation > tolerance)),
        len(values),
    )


def ratio(deviation: Any, tolerance: Any) -> Any:
    """Deviations relative to their tolerances; 0 without a deviation, also if the tolerance is 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(deviation == 0.0, 0.0, deviation / tolerance)


def same_units(name: str, before: str, now: str) -> list[str]:
    """Sentence about a changed unit; none if it is equal or unknown."""
    if not before or not now or before == now:
        return []
    return [f"`{name}` is in `{now}`, the reference in `{before}`"]


def number_of(value: Any) -> float:
    """Read a number of a JSON file, also a text such as `NaN`; NaN if it is not a number."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return math.nan
