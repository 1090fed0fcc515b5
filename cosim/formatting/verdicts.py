"""Texts of verdicts: measured value, limits, and the number of passed criteria."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cosim.formatting.quantity import text
from cosim.metrics.criteria import Verdict

STATUSES = {True: "passed", False: "failed", None: "done"}
"""Status of a result by `Result.passed`; `done` without criteria."""

NOTHING_DEMANDED = "no criteria"
COLUMNS = ("claim", "paper", "measured", "limit", "result")
"""Columns of tables of criteria."""


def row(verdict: Verdict, digits: int = 4) -> tuple[str, str, str, str, str]:
    """Cells of a criterion in tables with `COLUMNS`."""
    criterion = verdict.criterion
    return criterion.claim, criterion.paper, measured(verdict, digits), limits(verdict), outcome(verdict)


def columns(verdicts: Iterable[Verdict]) -> tuple[str, ...]:
    """Columns of a table of criteria: without `paper` if no criterion compares with a paper."""
    papers = any(verdict.criterion.paper for verdict in verdicts)
    return tuple(name for name in COLUMNS if papers or name != "paper")


def cells(verdict: Verdict, names: Sequence[str], digits: int = 4) -> list[str]:
    """Cells of a criterion in some of the `COLUMNS`."""
    found = dict(zip(COLUMNS, row(verdict, digits), strict=True))
    return [found[name] for name in names]


def outcome(verdict: Verdict) -> str:
    """Return the result of a criterion."""
    return "passed" if verdict.passed else "FAILED"


def measured(verdict: Verdict, digits: int = 4) -> str:
    """Measured value; of a claim that is true or false, whether it is true."""
    if verdict.logical:
        return "as claimed" if verdict.passed else "not as claimed"
    return text(verdict.value, verdict.unit, digits)


def limits(verdict: Verdict) -> str:
    """Limits of a criterion; empty for a claim that is true or false."""
    if isinstance(verdict.criterion.equals, bool):
        return ""
    if [relation for relation, _ in verdict.limits] == [">=", "<="]:
        return " .. ".join(text(limit, verdict.unit) for _, limit in verdict.limits)
    return " ".join(f"{relation} {text(limit, verdict.unit)}" for relation, limit in verdict.limits)


def counted(verdicts: Sequence[Verdict]) -> str:
    """Return the number of passed criteria."""
    if not verdicts:
        return NOTHING_DEMANDED
    return f"{sum(verdict.passed for verdict in verdicts)} of {len(verdicts)} criteria passed"
