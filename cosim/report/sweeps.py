"""What a page tells of one sweep, as plain data."""

from __future__ import annotations

import base64
import shlex
from pathlib import Path
from typing import Any

from cosim.show.figure import can_plot
from cosim.sweep import overview
from cosim.sweep.results import sweep
from cosim.sweep.survey import QUANTILES, Survey, quantiles
from cosim.words.quantity import text


def told(study: Path, workers: int | None, engine: str, quiet: bool) -> dict[str, Any]:
    """Do what is left of a study, as `cosim sweep` does, and tell all of it."""
    done = sweep(study, workers=workers, engine=engine, plots=can_plot(), quiet=quiet)
    drawing = done.folder / "summary.svg"
    return {
        "name": study.stem,
        "title": done.study,
        "command": f"cosim sweep {shlex.quote(str(study))}",
        "verdict": overview.verdict(done.survey).plain,
        "passed": done.passed,
        "tables": tables(done.survey),
        "drawing": base64.b64encode(drawing.read_bytes()).decode() if drawing.is_file() else "",
    }


def tables(found: Survey) -> list[dict[str, Any]]:
    """Criteria, distributions of the metrics, and what gave no result; only those that hold something."""
    held = [(name, f"{count} of {found.results}") for name, count in found.held.items()]
    spread = [
        (name, *(text(value, found.units[name]) for value in quantiles(values).values()))
        for name, values in found.values.items()
    ]
    lost = [
        (status, str(count), str(first), reason)
        for (status, reason), (count, first) in found.troubles.items()
    ]
    every = (
        (("criterion", "holds in"), held),
        (("metric", *QUANTILES), spread),
        (("without result", "runs", "first run", "reason"), lost),
    )
    return [{"names": names, "rows": rows} for names, rows in every if rows]
