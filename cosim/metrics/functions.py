"""Operators and functions of the expression language, and the units of their results as far as known."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cosim.units import ONE, PLAIN, Unit, definitions_of, has_zero


def reduction(function: Callable[..., Any]) -> Callable[..., Any]:
    """One number from a column; NaN from a column without rows."""
    return lambda values, *more: function(values, *more) if np.size(values) else np.float64(math.nan)


def truth(function: Callable[..., Any]) -> Callable[..., Any]:
    """Make the truth values of a function the numbers 1 and 0, with which numpy computes as with others."""
    return lambda *values: function(*values).astype(np.float64)


AND, OR, NOT = truth(np.logical_and), truth(np.logical_or), truth(np.logical_not)
BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: np.divide,
    ast.Mod: np.mod,
    ast.Pow: np.power,
    ast.BitAnd: AND,
    ast.BitOr: OR,
}
UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Invert: NOT,
    ast.Not: NOT,
}
COMPARE: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: truth(np.equal),
    ast.NotEq: truth(np.not_equal),
    ast.Lt: truth(np.less),
    ast.LtE: truth(np.less_equal),
    ast.Gt: truth(np.greater),
    ast.GtE: truth(np.greater_equal),
}
UFUNCS = (
    *("abs", "sqrt", "exp", "log", "log10", "floor", "ceil", "sign", "hypot", "minimum", "maximum"),
    *("sin", "cos", "tan", "arcsin", "arccos", "arctan", "arctan2", "degrees", "radians"),
)
ROWWISE: dict[str, tuple[int, Callable[..., Any]]] = {
    **{name: (getattr(np, name).nin, getattr(np, name)) for name in UFUNCS},
    "round": (1, np.rint),
    "clip": (3, np.clip),
    "isfinite": (1, truth(np.isfinite)),
    "where": (3, lambda condition, yes, no: np.where(np.not_equal(condition, 0), yes, no)),
}
"""Functions of single rows, with their number of arguments."""
WHOLE: dict[str, tuple[int, Callable[..., Any]]] = {
    "min": (1, reduction(np.min)),
    "max": (1, reduction(np.max)),
    "mean": (1, reduction(np.mean)),
    "std": (1, reduction(np.std)),
    "rms": (1, reduction(lambda values: np.sqrt(np.mean(np.square(values))))),
    "sum": (1, np.sum),
    "count": (1, lambda values: np.float64(np.count_nonzero(values))),
    "any": (1, truth(np.any)),
    "all": (1, truth(np.all)),
    "first": (1, reduction(lambda values: np.atleast_1d(values)[0])),
    "last": (1, reduction(lambda values: np.atleast_1d(values)[-1])),
    "median": (1, reduction(np.median)),
    "percentile": (2, reduction(np.percentile)),
    "ptp": (1, reduction(np.ptp)),
    "cumsum": (1, np.cumsum),
    "unwrap": (1, np.unwrap),
    "cummax": (1, np.maximum.accumulate),
    "cummin": (1, np.minimum.accumulate),
    "diff": (1, lambda values: np.diff(values, prepend=values[:1])),
    "hold": (2, lambda values, condition: held(values, condition)),
}
"""Functions that need the whole trace."""
TIMES: dict[str, tuple[int, Callable[..., Any]]] = {
    "first_time": (1, lambda time, condition: time_at(time, condition, 0, math.inf)),
    "last_time": (1, lambda time, condition: time_at(time, condition, -1, -math.inf)),
    "longest_time": (1, lambda time, condition: longest(time, condition)),
    "derivative": (1, lambda time, values: np.gradient(values, time)),
    "integral": (1, lambda time, values: np.trapezoid(values, time)),
    "at": (2, lambda time, values, moment: value_at(time, values, moment)),
}
"""Functions of time.

