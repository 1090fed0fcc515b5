"""`cosim optimize`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from cosim import paths
from cosim.cli import complete
from cosim.cli.options import FAILED, Again, Engine, Json, Quiet, Verbose, Workers
from cosim.show.console import configure_logging, output
from cosim.writing import write


def optimize(
    study: Annotated[
        Path,
        Argument(
            metavar="STUDY.toml",
            help="Scenario, variables and objective.",
            autocompletion=complete.studies,
        ),
    ],
    out: Annotated[
        str | None, Option("-o", "--out", metavar="FOLDER", help="Results; default `STUDY.optimize`.")
    ] = None,
    workers: Workers = None,
    engine: Engine = "native",
    again: Again = False,
    json: Json = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Find parameters that optimize a metric.

    The objective can also be the agreement with a measured trace. The file is
    similar to a study of `cosim sweep`, with an objective in place of a design:

    \b
        scenario = "crane"
        vary = [{key = "controller.gain", minimum = 0.1, maximum = 10.0}]
        objective = {metric = "sway", direction = "minimize"}
        search = {trials = 100, batch = 8, seeds = [1, 2]}
        limits = {timeout = 600.0, memory = 2000.0}

    The criteria of the scenario are constraints. To calibrate parameters, name a
    measured trace:

    \b
        objective = {trace = "measured.csv", columns = ["plant.x"]}

    All keys of search and limits are optional. batch is the number of points that
    are proposed at a time. Several seeds are averaged. timeout (s) and memory (MB)
    apply to each run.

    Optuna proposes the points. The same file gives the same trials with any
    number of workers. Completed runs are not repeated: the command continues
    after an interruption, or with more trials. The folder holds
    results.jsonl, with a row for each run, and trials.csv.

    Exit code: 0 found, 1 no trial passed all criteria, 2 could not run.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    configure_logging(verbose, quiet)
    from cosim.optimize import results

    found = results.optimize(study, out, workers=workers, engine=engine, again=again, quiet=quiet)
    if json is not None:
        write(found.to_json(), json)
    if json != "-":
        output().print(found.tables())
        # for copying: never wrapped
        if found.best is not None:
            print(f"repeat it with: {found.command}")
        print(f"wrote {paths.shown(found.folder)}")
    raise typer.Exit(FAILED if found.best is None else 0)
