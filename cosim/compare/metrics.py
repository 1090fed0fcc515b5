"""Metrics of two results, or of two sweeps run by run."""

from __future__ import annotations

import json
import logging
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from cosim import paths
from cosim.compare.comparison import Comparison
from cosim.errors import CosimError
from cosim.study.store import FILE, Row

HINT = "Use a file of `cosim run --json`."

log = logging.getLogger("cosim")


def read_result(path: Path) -> dict[str, Any]:
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


def compare_results(found: Comparison, reference: dict[str, Any], other: dict[str, Any]) -> None:
    """Compare a result with a reference, both as `read_result` returns them."""
    metrics, others = reference["metrics"], other["metrics"]
    if not metrics:
        raise CosimError(f"`{found.reference}` has no metrics to compare")
    for name in found.allowed.chosen(metrics):
        if name not in others:
            found.differences.append(f"the metric `{name}` is missing")
            continue
        old, new = metrics[name], others[name]
        units = str(old.get("unit", "")), str(new.get("unit", ""))
        found.add_metric(name, units, ([old.get("value")], [new.get("value")]))
    found.note_extra(metrics, others)
    if found.allowed.only:
        return
    verdicts = {entry["id"]: bool(entry.get("passed")) for entry in other["criteria"]}
    for entry in reference["criteria"]:
        name, passed = entry["id"], verdicts.get(entry["id"])
        if passed is None:
            found.differences.append(f"the criterion `{name}` is missing")
        elif passed != bool(entry.get("passed")):
            verdict, before = ("passed", "failed") if passed else ("failed", "passed")
            found.differences.append(f"the criterion `{name}` {verdict}, but {before} in the reference")


def read_sweep(folder: Path) -> list[Row]:
    """Read the rows of a sweep, the last one of each run, in the order of the runs."""
    file = folder / FILE
    try:
        lines = file.read_bytes().splitlines()
    except OSError as error:
        hint = f"Use the folder of a sweep, which holds `{FILE}`."
        raise CosimError(f"cannot read `{paths.shown(file)}`: {error.strerror or error}", hint) from None
    found: dict[str, Row] = {}
    for number, line in enumerate(lines, start=1):
        try:
            row = json.loads(line)
            row["run"], row["hash"], row["status"] = int(row["run"]), str(row["hash"]), str(row["status"])
            row["metrics"], row["units"] = dict(row.get("metrics", {})), dict(row.get("units", {}))
        except (ValueError, KeyError, TypeError, RecursionError):
            log.warning("line %d of `%s` is not a row and is skipped", number, paths.shown(file))
            continue
        # the last row of a run is valid: rows of earlier versions of the program stay in the file
        found.pop(case_of(row), None)
        found[case_of(row)] = row
    if not found:
        raise CosimError(f"`{paths.shown(file)}` has no rows")
    return sorted(found.values(), key=lambda row: int(row["run"]))


def compare_sweeps(found: Comparison, reference: list[Row], other: list[Row]) -> None:
    """Compare the runs of a sweep with those of a reference.

    Two runs are a pair if they have the same hash. Otherwise, for example after a change of the program,
    they are a pair if they have the same settings and the same seed.
    """
    pairs, missing, extra = matched(reference, other)
    if not pairs:
        hint = "Compare sweeps with equal hashes, or with equal settings and seeds."
        raise CosimError(f"no run of `{found.reference}` is in `{found.other}`", hint)
    if missing:
        text = f"{runs(missing)} missing, the first is run {missing[0]['run']} of the reference"
        found.differences.append(text)
    if extra:
        found.notes.append(f"{runs(extra)} not in the reference")
    changed: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for old, new in pairs:
        if old["status"] != new["status"]:
            changed[old["status"], new["status"]].append(old)
    for (before, now), rows in changed.items():
        text = f"{runs(rows)} `{now}` instead of `{before}`, the first is run {rows[0]['run']}"
        found.differences.append(text)
    known = list(dict.fromkeys(name for old, _ in pairs for name in old["metrics"]))
    if not known and not found.differences:
        raise CosimError(f"the runs of `{found.reference}` have no metrics to compare")
    for name in found.allowed.chosen(known):
        compare_metric(found, name, pairs)


def matched(reference: list[Row], other: list[Row]) -> tuple[list[tuple[Row, Row]], list[Row], list[Row]]:
    """Pairs of equal runs, and the runs that are only in one of the sweeps."""
    by_hash = {row["hash"]: row for row in other}
    by_case = {case_of(row): row for row in other}
    partners = [(row, by_hash.get(row["hash"]) or by_case.get(case_of(row))) for row in reference]
    pairs = [(row, partner) for row, partner in partners if partner]
    missing = [row for row, partner in partners if not partner]
    taken = {partner["hash"] for _, partner in pairs}
    return pairs, missing, [row for row in other if row["hash"] not in taken]


def case_of(row: Row) -> str:
    """Return the settings and seed of a run."""
    return json.dumps([row.get("set"), row.get("seed")], sort_keys=True)


def compare_metric(found: Comparison, name: str, pairs: list[tuple[Row, Row]]) -> None:
    """Compare a metric over all runs in which both have it."""
    both = [(old, new) for old, new in pairs if name in old["metrics"] and new["metrics"]]
    if not any(name in new["metrics"] for _, new in both):
        found.differences.append(f"the metric `{name}` is missing")
        return
    (old, new), *_ = both
    units = str(old["units"].get(name, "")), str(new["units"].get(name, ""))
    before, now = ([row["metrics"].get(name) for row in rows] for rows in zip(*both, strict=True))
    numbers = np.array([float(old["run"]) for old, _ in both])
    found.add_metric(name, units, (before, now), numbers)


def runs(rows: list[Any]) -> str:
    """Count runs, with the verb."""
    return f"{len(rows)} run is" if len(rows) == 1 else f"{len(rows)} runs are"
