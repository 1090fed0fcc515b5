"""Units of the results of operators and functions, as far as they are known."""

from __future__ import annotations

from collections.abc import Sequence

from cosim.units import ONE, PLAIN, Unit, definitions_of, has_zero

SELECTIONS = {
    "min", "max", "minimum", "maximum", "clip", "round", "mean", "median", "first", "last", "percentile",
    "cummax", "cummin", "hold", "at", "where", "UAdd",
}  # fmt: skip
"""Operators and functions whose result is one of their values, or between them."""
SAME = SELECTIONS | {
    "Add", "Sub", "Mod", "USub", "abs", "hypot", "rms", "sum", "cumsum", "unwrap", "diff", "ptp", "std",
}  # fmt: skip
"""Operators and functions whose result has the unit of their arguments."""
TIMES = {"first_time", "last_time", "longest_time"}
ANGLES = {"arcsin", "arccos", "arctan", "arctan2", "radians"}
UNKNOWN = {"sqrt", "Pow", "integral", "degrees", "floor", "ceil"}
ALONE = {"percentile": (0,), "hold": (0,), "at": (0,), "where": (1, 2), "Mod": (0,)}
"""Arguments with the unit, if not all have it."""


def unit_of(what: str, units: Sequence[str | None]) -> str | None:
    """Return the unit of the result of a function or an operator (name of its `ast` class), None if unknown.

    Plain numbers can be added to every quantity: in `depth - 1e-6` the number is in the unit of the depth. A
    calculated temperature has no unit, because `t - 273.15`, a difference and a value convert differently.
    """
    if what in SAME:
        terms = [units[index] for index in ALONE.get(what, range(len(units)))]
        unit = common(terms)
        return None if what not in SELECTIONS and has_zero(unit) else unit
    if what in ("Mult", "Div"):
        unit = product(*units) if what == "Mult" else quotient(*units)
        return None if has_zero(unit) else unit
    if what in TIMES:
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