Times of a condition: of its first row (`inf` if there is none), its last (`-inf`), its longest interval.
Of a column: derivative and integral over time, value at a time.
"""
LOGICAL = {"BitAnd", "BitOr", "Invert", "Not", "any", "all", "isfinite"}
"""Operators and functions whose result is true or false."""
CHOICES = {"where": (1, 2), "minimum": (0, 1), "maximum": (0, 1), "Mult": (0, 1)}
"""Arguments that are true or false if the result is."""
VALUES = ("max", "min", "first", "last", "at")
"""Functions whose result is a value of their column."""
KEEP_ITEMS = {"first", "last", "min", "max", "cummax", "cummin", "hold", "at"}
CONSTANTS = {"pi": math.pi, "inf": math.inf, "nan": math.nan, "true": 1.0, "false": 0.0}
SELECTIONS = {
    "min", "max", "minimum", "maximum", "clip", "round", "mean", "median", "first", "last", "percentile",
    "cummax", "cummin", "hold", "at", "where", "UAdd",
}  # fmt: skip
"""Operators and functions whose result is one of their values, or between them."""
SAME = SELECTIONS | {
    "Add", "Sub", "Mod", "USub", "abs", "hypot", "rms", "sum", "cumsum", "unwrap", "diff", "ptp", "std",
}  # fmt: skip
"""Operators and functions whose result has the unit of their arguments."""
ANGLES = {"arcsin", "arccos", "arctan", "arctan2", "radians"}
UNKNOWN = {"sqrt", "Pow", "integral", "degrees", "floor", "ceil"}
OF_UNIT = {"percentile": (0,), "hold": (0,), "at": (0,), "where": (1, 2), "Mod": (0,)}
"""Arguments with the unit, if not all have it."""


def time_at(time: Any, condition: Any, index: int, never: float) -> Any:
    """Time of the first (0) or last (-1) row that meets the condition."""
    times = time[np.broadcast_to(np.not_equal(condition, 0), np.shape(time))]
    return times[index] if times.size else np.float64(never)


def value_at(time: Any, values: Any, moment: Any) -> Any:
    """Value in the last row at or before a time, within rounding; NaN before the first row."""
    row = np.searchsorted(time, moment + 1e-9, side="right") - 1
    if row < 0 or not np.isfinite(moment):
        return np.float64(math.nan)
    return np.broadcast_to(values, np.shape(time))[row]


def longest(time: Any, condition: Any) -> Any:
    """Longest uninterrupted time of a condition: up to the next row, or the end."""
    holds = np.broadcast_to(np.not_equal(condition, 0), np.shape(time))
    edges = np.diff(np.concatenate(([False], holds, [False])).astype(np.int8))
    begins, ends = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0)
    return np.max(time[np.minimum(ends, len(time) - 1)] - time[begins], initial=0.0)


def held(values: Any, condition: Any) -> Any:
    """Value in the last row, up to each row, that meets the condition; NaN before the first."""
    values, holds = np.broadcast_arrays(values, np.not_equal(condition, 0))
    latest = np.maximum.accumulate(np.where(holds, np.arange(len(holds)), -1))
    return np.where(latest >= 0, values[latest], math.nan)


def unit_of(what: str, units: Sequence[str | None]) -> str | None:
    """Return the unit of the result of a function or an operator (name of its `ast` class), None if unknown.

    Plain numbers can be added to every quantity: in `depth - 1e-6` the number is in the unit of the depth. A
    calculated temperature has no unit, because `t - 273.15`, a difference and a value convert differently.
    """
    if what in SAME:
        terms = [units[index] for index in OF_UNIT.get(what, range(len(units)))]
        unit = common(terms)
        return None if what not in SELECTIONS and has_zero(unit) else unit
    if what in ("Mult", "Div"):
        unit = product(*units) if what == "Mult" else quotient(*units)
        return None if has_zero(unit) else unit
    if what in ("first_time", "last_time", "longest_time"):
        return "s"
    if what in ANGLES:
        return "rad"
    if what == "derivative":
        unit = quotient(units[0], "s")
        known = units[0] if units[0] and "/" not in units[0] else ""
        return unit or (Unit(f"{known}/s", definitions_of(known)) if known else None)
    return None if what in UNKNOWN else PLAIN


def common(units: Sequence[str | None]) -> str | None:
    """Return the unit of a sum; None if its terms have different or unknown units."""
    found = set(units) - {PLAIN, ONE}
    if not found:
        return ONE if ONE in units else PLAIN
    known = found - {None}
    return known.pop() if len(known) == 1 else None


def product(left: str | None, right: str | None) -> str | None:
    """Return the unit of a product with a plain number; `100 * ratio` may be in percent."""
    if left in (PLAIN, ONE):
        return PLAIN if right == ONE else right
    return left if right in (PLAIN, ONE) else None


def quotient(left: str | None, right: str | None) -> str | None:
    """Return the unit of a quotient; a quotient of equal units is a plain number: `depth / um`."""
    if left is not None and left == right:
        return PLAIN
    return product(left, right) if right in (PLAIN, ONE) else None
