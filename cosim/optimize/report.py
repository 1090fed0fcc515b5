"""Results of an optimization: table, JSON, and the command that repeats the best trial."""

from __future__ import annotations

import csv
import math
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from cosim import paths
from cosim.formatting import strict
from cosim.formatting.quantity import number, text
from cosim.formatting.verdicts import STATUSES
from cosim.optimize.objective import MISFIT
from cosim.optimize.proposer import Trial
from cosim.optimize.search import best
from cosim.optimize.variants import Variants
from cosim.show.listing import plain_table
from cosim.study.parameters import Vary
from cosim.study.run import text as value_text
from cosim.writing import whole

AT_END = 0.01
"""Fraction of a range within which a value is regarded as its end."""


def unit_of(variants: Variants) -> str:
    """Find the unit of the objective, if the metric has one."""
    wanted = variants.problem.objective.metric
    return next((entry.unit for entry in variants.scenario.metric if entry.name == wanted), "")


def command(variants: Variants, trial: Trial) -> str:
    """Command line that repeats the first run of a trial."""
    changes = {**variants.problem.set, **trial.values}
    options = [shlex.quote(f"{key}={value_text(value)}") for key, value in changes.items()]
    named = shlex.quote(variants.problem.scenario)
    if variants.problem.scenario.endswith(".toml"):
        named = shlex.quote(paths.shown(variants.file))
    return " ".join(
        ["cosim run", named, *(f"--set {option}" for option in options), f"--seed {variants.seeds[0]}"]
    )


def tables(variants: Variants, trials: Sequence[Trial]) -> RenderableType:
    """Values of the best trial and its score."""
    problem = variants.problem
    parts: list[RenderableType] = [Text(problem.title or problem.name, style="bold"), ""]
    found = best(problem, trials)
    if found is not None and found.score.value is not None:
        table = plain_table("key", "best value", "range", "")
        for vary in problem.vary:
            value = found.values[vary.key]
            edge = "at the end of its range" if at_end(vary, value) else ""
            shown = number(value, 6) if isinstance(value, float) else value_text(value)
            table.add_row(Text(vary.key), Text(shown), Text(range_text(vary)), edge)
        parts += [table, ""]
    return Group(*parts, verdict(variants, trials))


def verdict(variants: Variants, trials: Sequence[Trial]) -> Text:
    """One line: the best value, and the number of trials that passed the criteria."""
    objective, found = variants.problem.objective, best(variants.problem, trials)
    feasible = sum(trial.score.feasible for trial in trials)
    lost = sum(trial.score.value is None for trial in trials)
    counts = f"{len(trials)} trials"
    if not objective.trace:
        counts += f", {feasible} of them passed all criteria"
    if lost:
        counts += f", {lost} without a result"
    if found is None or found.score.value is None:
        return Text(f"no trial passed all criteria: {nearest(variants, trials)}; {counts}", style="bold red")
    if objective.trace:
        off = math.sqrt(found.score.value)
        what = f"{MISFIT} {number(found.score.value)}: {number(100.0 * off, 3)} % of a standard deviation"
    else:
        value = text(found.score.value, unit_of(variants))
        what = f"{objective.direction.removesuffix('ize')}um of {objective.metric}: {value}"
    return Text(f"{what}, in trial {found.number}; {counts}", style="bold green")


def nearest(variants: Variants, trials: Sequence[Trial]) -> str:
    """Name the trial with the smallest violation, and its failed criteria."""
    trial = min((t for t in trials if t.score.value is not None), key=lambda t: sum(t.score.violations))
    pairs = zip(variants.scenario.criterion, trial.score.violations, strict=True)
    broken = ", ".join(f"`{entry.id}`" for entry, violation in pairs if violation > 0.0)
    return f"closest is trial {trial.number}, which fails {broken}"


def range_text(vary: Vary) -> str:
    """Range of a key, or its values."""
    if vary.values:
        return " ".join(value_text(value) for value in vary.values)
    return " .. ".join(f"{end:g}" for end in vary.range)


def at_end(vary: Vary, value: Any) -> bool:
    """Whether the best value is at an end of its range, so that a better one may be outside."""
    if vary.values:
        return False
    low, high = vary.range
    if vary.distribution == "log-uniform":
        low, high, value = math.log(low), math.log(high), math.log(value)
    return bool(min(value - low, high - value) <= AT_END * (high - low))


def to_json(variants: Variants, trials: Sequence[Trial]) -> str:
    """Return the best trial and is taken as strict JSON."""
    found = best(variants.problem, trials)
    objective = variants.problem.objective
    content = {
        "status": STATUSES[found is not None],
        "objective": objective.metric or MISFIT,
        "direction": objective.direction,
        "trials": len(trials),
        "feasible": sum(trial.score.feasible for trial in trials),
        "best": None
        if found is None
        else {
            "trial": found.number,
            "value": found.score.value or 0.0,
            "set": found.values,
            "command": command(variants, found),
        },
    }
    return strict.text(content)


def save_csv(variants: Variants, trials: Sequence[Trial], file: Path) -> None:
    """Write all trials: number, values, objective, and whether all criteria passed.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    keys = [vary.key for vary in variants.problem.vary]
    with whole(file) as part, part.open("w", newline="", encoding="utf-8") as lines:
        writer = csv.writer(lines)
        writer.writerow(["trial", *keys, variants.problem.objective.metric or MISFIT, "feasible", "reason"])
        for trial in trials:
            values = [value_text(trial.values[key]) for key in keys]
            held = str(trial.score.feasible).lower()
            writer.writerow([trial.number, *values, trial.score.value, held, trial.score.reason])
