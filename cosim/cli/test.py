"""`cosim test`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer import Argument, Option

from cosim.cli.options import COULD_NOT_RUN, FAILED, Quiet, Timeout, Verbose, checked_limits
from cosim.cli.run import check_outputs
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.loop import engines
from cosim.scenario import complete
from cosim.show.console import configure_logging, output, report
from cosim.writing import check_apart, check_text, write

if TYPE_CHECKING:
    from collections.abc import Mapping

    from cosim.pool.job import Outcome

TABLE = "acceptance.txt"
"""File of the table in the folder of the results."""


def run_tests(
    scenarios: Annotated[
        list[str] | None,
        Argument(
            metavar="SCENARIO|PATTERN|FILE.toml",
            help="For example `dob` or `'dob/*'`. Default: all of `cosim list`.",
            autocompletion=complete.loops,
        ),
    ] = None,
    out: Annotated[
        Path | None, Option("-o", "--out", metavar="FOLDER", help="Folder for table, results and plots.")
    ] = None,
    workers: Annotated[
        int | None, Option(min=1, metavar="N", help="Worker processes; default: one per core.")
    ] = None,
    engine: Annotated[
        str, Option(metavar="native|reference", help="native (compiled) or reference (FMPy, bit-identical).")
    ] = "native",
    timeout: Timeout = None,
    memory: Annotated[float | None, Option(metavar="MB", help="Maximum memory of a run's process.")] = None,
    plots: Annotated[bool, Option(help="Whether to make plots, if matplotlib is installed.")] = True,
    json: Annotated[
        str | None, Option(metavar="FILE|-", help="Write all results as JSON; `-` is stdout.")
    ] = None,
    junit: Annotated[
        str | None, Option(metavar="FILE.xml", help="Write the verdicts as JUnit XML, for CI.")
    ] = None,
    page: Annotated[
        Path | None,
        Option("--report", metavar="FILE.html", help="Also write the HTML report, see `cosim report`."),
    ] = None,
    study: Annotated[
        list[Path] | None,
        Option(
            metavar="FILE.toml",
            help="A study for the report, without effect on the exit code. May be repeated.",
        ),
    ] = None,
    document: Annotated[
        list[Path] | None,
        Option(metavar="FILE.md", help="A Markdown text for the report. May be repeated."),
    ] = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Run many scenarios and print the acceptance table.

    Each runs once with its own seed. An error in one does not stop the others. Exit
    code: 0 all criteria passed, 1 a criterion failed, 2 a scenario could not run. Ctrl-C
    and SIGTERM keep the results until then.
    """
    configure_logging(verbose, quiet)
    from cosim.acceptance import junit as xml
    from cosim.acceptance import runner, table
    from cosim.acceptance.selection import select
    from cosim.show.figure import wanted

    check_outputs(json, None, None)
    if junit is not None:
        check_text("--junit", junit, "JUnit XML", xml.BEGINNING)
    files = {"--json": json, "--junit": junit, "--report": page}
    check_apart({option: Path(file) if file else None for option, file in files.items()})
    for option, given in (("--study", study), ("--document", document)):
        if page is None and given:
            raise CosimError(f"`{option}` requires `--report`", "Add `--report FILE.html`.")
    if out is not None and out.is_dir():
        check_text("--out", out / TABLE, "an acceptance table", table.BEGINNING)
    limits = checked_limits(timeout, memory, in_process=False)
    options = runner.RunOptions(out, wanted(plots), workers, engines.checked(engine), limits, quiet)
    chosen = select(scenarios or ())
    stopped: KeyboardInterrupt | None = None
    try:
        if page is None:
            found = runner.run(chosen, options)
        else:
            from cosim.report import book

            book.check("--report", page)
            contents = book.Contents(book.TITLE, chosen, tuple(study or ()), tuple(document or ()))
            found = book.write(contents, options, page).scenarios
    except runner.StoppedError as error:
        found, stopped = error.outcomes, error
    shown = table.table(found)
    text = table.text(shown)
    if out is not None:
        write(text, out / TABLE)
    if json is not None:
        write(strict.text(runner.plain(found)), json)
    if junit is not None:
        write(xml.document(found), junit)
    console = output()
    if json != "-" and console.is_terminal:
        console.print(shown)
    elif json != "-":
        print(text, end="", flush=True)
    if stopped is not None:
        raise stopped
    raise typer.Exit(exit_code(found))


def exit_code(outcomes: Mapping[str, Outcome]) -> int:
    """Exit code of all outcomes; prints their errors."""
    code = 0
    for name, outcome in outcomes.items():
        if isinstance(outcome, CosimError):
            report(f"`{name}`: {outcome.message}", outcome.hint)
            code = COULD_NOT_RUN
        elif outcome.passed is False:
            code = max(code, FAILED)
    return code
