"""Tolerances: `VALUE` for all names, `PATTERN=VALUE` for the names that match a pattern."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from fnmatch import fnmatchcase

from cosim.errors import CosimError, closest

EVERYTHING = "*"
Limit = tuple[str, float]
"""A pattern of names, and the number for the names that match it."""


@dataclass(frozen=True)
class Tolerances:
    """Tolerances by name; the last match is used.

    `atol` is in the unit of the quantity, `rtol` relative to the reference, `dt` a time shift in s. `only`
    are the patterns of the compared names, empty for all.
    """

    atol: tuple[Limit, ...] = ()
    rtol: tuple[Limit, ...] = ()
    dt: tuple[Limit, ...] = ()
    only: tuple[str, ...] = ()

    def of(self, name: str) -> tuple[float, float, float]:
        """Absolute and relative tolerance of a name, and its time shift."""
        atol, rtol, dt = (
            next((value for pattern, value in reversed(limits) if fits(name, pattern)), 0.0)
            for limits in (self.atol, self.rtol, self.dt)
        )
        return atol, rtol, dt

    def chosen(self, names: Iterable[str]) -> list[str]:
        """Names that are compared; a pattern that matches none is an error."""
        known = list(names)
        limits = {"--atol": self.atol, "--rtol": self.rtol, "--dt": self.dt}
        given = [("--only", pattern) for pattern in self.only]
        given += [(option, pattern) for option, found in limits.items() for pattern, _ in found]
        for option, pattern in given:
            if pattern != EVERYTHING and not any(fits(name, pattern) for name in known):
                problem = f"`{option} {pattern}` matches none of the compared names"
                raise CosimError(problem, closest(pattern, known))
        return [name for name in known if not self.only or any(fits(name, p) for p in self.only)]


def tolerances(atol: list[str], rtol: list[str], dt: list[str], only: list[str]) -> Tolerances:
    """Tolerances from the texts of the command line."""
    return Tolerances(
        tuple(limit("--atol", text, math.inf) for text in atol),
        tuple(limit("--rtol", text, 1.0) for text in rtol),
        tuple(limit("--dt", text, math.inf) for text in dt),
        tuple(only),
    )


def limit(option: str, text: str, below: float) -> Limit:
    """Return the limit of `VALUE` or `PATTERN=VALUE`."""
    pattern, _, number = text.rpartition("=")
    try:
        value = float(number)
    except ValueError:
        hint = f"Use, for example, `{option} 1e-6` or `{option} 'plant.*=1e-6'`."
        raise CosimError(f"`{option} {text}` does not end in a number", hint) from None
    if not 0.0 <= value < below:
        bound = "finite" if math.isinf(below) else f"below {below:g}"
        raise CosimError(f"`{option} {text}` is out of range: it must not be negative, and {bound}")
    return pattern.strip() or EVERYTHING, value


def fits(name: str, pattern: str) -> bool:
    """Whether a name matches a pattern: `*` is any text, `?` one character; brackets are literal."""
    return fnmatchcase(name, pattern.replace("[", "[[]"))
