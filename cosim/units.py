"""Units: symbols of SI, definitions of FMUs by their base units, and conversions."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import astuple, dataclass, replace
from typing import Any, NamedTuple

PLAIN = ""
"""Unit of a number without known unit, which may also be a fraction or percent."""
ONE = "1"
BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
"""Base units of FMI, in the order of `Definition.powers`."""
DERIVED = {
    "Hz": "1/s", "N": "kg.m/s2", "Pa": "N/m2", "J": "N.m", "W": "J/s", "C": "A.s", "V": "W/A", "F": "C/V",
    "Ohm": "V/A", "S": "A/V", "Wb": "V.s", "T": "Wb/m2", "H": "Wb/A",
}  # fmt: skip
"""Units of SI in terms of those before them."""
SCALED = {
    "g": (1e-3, "kg"), "minute": (60.0, "s"), "min": (60.0, "s"), "hour": (3600.0, "s"), "h": (3600.0, "s"),
    "deg": (math.pi / 180.0, "rad"), "°": (math.pi / 180.0, "rad"), "rev": (2.0 * math.pi, "rad"),
    "rpm": (math.pi / 30.0, "rad/s"), "bar": (1e5, "Pa"), "l": (1e-3, "m3"), "L": (1e-3, "m3"),
    "Wh": (3600.0, "J"), "Nm": (1.0, "N.m"), "Ω": (1.0, "Ohm"), "%": (0.01, ONE),
}  # fmt: skip
"""Other units: their size in units of SI."""
TEMPERATURES = {"degC": (1.0, 273.15), "°C": (1.0, 273.15), "degF": (5.0 / 9.0, 459.67 * 5.0 / 9.0)}
"""Units whose zero is not that of K: factor and offset."""
PREFIXES = {"p": -12, "n": -9, "u": -6, "m": -3, "": 0, "k": 3, "M": 6, "G": 9}
"""Exponents of 10 of the prefixes."""
READ_ONLY = {"c": -2, "h": 2, "μ": -6}
"""Exponents of prefixes that results do not use."""
UNSCALED = {"kg", "minute", "min", "hour", "h", "deg", "°", "rev", "rpm", "%", ONE, *TEMPERATURES}
"""Units without prefixes."""
FACTOR = re.compile(r"([^\d./*^-]+)\^?(-?\d?)")
"""Unit and exponent of one factor: `m`, `s2`, `s^-1`."""
GROUP = re.compile(r"/\(([^()/]*)\)$")
"""Several units of a denominator: `W/(m2.K)`."""


@dataclass(frozen=True)
class Definition:
    """A unit as in FMI: `factor` times the value, plus `offset`, is the value in base units."""

    powers: tuple[int, ...] = (0,) * len(BASES)
    factor: float = 1.0
    offset: float = 0.0


class Unit(str):
    """Name of a unit with the definitions of its FMU, which precede those of SI."""

    known: Mapping[str, Definition]

    def __new__(cls, name: str, known: Mapping[str, Definition] | None = None) -> Unit:
        """Name with definitions."""
        unit = super().__new__(cls, name)
        unit.known = known or {}
        return unit


class Conversion(NamedTuple):
    """Conversion of values: `factor * value + offset`."""

    factor: float = 1.0
    offset: float = 0.0

    def __call__(self, value: float) -> float:
        """Convert a value."""
        return value * self.factor + self.offset if self.offset else value * self.factor

    def back(self, value: float) -> float:
        """Convert a value in the other direction."""
        return (value - self.offset) / self.factor

    @property
    def changes(self) -> bool:
        """Whether values change by more than the rounding of a definition."""
        return bool(self.offset) or not math.isclose(self.factor, 1.0, rel_tol=1e-9)


UNCHANGED = Conversion()


def conversion(source: str, target: str) -> Conversion | None:
    """Conversion from a unit to another; None if there is none.

    Units are symbols with prefixes, products (`N.m`), powers (`m/s2`, `s^-1`) and quotients (`mm/s`).
    """
    known = definitions_of(source)
    one, other = defined(source, known), defined(target, definitions_of(target) or known)
    if one is None or other is None:
        return UNCHANGED if source == target else None
    if one.powers != other.powers:
        return None
    return Conversion(one.factor / other.factor, (one.offset - other.offset) / other.factor)


def definitions_of(unit: str) -> Mapping[str, Definition]:
    """Definitions of the FMU that a unit comes from."""
    return unit.known if isinstance(unit, Unit) else {}


def has_zero(unit: str | None) -> bool:
    """Whether a unit is one of temperature, in which a difference converts in another way than a value."""
    found = defined(unit or PLAIN, definitions_of(unit or PLAIN))
    return found is not None and found.powers == SYMBOLS["K"].powers


def relative(known: Mapping[str, Definition]) -> dict[str, Definition]:
    """Definitions of an FMU for differences, in which units have no offset."""
    temperatures = {name: SYMBOLS[name] for name in TEMPERATURES}
    return {name: replace(one, offset=0.0) for name, one in {**temperatures, **known}.items()}


def beyond_si(names: Iterable[str]) -> dict[str, Any]:
    """Table `definitions` for JSON of the units that SI does not define in the same way, if there are any."""
    known = {name: defined(name, definitions_of(name)) for name in names if definitions_of(name)}
    found = {name: astuple(one) for name, one in known.items() if one is not None and one != defined(name)}
    return {"definitions": found} if found else {}


def restored(names: Mapping[str, str], stored: Mapping[str, Any]) -> dict[str, str]:
    """Units by any key, with the definitions of `beyond_si`; raises ValueError if they are damaged."""
    try:
        known = {name: Definition(tuple(powers), *rest) for name, (powers, *rest) in stored.items()}
    except (TypeError, AttributeError):
        raise ValueError("its definitions of units are damaged") from None
    return {key: Unit(name, known) if name in known else name for key, name in names.items()}


def defined(unit: str, known: Mapping[str, Definition] | None = None) -> Definition | None:
    """Definition of a unit by its name; None if it is not known, or beyond all numbers.

    `known` definitions precede those of SI.
    """
    symbols = {**SYMBOLS, **known} if known else SYMBOLS
    name = unit if unit in symbols else unicodedata.normalize("NFKC", unit)
    if name in symbols:
        return symbols[name]
    scale, powers = 1.0, [0] * len(BASES)
    for place, part in enumerate(GROUP.sub(r"/\1", name).split("/")):
        for text in re.split(r"[.*·]", part):
            found = FACTOR.fullmatch(text)
            base = symbols.get(found[1] if found else text)
            if base is None:
                return None
            exponent = int((found and found[2]) or 1) * (-1 if place else 1)
            scale *= base.factor**exponent
            powers = [power + exponent * own for power, own in zip(powers, base.powers, strict=True)]
    return Definition(tuple(powers), scale) if 0.0 < scale < math.inf else None


def of_fmu(found: Iterable[Any]) -> dict[str, Definition]:
    """Definitions of an FMU by name, from FMPy's units.

    Some tools omit `rad`; it is added where the definition otherwise is that of SI.
    """
    known = {}
    for unit in (unit for unit in found if unit.baseUnit):
        base, usual = unit.baseUnit, defined(unit.name)
        powers = tuple(getattr(base, name) for name in BASES)
        of_si = usual is not None and math.isclose(usual.factor, base.factor, rel_tol=1e-3)
        if usual and of_si and usual.powers[:-1] == powers[:-1]:
            powers = usual.powers
        if base.factor and math.isfinite(base.factor) and math.isfinite(base.offset):
            known[unit.name] = Definition(powers, base.factor, base.offset)
    return known


SYMBOLS = {ONE: Definition()}
"""Definitions of the symbols with their prefixes, filled below in the order of precedence."""
SI = {base: base for base in BASES}
"""Name of the unit of SI that a symbol is measured in."""


def fill() -> None:
    """Fill the tables of the symbols."""
    for index, base in enumerate(BASES):
        SYMBOLS[base] = Definition(tuple(int(index == place) for place in range(len(BASES))))
    for name, text in DERIVED.items():
        SYMBOLS[name], SI[name] = defined(text) or Definition(), name
    for name, (size, text) in SCALED.items():
        SYMBOLS[name], SI[name] = replace(defined(text) or Definition(), factor=size), text
    for name, (factor, offset) in TEMPERATURES.items():
        SYMBOLS[name] = Definition(SYMBOLS["K"].powers, factor, offset)
    for name, unscaled in [entry for entry in SYMBOLS.items() if entry[0] not in UNSCALED]:
        for prefix, exponent in (PREFIXES | READ_ONLY).items():
            factor = float(f"1e{exponent}") * unscaled.factor
            SYMBOLS.setdefault(prefix + name, replace(unscaled, factor=factor))
            SI.setdefault(prefix + name, SI[name])


fill()
CONSTANTS = {
    name: (text, SYMBOLS[name].factor)
    for name, text in SI.items()
    if name.isidentifier() and name != "min" and (len(name) > 1 or name in "msANVWJK")
}
"""Unit of SI and number of each name in expressions: `5 * um` is 5e-6.

`min` is a function, and other single letters are more likely columns that were meant.
"""
