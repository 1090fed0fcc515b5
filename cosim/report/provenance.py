"""Source of the limit of a criterion, as far as the scenario states it."""

from __future__ import annotations

import math
import re

from cosim.metrics.criteria import Verdict
from cosim.units import conversion

SOURCES = {"paper": "from the paper", "prediction": "prediction", "choice": "choice"}
"""Source of a limit, as in the report."""
NUMBER = re.compile(
    r"(?<![\w.])([-+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?)\s*((?!to\b)[A-Za-z%](?:[\w/.%]*[\w%])?)?"
)
RANGE = re.compile(r"\s*(?:to|-|\.\.)\s*")
"""Text between two numbers with a common unit."""


def origin(verdict: Verdict) -> str:
    """Key of `SOURCES`: `source` of the criterion, otherwise derived from the text of the paper.

    Without both it is a choice. From the paper are a claim that is true or false, a limit with a number of
    the paper, and limits around such a number. Another number is a prediction of the models.
    """
    criterion = verdict.criterion
    if criterion.source or not criterion.paper:
        return criterion.source or "choice"
    if isinstance(criterion.equals, bool):
        return "paper"
    published = numbers(criterion.paper, verdict.unit)
    limits = [limit for _, limit in verdict.limits]
    same = any(math.isclose(number, limit, rel_tol=1e-9) for number in published for limit in limits)
    around = len(limits) == 2 and any(limits[0] <= number <= limits[1] for number in published)
    return "paper" if same or around else "prediction"


def numbers(words: str, unit: str) -> list[float]:
    """Find the numbers of a text that convert to a unit; in `50 to 60 mm/s` both are in mm/s."""
    found, behind, begin = [], "", len(words)
    for number in reversed([*NUMBER.finditer(words)]):
        digits, own = number[1], number[2] or ""
        if not own and RANGE.fullmatch(words, number.end(), begin):
            own = behind
        converted = conversion(own or "1", unit or "1")
        if converted is not None:
            found.append(converted(float(digits.replace(",", ""))))
        behind, begin = own, number.start()
    return found[::-1]
