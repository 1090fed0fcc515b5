"""`cosim run --seeds`: many seeds of one scenario in one table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import typer

from cosim.cli.options import COULD_NOT_RUN, FAILED
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.loop.engines import Engine
from cosim.pool.limits import Limits
from cosim.show.console import output, progress_bar, report
from cosim.writing import write


def run_seeds(
    loop: str,
    changes: Sequence[str],
    text: str,
    engine: Engine,
    limits: Limits | None,
    file: str | None,
    quiet: bool,
) -> NoReturn:
    """Run a scenario with several seeds, print the distributions and exit."""
    from cosim.fmu import stale
    from cosim.scenario.load import load
    from cosim.sweep import seeds

    scenario = load(loop, changes)
    stale.warn_of(scenario)
    chosen = seeds.parse(text)
    with progress_bar(f"{scenario.name}, {len(chosen)} seeds", quiet) as progress:
        outcomes = seeds.run(scenario, chosen, engine, limits, progress)
    found = seeds.summarize(chosen, outcomes)
    runs = [seeds.plain(seed, outcome) for seed, outcome in zip(chosen, outcomes, strict=True)]
    if file is not None:
        write(strict.text(runs), file)
    if file != "-":
        output().print(seeds.tables(scenario, found))
    if found.results < found.wanted:
        (_, reason), *_ = found.troubles
        report(f"{found.wanted - found.results} of {found.wanted} runs gave no result; the first: {reason}")
        raise typer.Exit(COULD_NOT_RUN)
    raise typer.Exit(FAILED if found.passed is False else 0)


def check_options(seed: int | None, trace: Path | None, plot: Path | None) -> None:
    """Reject options that apply to one run only."""
    for option, value in (("--seed", seed), ("--trace", trace), ("--plot", plot)):
        if value is not None:
            raise CosimError(
                f"`{option}` and `--seeds` cannot be given together",
                f"Repeat one run with `--seed` to get its {option[2:]}."
                if option != "--seed"
                else "Use `--seed 7` for one run or `--seeds 1..20` for twenty.",
            )
