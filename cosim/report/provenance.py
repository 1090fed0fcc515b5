"""Where the limit of a criterion comes from, as far as the scenario tells."""

from __future__ import annotations

import math
import re

from cosim.metrics.criteria import Verdict
from cosim.metrics.units import conversion

SOURCES = {"paper": "from the paper", "prediction": "prediction", "choice": "our choice"}
"""Where a limit comes from, as the page says it."""
NUMBER = re.compile(
    r"(?<![\w.])([-+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?)\s*((?!to\b)[A-Za-z%](?:[\w/.%]*[\w%])?)?"
)
RANGE = re.compile(r"\s*(?:to|-|\.\.)\s*")
"""What stands between two numbers of which the second tells the unit."""
WORDS = {"min": "minute"}
"""Units of papers that are functions in expressions."""


def origin(verdict: Verdict) -> str:
    """Key of `SOURCES`: what the criterion says itself, else what follows from the words of the paper.

    Without any of them it is our choice. The paper's is a yes or no that it claims, and a limit with a number
    of the paper, or limits around one; another number is what our models predict of what the paper claims.
    """
    criterion = verdict.criterion
    if criterion.source or not criterion.paper:
        return criterion.source or "choice"
    if isinstance(criterion.equals, bool):
        return "paper"
    told = numbers(criterion.paper, verdict.unit)
    limits = [limit for _, limit in verdict.limits]
    same = any(math.isclose(number, limit, rel_tol=1e-9) for number in told for limit in limits)
    around = len(limits) == 2 and any(limits[0] <= number <= limits[1] for number in told)
    return "paper" if same or around else "prediction"


def numbers(words: str, unit: str) -> list[float]:
    """Find the numbers of a text that convert to a unit; in `50 to 60 mm/s` both are in mm/s."""
    found, behind, begin = [], "", len(words)
    for number in reversed([*NUMBER.finditer(words)]):
        digits, own = number[1], number[2] or ""
        if not own and RANGE.fullmatch(words, number.end(), begin):
            own = behind
        factor = conversion(WORDS.get(own, own) or "1", unit or "1")
        if factor is not None:
            found.append(factor * float(digits.replace(",", "")))
        behind, begin = own, number.start()
    return found[::-1]
