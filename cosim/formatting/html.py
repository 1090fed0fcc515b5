"""Tables for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape

from cosim.formatting.quantity import text
from cosim.formatting.verdicts import cells, columns
from cosim.metrics.criteria import Measured, Verdict


def run(title: str, line: str, metrics: Mapping[str, Measured], verdicts: Sequence[Verdict]) -> str:
    """Title and summary of one run, its criteria, and the metrics without a criterion."""
    held = {verdict.criterion.metric for verdict in verdicts}
    free = [metric for metric in metrics.values() if metric.name not in held]
    parts = [heading(title, line)]
    if verdicts:
        names = columns(verdicts)
        parts.append(table(names, [cells(verdict, names) for verdict in verdicts]))
    if free:
        rows = [(metric.name, text(metric.value, metric.unit), metric.description) for metric in free]
        parts.append(table(("metric", "value", "description"), rows))
    return "\n".join(parts)


def heading(title: str, line: str) -> str:
    """Bold title with a line below."""
    return f"<p><b>{escape(title)}</b><br>{escape(line)}</p>"


def table(names: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Table of texts."""
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
