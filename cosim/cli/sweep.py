"""`cosim sweep` and `cosim optimize`: the runs of a study."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Argument, Option

from cosim import paths
from cosim.cli import complete, options
from cosim.errors import CosimError
from cosim.show.console import report


def study_argument(metavar: str, help_text: str) -> Any:
    """Argument for the file of a study."""
    return Argument(metavar=metavar, help=help_text, autocompletion=complete.studies)


def folder_option(ending: str) -> Any:
    """Option for the folder of a study."""
    return options.out_option("FOLDER", f"Folder of results; default `STUDY.{ending}`.")


def sweep(
    study: Annotated[
        list[Path],
        study_argument("STUDY.toml|merge FOLDER...", "A study, or `merge` and the folders of its parts."),
    ],
    out: Annotated[str | None, folder_option("sweep")] = None,
    workers: options.Workers = None,
    engine: options.Engine = "native",
    part: Annotated[
        str, Option(metavar="I/N", help="Run only part I of N; the default folder is `STUDY.I-of-N.sweep`.")
    ] = "",
    again: options.Again = False,
    plots: options.Plots = True,
    json: options.Json = None,
) -> None:
    """Run the cases of a study in parallel.

    Completed runs are not repeated: the command continues an interrupted sweep.
    To use several machines, run one part on each, then merge the folders. The
    result is that of an undivided sweep:

    \b
        cosim sweep STUDY.toml --part 1/20
        cosim sweep merge FOLDER... -o FOLDER

    Exit code: 0 all criteria passed, 1 a criterion failed, 2 no run gave a result.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    from cosim.sweep import command

    file, *folders = study
    merged = tuple(folders) if str(file) == "merge" else ()
    if str(file) == "merge":
        if part:
            raise CosimError("`--part` and `merge` cannot be given together", "Omit `--part`.")
        file = command.of_parts(merged)
    elif folders:
        raise CosimError(f"`{folders[0]}` is a second study", "Give one study.")
    quiet = options.quiet()
    chosen = command.Options(file, out, workers, engine, again, plots, quiet, part=part, merged=merged)
    found, tables = command.execute(chosen)
    options.emit(json, found.to_json(), tables, f"wrote {paths.shown(Path(out or chosen.default))}")
    if not found.results:
        (_, reason), *_ = found.troubles
        report(f"none of the {found.rows} runs gave a result; the first: {reason}")
        raise typer.Exit(options.COULD_NOT_RUN)
    raise typer.Exit(options.FAILED if found.passed is False else 0)


def optimize(
    study: Annotated[Path, study_argument("STUDY.toml", "Scenario, variables and objective.")],
    out: Annotated[str | None, folder_option("optimize")] = None,
    workers: options.Workers = None,
    engine: options.Engine = "native",
    again: options.Again = False,
    json: options.Json = None,
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
    from cosim.optimize import results

    quiet = options.quiet()
    found = results.optimize(study, out, workers=workers, engine=engine, again=again, quiet=quiet)
    repeat = [] if found.best is None else [f"repeat it with: {found.command}"]
    options.emit(json, found.to_json(), found.tables(), *repeat, f"wrote {paths.shown(found.folder)}")
    raise typer.Exit(options.FAILED if found.best is None else 0)
