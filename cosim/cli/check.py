"""`cosim check`."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Annotated

import typer
from typer import Argument, Option

from cosim.cli import complete
from cosim.cli.options import COULD_NOT_RUN, Quiet, Verbose
from cosim.show.console import configure_logging, report
from cosim.words import strict
from cosim.writing import write

if TYPE_CHECKING:
    from cosim.sweep import check as checks

log = logging.getLogger("cosim")


def check(
    files: Annotated[
        list[str],
        Argument(metavar="LOOP|FILE.toml...", help="Scenarios and studies.", autocompletion=complete.loops),
    ],
    json: Annotated[bool, Option("--json", help="Print what was found as JSON.")] = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Check scenarios and studies without running them: names, types, units, ranges, wires, metrics."""
    configure_logging(verbose, quiet)
    from cosim.sweep import check as checks

    found = [checks.check(file) for file in files]
    if json:
        write(strict.text([entry.to_dict() for entry in found]), "-")
    else:
        for entry in found:
            show(entry, quiet)
    raise typer.Exit(COULD_NOT_RUN if any(entry.error for entry in found) else 0)


def show(entry: checks.Checked, quiet: bool) -> None:
    """Print one line for what can run, and what is wrong or doubtful on stderr."""
    if entry.error is not None:
        report(f"`{entry.name}`: {entry.error.message}", entry.error.hint)
        return
    for warning in () if quiet else entry.warnings:
        log.warning("`%s`: %s", entry.name, warning)
    runs = f", {entry.runs} runs" if entry.kind == "study" else ""
    print(f"{entry.name}: {entry.kind}{runs}, fit to run")
