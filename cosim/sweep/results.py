"""A sweep from Python, and its result."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cosim.formatting import html
from cosim.formatting.frame import dataframe
from cosim.study.store import Row, Store
from cosim.sweep import summary_tables
from cosim.sweep.command import Options, run_study
from cosim.sweep.plan import Plan
from cosim.sweep.summary import QUANTILES, Summary, rows, spread


@dataclass(frozen=True, repr=False)
class SweepResult:
    """Result of a sweep.

    Parameters
    ----------
    study
        Title of the study, or its name.
    folder
        Folder of `results.jsonl`, tables, plots and traces.
    summary
        Counts, quantiles and runs without result.
    rows
        One row per run: run, case, seed, status, reason, settings, metrics, criteria, times, hash.
    """

    study: str
    folder: Path
    summary: Summary
    rows: list[Row]

    @property
    def passed(self) -> bool | None:
        """Whether every run of the study passed; None if all were completed without criteria."""
        return self.summary.passed

    def __len__(self) -> int:
        """Count the rows."""
        return len(self.rows)

    def __repr__(self) -> str:
        """One line: study and number of passed runs."""
        return f"<SweepResult of {self.study}: {summary_tables.verdict(self.summary).plain}>"

    def _repr_html_(self) -> str:
        """Tables for a notebook: criteria and the distribution of the metrics."""
        found = self.summary
        held = [(name, f"{count} of {found.results}") for name, count in found.held.items()]
        parts = [
            html.heading(self.study, summary_tables.verdict(found).plain),
            html.table(("criterion", "passed in"), held),
            html.table(("metric", *QUANTILES), spread(found)),
        ]
        return "\n".join(parts)

    def to_dataframe(self) -> Any:
        """Return the table of all rows as a `pandas.DataFrame`, the same as `summary.csv`.

        Raises
        ------
        CosimError
            pandas is not installed.
        """
        units = {f"metric.{name}": unit for name, unit in self.summary.units.items()}
        return dataframe(self.summary.columns, units)


def sweep(
    study: str | Path,
    out: str | Path | None = None,
    *,
    workers: int | None = None,
    engine: str = "native",
    again: bool = False,
    plots: bool = False,
    quiet: bool = True,
    part: str = "",
) -> SweepResult:
    """Run the cases of a study in parallel; completed runs are not repeated.

    Parameters
    ----------
    study
        File of the study.
    out
        Folder of the results, by default `<study>.sweep` in the working directory.
    workers
        Number of worker processes on this machine; None is one per core.
    engine
        `native` or `reference`.
    again
        Whether to repeat runs without a result.
    plots
        Whether to make plots, if matplotlib is installed.
    quiet
        Whether to hide the progress on stderr.
    part
        Part of the runs, such as `2/8`; all by default. `cosim sweep merge` merges the folders.

    Raises
    ------
    CosimError
        The study is wrong, the folder cannot be written, or no worker can be started.
    """
    options = Options(Path(study), out, workers, engine, again, plots, quiet, part=part)

    def collect(plan: Plan, store: Store, found: Summary) -> SweepResult:
        return SweepResult(plan.study.full_title, store.folder, found, list(rows(plan, store)))

    return run_study(options, collect)
