"""Comparison of two traces, column by column, at the times of the second."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cosim.compare.comparison import ComparedColumn, Comparison, same_units, worst
from cosim.compare.tube import tube
from cosim.errors import CosimError
from cosim.trace.columns import stepped
from cosim.trace.stored import StoredTrace

SAME = 1e-3
"""Tolerance of equal steps and times, as a fraction of a step."""


def compare(found: Comparison, reference: StoredTrace, other: StoredTrace) -> None:
    """Compare a trace with a reference."""
    allowed, chosen = found.allowed, found.allowed.chosen(reference.columns)
    if not chosen:
        raise CosimError(f"`{found.reference}` has no columns to compare")
    present = [name for name in chosen if name in other.columns]
    found.differences += [f"the column `{name}` is missing" for name in chosen if name not in other.columns]
    found.note_extra(reference.columns, other.columns)
    compare_times(found, reference.times, other.times, min((allowed.of(n)[2] for n in present), default=0.0))
    for name in present:
        found.differences += meanings(name, reference, other)
        values, others = reference.data[name], other.data[name]
        around = tube(reference.times, values, other.times, *allowed.of(name), stepped=stepped(values))
        unit = reference.units.get(name, "") or other.units.get(name, "")
        found.deviations.append(worst(name, unit, around, others, other.times))
        items = other.items.get(name) or reference.items.get(name) or {}
        found.curves[name] = ComparedColumn(other.times, others, around, items)


def meanings(name: str, reference: StoredTrace, other: StoredTrace) -> list[str]:
    """Sentences about a column with a changed unit or changed items."""
    sentences = same_units(name, reference.units.get(name, ""), other.units.get(name, ""))
    before, now = reference.items.get(name), other.items.get(name)
    if not sentences and before and now and before != now:
        sentences = [f"`{name}` has the items {listed(now)}, the reference {listed(before)}"]
    return sentences


def compare_times(
    found: Comparison, before: NDArray[np.float64], now: NDArray[np.float64], shift: float
) -> None:
    """Report different time spans and different row times.

    The start and end may differ by `shift`, the smallest time shift of the columns.
    """
    coarse, fine = sorted((typical_step(before), typical_step(now)), reverse=True)
    same_step = coarse - fine <= SAME * coarse
    # the last row of a coarser trace may lie up to its step before the end
    slack = shift + (0.5 if same_step else 1.0) * coarse
    for word, old, new in (("begins", before[0], now[0]), ("ends", before[-1], now[-1])):
        sentence = f"it {word} at {new:.9g} s, the reference at {old:.9g} s"
        if abs(old - new) > slack:
            found.differences.append(sentence)
        elif abs(old - new) > 0.5 * coarse:
            found.notes.append(sentence)
    common = min(len(before), len(now))
    if not same_step or np.any(np.abs(before[:common] - now[:common]) > SAME * coarse):
        found.notes.append("different times: the reference is interpolated; whole numbers are held")


def typical_step(times: NDArray[np.float64]) -> float:
    """Median time between two rows, s; the median is insensitive to gaps."""
    return float(np.median(np.diff(times))) if len(times) > 1 else 0.0


def listed(items: dict[str, int]) -> str:
    """Items of an enumeration as text."""
    return " ".join(f"{name}={number}" for name, number in items.items())
