"""`cosim sweep`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from cosim import paths
from cosim.cli import complete
from cosim.cli.options import COULD_NOT_RUN, FAILED, Again, Engine, Json, Plots, Quiet, Verbose, Workers
from cosim.errors import CosimError
from cosim.show.console import configure_logging, output, report
from cosim.writing import write

MERGE = "merge"


def sweep(
    study: Annotated[
        list[Path],
        Argument(
            metavar="STUDY.toml|merge FOLDER...",
            help="Scenario, varied keys and design.",
            autocompletion=complete.studies,
        ),
    ],
    out: Annotated[
        str | None, Option("-o", "--out", metavar="FOLDER", help="Folder of results; default `STUDY.sweep`.")
    ] = None,
    workers: Workers = None,
    engine: Engine = "native",
    part: Annotated[
        str, Option(metavar="I/N", help="Run only part I of N, into a folder of its own, see `merge`.")
    ] = "",
    again: Again = False,
    plots: Plots = True,
    json: Json = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Run the cases of a study in parallel.

    Completed runs are not repeated: the command continues an interrupted sweep.
    On several machines, run each part, then merge the folders into that of an
    undivided sweep:

    \b
        cosim sweep STUDY.toml --part 1/20
        cosim sweep merge FOLDER... -o FOLDER

    Exit code: 0 all criteria passed, 1 a criterion failed, 2 no run gave a result.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    configure_logging(verbose, quiet)
    from cosim.sweep import command

    file, *folders = study
    merged = tuple(folders) if str(file) == MERGE else ()
    if str(file) == MERGE:
        file = command.of_parts(merged)
    elif folders:
        raise CosimError(f"`{folders[0]}` is a second study", "Give one study.")
    options = command.Options(file, out, workers, engine, again, plots, quiet, part=part, merged=merged)
    found, tables = command.execute(options)
    if json is not None:
        write(found.to_json(), json)
    if json != "-":
        output().print(tables, crop=False)
        # not wrapped, so that it can be copied
        print(f"wrote {paths.shown(Path(out or options.default))}")
    if not found.results:
        (_, reason), *_ = found.troubles
        report(f"none of the {found.rows} runs gave a result; the first: {reason}")
        raise typer.Exit(COULD_NOT_RUN)
    raise typer.Exit(FAILED if found.passed is False else 0)
