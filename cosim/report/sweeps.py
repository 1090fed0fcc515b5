"""What a page tells of one sweep, as plain data."""

from __future__ import annotations

import base64
import shlex
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.report import charts
from cosim.show.figure import can_plot
from cosim.sweep import overview, study
from cosim.sweep.check import check_charts
from cosim.sweep.command import Options, run_study
from cosim.sweep.plan import Plan
from cosim.sweep.store import Store, folder_of
from cosim.sweep.survey import QUANTILES, Survey, columns, quantiles, results
from cosim.words.quantity import text


def check(file: Path) -> None:
    """Check before long runs that a study can be run and drawn.

    Raises
    ------
    CosimError
        The study, a case or a chart of it is wrong.
    """
    check_charts(Plan(study.load(paths.find_study(str(file)))))


def told(file: Path, workers: int | None, engine: str, quiet: bool) -> dict[str, Any]:
    """Do what is left of a study, as `cosim sweep` does, and tell all of it."""
    folder = folder_of(None, Path(f"{file.stem}.sweep"))
    options = Options(file, folder, workers, engine=engine, plots=can_plot(), quiet=quiet)

    def tell(plan: Plan, store: Store, found: Survey) -> dict[str, Any]:
        known = columns(plan.scenario, plan.cases)
        drawn, undrawn = charts.of_columns(plan.study.charts, results(found, known), known, file.parent)
        drawing = store.folder / "summary.svg"
        return {
            "name": file.stem,
            "title": plan.study.title or plan.study.name,
            "story": [part for part in plan.study.description.split("\n\n") if part.strip()],
            "command": f"cosim sweep {shlex.quote(str(file))}",
            "verdict": overview.verdict(found).plain,
            "passed": found.passed,
            "tables": tables(found),
            "charts": drawn,
            "undrawn": undrawn,
            "drawing": base64.b64encode(drawing.read_bytes()).decode() if drawing.is_file() else "",
        }

    return run_study(options, tell)


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
