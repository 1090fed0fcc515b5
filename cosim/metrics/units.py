"""Units in expressions: constants for numbers, and the unit of a result if it is known."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence

SCALES = {
    "m": ("m", 1.0), "cm": ("m", 1e-2), "mm": ("m", 1e-3), "um": ("m", 1e-6), "nm": ("m", 1e-9),
    "s": ("s", 1.0), "ms": ("s", 1e-3), "us": ("s", 1e-6), "minute": ("s", 60.0), "hour": ("s", 3600.0),
    "kg": ("kg", 1.0), "rad": ("rad", 1.0), "mrad": ("rad", 1e-3), "urad": ("rad", 1e-6),
    "deg": ("rad", math.pi / 180.0), "Hz": ("Hz", 1.0), "kHz": ("Hz", 1e3), "rpm": ("rad/s", math.pi / 30.0),
    "N": ("N", 1.0), "mN": ("N", 1e-3), "kN": ("N", 1e3), "A": ("A", 1.0), "mA": ("A", 1e-3),
    "V": ("V", 1.0), "mV": ("V", 1e-3), "W": ("W", 1.0), "J": ("J", 1.0),
}  # fmt: skip
"""SI unit and number of each unit: `5 * um` is 5e-6, `depth / um` is the depth in micrometers."""
PLAIN = ""
"""Unit of a number without known unit, which may also be a fraction or percent."""
ONE = "1"
OTHERS = {ONE: (ONE, 1.0), "%": (ONE, 0.01)}
"""Units that are not names and cannot be used in expressions."""
FACTOR = re.compile(r"([^\d./*^-]+)\^?(-?\d?)")
"""Unit and exponent of one factor: `m`, `s2`, `s^-1`."""
SAME = {
    "Add", "Sub", "Mod", "USub", "UAdd", "abs", "min", "max", "minimum", "maximum", "clip", "hypot", "round",
    "mean", "median", "std", "rms", "sum", "ptp", "first", "last", "percentile", "cummax", "cummin", "cumsum",
    "diff", "hold", "at", "where", "unwrap",
}  # fmt: skip
"""Operators and functions whose result has the unit of their arguments."""
TIMES = {"first_time", "last_time", "longest_time"}
ANGLES = {"arcsin", "arccos", "arctan", "arctan2", "radians"}
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
        return common([units[index] for index in ALONE.get(what, range(len(units)))])
    if what == "Mult":
        return product(*units)
    if what == "Div":
        return quotient(*units)
    if what in TIMES:
        return "s"
    if what in ANGLES:
        return "rad"
    if what == "derivative":
        return quotient(units[0], "s") or (f"{units[0]}/s" if units[0] and "/" not in units[0] else None)
    if what in ("sqrt", "Pow", "integral", "degrees", "floor", "ceil"):
        return None
    return PLAIN


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


def conversion(source: str, target: str) -> float | None:
    """Factor from a value in `source` to `target`; None if they are not convertible.

    Units are those of `SCALES`, their products (`N.m`), powers (`m/s2`) and quotients (`mm/s`).
    """
    if source == target:
        return 1.0
    found, wanted = reduced(source), reduced(target)
    if found is None or wanted is None or found[1] != wanted[1]:
        return None
    return found[0] / wanted[0]


def reduced(unit: str) -> tuple[float, Counter[str]] | None:
    """Scale of a unit and the exponents of its SI units; None if it is not known, or beyond all numbers."""
    scale, powers = 1.0, Counter[str]()
    for place, part in enumerate(unit.split("/")):
        for text in re.split(r"[.*]", part):
            found = FACTOR.fullmatch(text)
            base, size = (SCALES | OTHERS).get(found[1] if found else text, ("", 0.0))
            if not base:
                return None
            exponent = int((found and found[2]) or 1) * (-1 if place else 1)
            scale *= size**exponent
            # `rpm` is a quotient itself
            for sign, name in zip((1, -1), base.split("/"), strict=False):
                powers[name] += sign * exponent
    if not 0.0 < scale < math.inf:
        return None
    return scale, Counter({name: power for name, power in powers.items() if power and name != ONE})
