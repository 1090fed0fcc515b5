"""Optimization from Python, and its result."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cosim import paths
from cosim.formatting import html
from cosim.loop import engines
from cosim.optimize import problem, report, search
from cosim.optimize.proposer import Trial
from cosim.optimize.runner import SearchOptions
from cosim.optimize.variants import Variants
from cosim.show.console import progress_bar
from cosim.study.store import opened


@dataclass(frozen=True, repr=False)
class OptimizeResult:
    """Result of an optimization.

    Parameters
    ----------
    variants
        The scenario with any values; `variants.at(trial.values)` is that of a trial.
    folder
        Folder of `results.jsonl` (a row for each run) and `trials.csv`.
    trials
        All trials: number, values, and `score` with value, violations and reason.
    """

    variants: Variants
    folder: Path
    trials: list[Trial]

    @property
    def best(self) -> Trial | None:
        """Best trial that passed all criteria; None if there is none."""
        return search.best(self.variants.problem, self.trials)

    @property
    def command(self) -> str:
        """Command line that repeats the first run of the best trial; empty if there is none."""
        return report.command(self.variants, self.best) if self.best else ""

    def __repr__(self) -> str:
        """One line: study, best value, and the number of trials that passed the criteria."""
        return f"<OptimizeResult of {self.variants.problem.name}: {self.verdict}>"

    @property
    def verdict(self) -> str:
        """Best value, and the number of trials that passed the criteria."""
        return report.verdict(self.variants, self.trials).plain

    def _repr_html_(self) -> str:
        """Table of the best values for a notebook."""
        wanted, best = self.variants.problem, self.best
        rows = [(key, str(value)) for key, value in (best.values.items() if best else ())]
        table = html.table(("key", "best value"), rows)
        return "\n".join([html.heading(wanted.title or wanted.name, self.verdict), table])


def optimize(
    study: str | Path,
    out: str | Path | None = None,
    *,
    workers: int | None = None,
    engine: str = "native",
    again: bool = False,
    quiet: bool = True,
) -> OptimizeResult:
    """Find the values of keys that optimize a metric; completed runs are not repeated.

    Parameters
    ----------
    study
        File of the optimization.
    out
        Folder of the results, by default `<study>.optimize` in the working directory.
    workers
        Number of worker processes; None is one per core. The trials do not depend on it.
    engine
        `native` or `reference`.
    again
        Whether to repeat runs without a result.
    quiet
        Whether to hide the progress on stderr.

    Raises
    ------
    CosimError
        The file is wrong, Optuna is not installed, the folder cannot be written, or no trial gave a number.
    """
    options = SearchOptions(workers, engines.checked(engine), again)
    variants = Variants(problem.load(paths.find_study(str(study))))
    name, file = variants.problem.name, variants.problem.file
    with opened(file, out, f"{name}.optimize") as store, progress_bar(name, quiet) as progress:
        trials = search.search(variants, store, options, progress)
    report.save_csv(variants, trials, store.folder / "trials.csv")
    return OptimizeResult(variants, store.folder, trials)
