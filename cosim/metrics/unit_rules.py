"""Units of the results of operators and functions, as far as they are known."""

from __future__ import annotations

from collections.abc import Sequence

from cosim.units import ONE, PLAIN, Kind, Unit, definitions_of, kind_of

SELECTIONS = {
    "min", "max", "minimum", "maximum", "clip", "round", "mean", "median", "first", "last", "percentile",
    "cummax", "cummin", "hold", "at", "where", "UAdd",
}  # fmt: skip
"""Operators and functions whose result is one of their values, or between them."""
DIFFERENCES = {"Sub", "diff", "ptp", "std"}
SAME = SELECTIONS | DIFFERENCES | {"Add", "Mod", "USub", "abs", "hypot", "rms", "sum", "cumsum", "unwrap"}
"""Operators and functions whose result has the unit of their arguments."""
TIMES = {"first_time", "last_time", "longest_time"}
ANGLES = {"arcsin", "arccos", "arctan", "arctan2", "radians"}
UNKNOWN = {"sqrt", "Pow", "integral", "degrees", "floor", "ceil"}
ALONE = {"percentile": (0,), "hold": (0,), "at": (0,), "where": (1, 2), "Mod": (0,)}
"""Arguments with the unit, if not all have it."""


def unit_of(what: str, units: Sequence[str | None]) -> str | None:
    """Return the unit of a result; None if unknown.

    Plain numbers can be added to every quantity: in `depth - 1e-6` the number is in the unit of the depth.

    Parameters
    ----------
    what
        Operator, by the name of its `ast` class, or function.
    units
        Units of its arguments.
    """
    if what in SAME:
        terms = [units[index] for index in ALONE.get(what, range(len(units)))]
        return of_kind(common(terms), kind(what, terms))
    if what == "Mult":
        return product(*units)
    if what == "Div":
        return quotient(*units)
    if what in TIMES:
        return "s"
    if what in ANGLES:
        return "rad"
    if what == "derivative":
        return quotient(units[0], "s") or per_second(units[0])
    return None if what in UNKNOWN else PLAIN


def common(units: Sequence[str | None]) -> str | None:
    """Return the unit of a sum; None if its terms have different or unknown units."""
    found = set(units) - {PLAIN, ONE}
    if not found:
        return ONE if ONE in units else PLAIN
    known = found - {None}
    return known.pop() if len(known) == 1 else None


def kind(what: str, units: Sequence[str | None]) -> Kind:
    """Whether the result is a value, or a difference of values such as temperatures in degC."""
    kinds = {kind_of(unit) for unit in units if unit not in (None, PLAIN, ONE)}
    if kinds == {"difference"} or (what in SELECTIONS and len(kinds) == 1):
        return kinds.pop()
    of_values = what in DIFFERENCES and kinds == {"value"} and not {None, PLAIN, ONE} & set(units)
    return "difference" if of_values else "unclear"


def of_kind(unit: str | None, kind: Kind) -> str | None:
    """Return a unit with the kind of its values."""
    return unit if unit in (None, PLAIN, ONE) else Unit(unit, definitions_of(unit), kind)


def scaled(unit: str | None) -> str | None:
    """Return the unit after a multiplication by a number, which makes an offset unclear."""
    return of_kind(unit, "difference" if unit and kind_of(unit) == "difference" else "unclear")


def product(left: str | None, right: str | None) -> str | None:
    """Return the unit of a product with a plain number; `100 * ratio` may be in percent."""
    if left in (PLAIN, ONE):
        return PLAIN if right == ONE else scaled(right)
    return scaled(left) if right in (PLAIN, ONE) else None


def quotient(left: str | None, right: str | None) -> str | None:
    """Return the unit of a quotient; a quotient of equal units is a plain number: `depth / um`."""
    if left is not None and left == right:
        return PLAIN
    return product(left, right) if right in (PLAIN, ONE) else None


def per_second(unit: str | None) -> str | None:
    """Return the unit of a derivative."""
    return Unit(f"{unit}/s", definitions_of(unit)) if unit and "/" not in unit else None
