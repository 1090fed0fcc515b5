"""Two results of runs: their metrics and verdicts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.compare.comparison import Comparison
from cosim.compare.tolerance import Tolerances
from cosim.errors import CosimError

HINT = "Use a file of `cosim run --json`."


def read(path: Path) -> dict[str, Any]:
    """Read the JSON file of a result."""
    shown = paths.shown(path)
    try:
        found: Any = json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise CosimError(f"cannot read `{shown}`: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise CosimError(f"`{shown}` is not a result: {error}", HINT) from None
    table: dict[str, Any] = found if isinstance(found, dict) else {}
    metrics, criteria = table.get("metrics"), table.get("criteria")
    if not isinstance(metrics, dict) or not isinstance(criteria, list):
        raise CosimError(f"`{shown}` is not a result: it has no `metrics` and `criteria`", HINT)
    tables = all(isinstance(entry, dict) for entry in (*metrics.values(), *criteria))
    if not tables or not all(isinstance(entry.get("id"), str) for entry in criteria):
        raise CosimError(f"`{shown}` is not a result: its metrics and criteria are not tables", HINT)
    return table


def compare(
    reference: dict[str, Any], other: dict[str, Any], allowed: Tolerances, names: tuple[str, str]
) -> Comparison:
    """Compare a result with a reference, both as `read` gives them; `names` are their names."""
    found = Comparison("results", *names)
    metrics, others = reference["metrics"], other["metrics"]
    if not metrics:
        raise CosimError(f"`{names[0]}` has no metrics to compare")
    for name in allowed.chosen(metrics):
        if name not in others:
            found.differences.append(f"the metric `{name}` is missing")
            continue
        old, new = metrics[name], others[name]
        units = str(old.get("unit", "")), str(new.get("unit", ""))
        found.add_metric(name, units, ([old.get("value")], [new.get("value")]), allowed)
    found.note_extra(metrics, others, allowed)
    if allowed.only:
        return found
    verdicts = {entry["id"]: bool(entry.get("passed")) for entry in other["criteria"]}
    for entry in reference["criteria"]:
        name, passed = entry["id"], verdicts.get(entry["id"])
        if passed is None:
            found.differences.append(f"the criterion `{name}` is missing")
        elif passed != bool(entry.get("passed")):
            verdict, before = ("passed", "failed") if passed else ("failed", "passed")
            found.differences.append(f"the criterion `{name}` {verdict}, but {before} in the reference")
    return found
