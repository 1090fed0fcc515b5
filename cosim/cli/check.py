"""`cosim check`."""

from __future__ import annotations

import logging
from typing import Annotated

import typer
from typer import Argument

from cosim import paths
from cosim.check.checked import Checked
from cosim.cli import complete, tasks
from cosim.cli.options import COULD_NOT_RUN, InProcess, Json, Timeout, checked_limits
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.show.console import report
from cosim.writing import write

log = logging.getLogger("cosim")


def check(
    files: Annotated[
        list[str],
        Argument(
            metavar="SCENARIO|FILE.toml...",
            help="Scenarios, studies and optimizations.",
            autocompletion=complete.any_files,
        ),
    ],
    timeout: Timeout = None,
    in_process: InProcess = False,
    json: Json = None,
) -> None:
    """Check scenario, study and optimization files.

    Checks names, types, units, ranges, wires and metrics. Nothing runs.
    """
    with tasks.place(checked_limits(timeout, None, in_process)) as do:
        found = [named(file, do(tasks.TaskCall(tasks.check, (file,)))) for file in files]
    if json is not None:
        write(strict.text([entry.to_dict() for entry in found]), json)
    if json != "-":
        for entry in found:
            show(entry)
    raise typer.Exit(COULD_NOT_RUN if any(entry.error for entry in found) else 0)


def named(file: str, outcome: Checked | CosimError) -> Checked:
    """Attach the findings to the name of the file, also if the check ended its process."""
    return Checked(file, error=outcome, runs=0) if isinstance(outcome, CosimError) else outcome


def about(file: str, message: str) -> str:
    """Message that starts with its file, unless it names that already."""
    named = {f"`{file}`", f"`{paths.shown(paths.expanded(file))}`"}
    return message if message.startswith(tuple(named)) else f"`{file}`: {message}"


def show(entry: Checked) -> None:
    """Print one line for a valid file; print errors and warnings on stderr."""
    if entry.error is not None:
        report(about(entry.name, entry.error.message), entry.error.hint)
        return
    for warning in entry.warnings:
        log.warning("`%s`: %s", entry.name, warning)
    runs = f", {entry.runs} runs" if entry.kind != "scenario" else ""
    print(f"{entry.name}: {entry.kind}{runs}, valid")
