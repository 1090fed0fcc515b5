"""`cosim report`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from cosim.cli.options import FAILED, Quiet, Timeout, Verbose, checked_limits
from cosim.cli.test import exit_code
from cosim.loop import engines
from cosim.scenario import complete
from cosim.show.console import configure_logging


def report(
    scenarios: Annotated[
        list[str] | None,
        Argument(
            metavar="LOOP|PATTERN|FILE.toml",
            help="Such as `dob` or `'dob/*'`; all of `cosim list` without one and without `--study`.",
            autocompletion=complete.loops,
        ),
    ] = None,
    out: Annotated[Path, Option("-o", "--out", metavar="FILE.html", help="The page.")] = Path("report.html"),
    study: Annotated[
        list[Path] | None,
        Option(metavar="FILE.toml", help="A study, as for `cosim sweep`. May be given again."),
    ] = None,
    document: Annotated[
        list[Path] | None,
        Option(metavar="FILE.md", help="A text in Markdown. May be given again."),
    ] = None,
    title: Annotated[str, Option(help="Title of the page.")] = "",
    videos: Annotated[
        bool, Option(help="Whether to film one scenario of each loop; needs the extra `replay`.")
    ] = True,
    workers: Annotated[int | None, Option(min=1, help="Worker processes, by default one per core.")] = None,
    engine: Annotated[str, Option(help="native (fast) or reference (FMPy drives, same bits).")] = "native",
    timeout: Timeout = None,
    memory: Annotated[float | None, Option(metavar="MB", help="Most memory of a run's process.")] = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Write one HTML page of scenarios and sweeps: claims, stories, films, plots, parameters.

    The scenarios are run, each once with its own seed; of studies what is not
    done yet. The page needs nothing but a browser. Exit code: 0 all criteria
    hold, 1 some do not, 2 a scenario could not run. It needs the extra `report`.
    """
    configure_logging(verbose, quiet)
    from cosim.acceptance.runner import RunOptions
    from cosim.acceptance.selection import select
    from cosim.report import book

    book.check("--out", out)
    limits = checked_limits(timeout, memory, in_process=False)
    options = RunOptions(None, False, workers, engines.checked(engine), limits, quiet)
    chosen = select(scenarios or ()) if scenarios or not study else ()
    contents = book.Contents(title or book.TITLE, chosen, tuple(study or ()), tuple(document or ()), videos)
    written = book.write(contents, options, out)
    print(f"wrote {out}")
    raise typer.Exit(max(exit_code(written.scenarios), FAILED if False in written.studies else 0))
