"""Verdicts in words: what was measured, the limits it was held against, how many criteria hold."""

from __future__ import annotations

from collections.abc import Sequence

from cosim.formatting.quantity import text
from cosim.metrics.criteria import Verdict

NOTHING_DEMANDED = "no criteria: nothing was demanded"


def row(verdict: Verdict, digits: int = 4) -> tuple[str, str, str, str, str]:
    """Claim, paper, measured, limit and pass, as tables of criteria show them."""
    criterion = verdict.criterion
    passed = "yes" if verdict.passed else "NO"
    return criterion.claim, criterion.paper, measured(verdict, digits), limits(verdict), passed


def measured(verdict: Verdict, digits: int = 4) -> str:
    """Value that was held against the limits; yes or no where the limit is."""
    if verdict.logical:
        return "yes" if verdict.value else "no"
    return text(verdict.value, verdict.unit, digits)


def limits(verdict: Verdict) -> str:
    """Limits of a criterion."""
    if isinstance(verdict.criterion.equals, bool):
        return "= yes" if verdict.criterion.equals else "= no"
    if [relation for relation, _ in verdict.limits] == [">=", "<="]:
        return " .. ".join(text(limit, verdict.unit) for _, limit in verdict.limits)
    return " ".join(f"{relation} {text(limit, verdict.unit)}" for relation, limit in verdict.limits)


def counted(verdicts: Sequence[Verdict]) -> str:
    """How many of the criteria hold."""
    count, failed = len(verdicts), sum(not verdict.passed for verdict in verdicts)
    if not count:
        return NOTHING_DEMANDED
    if failed:
        return f"{failed} of {count} criteria do not hold"
    return f"all {count} criteria hold" if count > 1 else "the criterion holds"
