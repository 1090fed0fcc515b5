"""Numbers with units in readable form."""

from __future__ import annotations

import math

from cosim import units

PREFIXES = {exponent: prefix for prefix, exponent in units.PREFIXES.items()}
PREFIXED = {"m", "s", "A", *units.DERIVED, "m/s", "N/s", "N.m", "m/s2"}
"""Units that take a prefix; others (rad, kg, 1, ...) are not scaled."""
SMALLEST = 1e-15
"""Smaller values and 0 take no prefix."""


def text(value: float, unit: str = "", digits: int = 4) -> str:
    """Value and unit with a prefix: `text(4.5e-7, "m")` is `450 nm`."""
    if unit in ("", "1"):
        return number(value, digits)
    if unit not in PREFIXED or not SMALLEST <= abs(value) < math.inf:
        return f"{number(value, digits)} {unit}"
    exponent = 3 * math.floor(math.log10(abs(value)) / 3.0)
    # rounding may carry into the next prefix: 999.96 nm is 1 um
    if abs(float(f"{value / 10.0**exponent:.{digits}g}")) >= 1000.0:
        exponent += 3
    if exponent not in PREFIXES:
        return f"{number(value, digits)} {unit}"
    if unit == "s" and exponent == 3:
        exponent = 0
    return f"{number(value / 10.0**exponent, digits)} {PREFIXES[exponent]}{unit}"


def prefixed(unit: str, largest: float) -> tuple[str, float]:
    """Find the prefix for values up to `largest`; returns the prefixed unit and the factor."""
    if unit not in PREFIXED or not SMALLEST <= largest < math.inf:
        return unit, 1.0
    exponent = 3 * math.floor(math.log10(largest) / 3.0)
    if exponent not in PREFIXES or (unit == "s" and exponent > 0):
        return unit, 1.0
    return PREFIXES[exponent] + unit, 10.0**-exponent


def number(value: float, digits: int = 4) -> str:
    """Format a number with up to `digits` significant digits and with all digits before the point."""
    if abs(value) < 1e9 and (float(value).is_integer() or 10.0**digits <= abs(value) < 1e6):
        return f"{value:.0f}"
    return f"{value:.{digits}g}"


def round_down(value: float) -> float:
    """Largest of 1, 2, 5, 10, 20, ... that is not above."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-9))
