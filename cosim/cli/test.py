"""`cosim test` and `cosim report`: many scenarios."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer import Argument, Option

from cosim.cli import complete, options
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.show.console import output, report
from cosim.writing import check_apart, check_text, write

if TYPE_CHECKING:
    from collections.abc import Mapping

    from cosim.pool.job import Outcome

TABLE = "acceptance.txt"
"""File of the table in the folder of the results."""
Scenarios = Annotated[
    list[str] | None,
    Argument(
        metavar="[SCENARIO|PATTERN|FILE.toml]...",
        help="For example `dob` or `'dob/*'`. Default: all of `cosim list`.",
        autocompletion=complete.loops,
    ),
]
Study = Annotated[
    list[Path] | None,
    Option(
        metavar="FILE.toml",
        help="Add a study of `cosim sweep` to the report. May be repeated.",
        autocompletion=complete.studies,
    ),
]
Document = Annotated[
    list[Path] | None,
    Option(metavar="FILE.md", help="Add a Markdown text to the report. May be repeated."),
]


def run_tests(
    scenarios: Scenarios = None,
    out: Annotated[Path | None, options.out_option("FOLDER", "Folder for table, results and plots.")] = None,
    workers: options.Workers = None,
    engine: options.Engine = "native",
    timeout: options.Timeout = None,
    memory: options.Memory = None,
    plots: options.Plots = True,
    json: options.Json = None,
    junit: Annotated[
        str | None, Option(metavar="FILE.xml", help="Write the verdicts as JUnit XML, for CI.")
    ] = None,
    page: Annotated[
        Path | None,
        Option("--report", metavar="FILE.html", help="Also write the HTML report, see `cosim report`."),
    ] = None,
    study: Study = None,
    document: Document = None,
) -> None:
    """Run many scenarios as acceptance tests.

    Each runs once with its own seed. An error in one does not stop the others.
    Ctrl-C and SIGTERM keep the results until then. A study of the report has no
    effect on the exit code.

    \b
        cosim test 'dob/*' -o results --junit results.xml

    Exit code: 0 all criteria passed, 1 a criterion failed, 2 a scenario could not run.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    from cosim.acceptance import junit as xml
    from cosim.acceptance import runner, table
    from cosim.acceptance.selection import select
    from cosim.show.figure import plots_requested

    if junit is not None:
        check_text("--junit", junit, "JUnit XML", xml.BEGINNING)
    files = {"--json": json, "--junit": junit, "--report": page}
    check_apart({option: Path(file) if file else None for option, file in files.items()})
    for option, given in (("--study", study), ("--document", document)):
        if page is None and given:
            raise CosimError(f"`{option}` requires `--report`", "Add `--report FILE.html`.")
    if out is not None:
        if out.exists() and not out.is_dir():
            raise CosimError(f"`--out` `{out}` is not a folder", "Choose another name.")
        if out.is_dir():
            check_text("--out", out / TABLE, "an acceptance table", table.BEGINNING)
    limits = options.checked_limits(timeout, memory, in_process=False)
    runs = runner.RunOptions(out, plots_requested(plots), workers, engine, limits, options.quiet())
    chosen = select(scenarios or ())
    stopped: KeyboardInterrupt | None = None
    try:
        if page is None:
            found = runner.run(chosen, runs)
        else:
            from cosim.report import command

            command.check("--report", page)
            contents = command.Contents(command.TITLE, chosen, study or (), document or ())
            found, _ = command.write_report(contents, runs, page)
    except runner.StoppedError as error:
        found, stopped = error.outcomes, error
    shown = table.table(found)
    text = table.text(shown)
    if out is not None:
        write(text, out / TABLE)
    if junit is not None:
        write(xml.document(found), junit)
    printed = shown if output().is_terminal else text.removesuffix("\n")
    options.emit(json, strict.text(runner.plain(found)), printed)
    if stopped is not None:
        raise stopped
    raise typer.Exit(exit_code(found))


def report_page(
    scenarios: Scenarios = None,
    out: Annotated[Path, options.out_option("FILE.html")] = Path("report.html"),
    study: Study = None,
    document: Document = None,
    title: Annotated[str, Option(metavar="TEXT", help="Title of the report.")] = "",
    videos: Annotated[
        bool, Option(help="Whether to add a video of each controller's first scenario (extra `replay`).")
    ] = True,
    workers: options.Workers = None,
    engine: options.Engine = "native",
    timeout: options.Timeout = None,
    memory: options.Memory = None,
) -> None:
    """Write an HTML report.

    The report holds claims, descriptions, videos, plots and parameters, and needs only
    a browser. Each scenario runs once with its own seed. Only the missing cases of a
    study run. With studies, the default is no scenario. Requires the extra `report`.

    \b
        cosim report 'dob/*' --study studies/dob-contact.toml -o dob.html

    Exit code: 0 all criteria passed, 1 a criterion failed, 2 a scenario could not run.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    from cosim.acceptance.runner import RunOptions
    from cosim.acceptance.selection import select
    from cosim.report import command

    command.check("--out", out)
    limits = options.checked_limits(timeout, memory, in_process=False)
    runs = RunOptions(None, False, workers, engine, limits, options.quiet())
    chosen = select(scenarios or ()) if scenarios or not study else ()
    contents = command.Contents(title or command.TITLE, chosen, study or (), document or (), videos)
    outcomes, studies = command.write_report(contents, runs, out)
    print(f"wrote {out}")
    raise typer.Exit(max(exit_code(outcomes), options.FAILED if False in studies else 0))


def exit_code(outcomes: Mapping[str, Outcome]) -> int:
    """Exit code of all outcomes; prints their errors."""
    code = 0
    for name, outcome in outcomes.items():
        if isinstance(outcome, CosimError):
            report(f"`{name}`: {outcome.message}", outcome.hint)
            code = options.COULD_NOT_RUN
        elif outcome.passed is False:
            code = max(code, options.FAILED)
    return code
