"""`cosim sweep`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from cosim import paths
from cosim.cli.options import COULD_NOT_RUN, FAILED, Quiet, Verbose
from cosim.errors import CosimError
from cosim.show.console import configure_logging, output, report
from cosim.writing import write

MERGE = "merge"
CLUSTER = (
    "Dask scheduler: address, scheduler file, or security file with address, ca, certificate and key for TLS."
)


def sweep(
    study: Annotated[
        list[Path], Argument(metavar="STUDY.toml|merge FOLDER...", help="Scenario, varied keys and design.")
    ],
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
    part: Annotated[
        str, Option(metavar="I/N", help="Run only part I of N, into a folder of its own, see `merge`.")
    ] = "",
    again: Annotated[bool, Option("--again", help="Repeat runs that gave no result.")] = False,
    plots: Annotated[bool, Option(help="Whether to make plots, if matplotlib is installed.")] = True,
    json: Annotated[bool, Option("--json", help="Print the summary as JSON.")] = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Run the cases of a study in parallel.

    Completed runs are not repeated: the command continues an interrupted sweep.
    On machines without a common scheduler, run `cosim sweep STUDY.toml --part I/N` with
    each I, and then `cosim sweep merge FOLDER... -o FOLDER`, which gives the folder of an
    undivided sweep.
    """
    configure_logging(verbose, quiet)
    from cosim.sweep import command

    file, *folders = study
    merged = tuple(folders) if str(file) == MERGE else ()
    if str(file) == MERGE:
        file = command.of_parts(merged)
    elif folders:
        raise CosimError(f"`{folders[0]}` is a second study", "Give one study.")
    options = command.Options(
        file, out, workers, cluster, engine, again, plots, quiet, part=part, merged=merged
    )
    found, tables = command.execute(options)
    if json:
        write(found.to_json(), "-")
    else:
        output().print(tables, crop=False)
        # not wrapped, so that it can be copied
        print(f"wrote {paths.shown(Path(out or options.default))}")
    if not found.results:
        (_, reason), *_ = found.troubles
        report(f"none of the {found.rows} runs gave a result; the first: {reason}")
        raise typer.Exit(COULD_NOT_RUN)
    raise typer.Exit(FAILED if found.passed is False else 0)
