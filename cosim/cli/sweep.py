"""`cosim sweep`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from cosim import paths
from cosim.cli.options import COULD_NOT_RUN, FAILED, Quiet, Verbose
from cosim.show.console import configure_logging, output, report
from cosim.writing import write

CLUSTER = (
    "Dask scheduler: address, scheduler file, or security file with address, ca, certificate and key for TLS."
)


def sweep(
    study: Annotated[Path, Argument(metavar="STUDY.toml", help="Scenario, varied keys and design.")],
    out: Annotated[
        str | None, Option("-o", "--out", metavar="FOLDER", help="Folder of results; default `STUDY.sweep`.")
    ] = None,
    workers: Annotated[
        int | None, Option(min=1, metavar="N", help="Worker processes; default: one per core.")
    ] = None,
    cluster: Annotated[str | None, Option(metavar="ADDRESS|FILE.json|FILE.toml", help=CLUSTER)] = None,
    engine: Annotated[
        str, Option(metavar="native|reference", help="native (compiled) or reference (FMPy, bit-identical).")
    ] = "native",
    again: Annotated[bool, Option("--again", help="Repeat runs that gave no result.")] = False,
    plots: Annotated[bool, Option(help="Whether to make plots, if matplotlib is installed.")] = True,
    json: Annotated[bool, Option("--json", help="Print the summary as JSON.")] = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Run the cases of a study in parallel.

    Completed runs are not repeated: the command continues an interrupted sweep.
    """
    configure_logging(verbose, quiet)
    from cosim.sweep import command
    from cosim.sweep.store import folder_of

    folder = folder_of(out, Path(f"{study.stem}.sweep"))
    options = command.Options(study, folder, workers, cluster, engine, again, plots, quiet)
    found, tables = command.execute(options)
    if json:
        write(found.to_json(), "-")
    else:
        output().print(tables, crop=False)
        # not wrapped, so that it can be copied
        print(f"wrote {paths.shown(folder)}")
    if not found.results:
        (_, reason), *_ = found.troubles
        report(f"none of the {found.rows} runs gave a result; the first: {reason}")
        raise typer.Exit(COULD_NOT_RUN)
    raise typer.Exit(FAILED if found.passed is False else 0)
