"""`cosim report`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from cosim.cli import complete
from cosim.cli.options import FAILED, Engine, Memory, Quiet, Timeout, Verbose, Workers, checked_limits
from cosim.cli.test import exit_code
from cosim.show.console import configure_logging


def report(
    scenarios: Annotated[
        list[str] | None,
        Argument(
            metavar="SCENARIO|PATTERN|FILE.toml",
            help="For example `dob` or `'dob/*'`. Default without `--study`: all of `cosim list`.",
            autocompletion=complete.loops,
        ),
    ] = None,
    out: Annotated[Path, Option("-o", "--out", metavar="FILE.html", help="Output file.")] = Path(
        "report.html"
    ),
    study: Annotated[
        list[Path] | None,
        Option(
            metavar="FILE.toml",
            help="A study, as for `cosim sweep`. May be repeated.",
            autocompletion=complete.studies,
        ),
    ] = None,
    document: Annotated[
        list[Path] | None,
        Option(metavar="FILE.md", help="A Markdown text to include. May be repeated."),
    ] = None,
    title: Annotated[str, Option(metavar="TEXT", help="Title of the report.")] = "",
    videos: Annotated[
        bool, Option(help="Whether to add a video of each controller's first scenario (extra `replay`).")
    ] = True,
    workers: Workers = None,
    engine: Engine = "native",
    timeout: Timeout = None,
    memory: Memory = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Write an HTML report.

    The report of scenarios and studies holds claims, descriptions, videos, plots and
    parameters, and needs only a browser. Each scenario runs once with its own seed. Only
    the missing cases of a study run.
    Requires the extra `report`.

    Exit code: 0 all criteria passed, 1 a criterion failed, 2 a scenario could not run.
    """
    configure_logging(verbose, quiet)
    from cosim.acceptance.runner import RunOptions
    from cosim.acceptance.selection import select
    from cosim.report import command

    command.check("--out", out)
    limits = checked_limits(timeout, memory, in_process=False)
    options = RunOptions(None, False, workers, engine, limits, quiet)
    chosen = select(scenarios or ()) if scenarios or not study else ()
    contents = command.Contents(
        title or command.TITLE, chosen, tuple(study or ()), tuple(document or ()), videos
    )
    written = command.write_report(contents, options, out)
    print(f"wrote {out}")
    raise typer.Exit(max(exit_code(written.scenarios), FAILED if False in written.studies else 0))
