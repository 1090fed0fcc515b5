"""Optimization from Python, and its result: table, JSON, and the command that repeats the best trial."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from cosim import paths
from cosim.formatting import html, strict
from cosim.formatting.quantity import number, text
from cosim.formatting.verdicts import STATUSES
from cosim.loop import engines
from cosim.optimize import problem
from cosim.optimize.search import MISFIT, Trial, best_of, search
from cosim.optimize.variants import Variants
from cosim.show.console import progress_bar
from cosim.show.listing import plain_table
from cosim.study.parameters import Vary
from cosim.study.run import text as value_text
from cosim.study.store import opened
from cosim.writing import whole

AT_END = 0.01
"""Fraction of a range within which a value is regarded as its end."""


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
        return best_of(self.variants.problem, self.trials)

    @property
    def command(self) -> str:
        """Command line that repeats the first run of the best trial; empty if there is none."""
        return self.variants.command(self.best.values, self.variants.seeds[0]) if self.best else ""

    def __repr__(self) -> str:
        """One line: study, best value, and the number of trials that passed the criteria."""
        return f"<OptimizeResult of {self.variants.problem.name}: {self.verdict}>"

    @property
    def verdict(self) -> str:
        """Best value or the trial with the smallest violation, and the numbers of trials."""
        objective, best = self.variants.problem.objective, self.best
        counts = f"{len(self.trials)} trials"
        if not objective.trace:
            counts += f", {self.feasible} of them passed all criteria"
        known = [trial for trial in self.trials if trial.score.value is not None]
        if lost := len(self.trials) - len(known):
            counts += f", {lost} without a result"
        if best is None or best.score.value is None:
            trial = min(known, key=lambda trial: sum(trial.score.violations))
            pairs = zip(self.variants.scenario.criterion, trial.score.violations, strict=True)
            failed = ", ".join(f"`{entry.id}`" for entry, violation in pairs if violation > 0.0)
            closest = f"closest is trial {trial.number}, which fails {failed}"
            return f"no trial passed all criteria: {closest}; {counts}"
        if objective.trace:
            off = 100.0 * math.sqrt(best.score.value)
            value = f"{MISFIT} {number(best.score.value)}: {number(off, 3)} % of a standard deviation"
        else:
            metrics = self.variants.scenario.metric
            unit = next((metric.unit for metric in metrics if metric.name == objective.metric), "")
            extreme = objective.direction.removesuffix("ize")
            value = f"{extreme}um of {objective.metric}: {text(best.score.value, unit)}"
        return f"{value}, in trial {best.number}; {counts}"

    @property
    def feasible(self) -> int:
        """Number of trials that passed all criteria."""
        return sum(trial.score.feasible for trial in self.trials)

    def tables(self) -> RenderableType:
        """Values of the best trial and the verdict, for the terminal."""
        title = Text(self.variants.problem.full_title, style="bold")
        if self.best is None:
            return Group(title, "", Text(self.verdict, style="bold red"))
        table = plain_table("key", "best value", "range", "")
        for vary in self.variants.problem.vary:
            value = self.best.values[vary.key]
            edge = "at the end of its range" if at_end(vary, value) else ""
            shown = number(value, 6) if isinstance(value, float) else value_text(value)
            values = " ".join(map(value_text, vary.values)) or " .. ".join(f"{end:g}" for end in vary.range)
            table.add_row(Text(vary.key), Text(shown), Text(values), edge)
        return Group(title, "", table, "", Text(self.verdict, style="bold green"))

    def _repr_html_(self) -> str:
        """Table of the best values for a notebook."""
        rows = [(key, str(value)) for key, value in (self.best.values.items() if self.best else ())]
        heading = html.heading(self.variants.problem.full_title, self.verdict)
        return "\n".join([heading, html.table(("key", "best value"), rows)])

    def to_json(self) -> str:
        """Return the best trial and the numbers of trials in strict JSON."""
        objective, best = self.variants.problem.objective, self.best
        found = {
            "status": STATUSES[best is not None],
            "objective": objective.metric or MISFIT,
            "direction": objective.direction,
            "trials": len(self.trials),
            "feasible": self.feasible,
            "best": None,
        }
        if best is not None:
            value = {"trial": best.number, "value": best.score.value or 0.0, "set": best.values}
            found["best"] = {**value, "command": self.command}
        return strict.text(found)

    def save_csv(self, file: Path) -> None:
        """Write all trials: number, values, objective, and whether all criteria passed."""
        keys = [vary.key for vary in self.variants.problem.vary]
        objective = self.variants.problem.objective.metric or MISFIT
        with whole(file) as part, part.open("w", newline="", encoding="utf-8") as lines:
            writer = csv.writer(lines)
            writer.writerow(["trial", *keys, objective, "feasible", "reason"])
            for trial in self.trials:
                values = [value_text(trial.values[key]) for key in keys]
                feasible = str(trial.score.feasible).lower()
                writer.writerow([trial.number, *values, trial.score.value, feasible, trial.score.reason])


def at_end(vary: Vary, value: Any) -> bool:
    """Whether the best value is at an end of its range, so that a better one may be outside."""
    if vary.values:
        return False
    low, high = vary.range
    if vary.distribution == "log-uniform":
        low, high, value = math.log(low), math.log(high), math.log(value)
    return bool(min(value - low, high - value) <= AT_END * (high - low))


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
    selected = engines.checked(engine)
    variants = Variants(problem.load(paths.find_study(str(study))))
    name, file = variants.problem.name, variants.problem.file
    with opened(file, out, f"{name}.optimize") as store, progress_bar(name, quiet) as progress:
        trials = search(variants, store, progress, workers, selected, again)
    found = OptimizeResult(variants, store.folder, trials)
    found.save_csv(store.folder / "trials.csv")
    return found
