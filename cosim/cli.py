"""The command line `cosim`: data on stdout, progress and messages on stderr, exit codes for scripts."""

from __future__ import annotations

import contextlib
import logging
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
import typer.exceptions
from rich.console import Console
from typer import Argument, Option

from cosim import paths
from cosim.errors import CosimError
from cosim.loop import engines
from cosim.loop.reference import Progress
from cosim.scenario import layers
from cosim.show.bar import bar

FAILED = 1
"""Exit code: a criterion does not hold."""
COULD_NOT_RUN = 2
"""Exit code: the run could not be done."""
INTERRUPTED = 130
"""Exit code: Ctrl-C."""
WIDTH_IN_FILES = 132
"""Columns of tables that do not go to a terminal."""

app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Run FMI 2.0 FMUs in closed loop with plants and hold criteria against the results.",
    epilog="Exit code: 0 all criteria hold, 1 some do not, 2 could not run.",
)
log = logging.getLogger("cosim")

Verbose = Annotated[
    bool, Option("-v", "--verbose", help="Log what the FMU reports, and where an error came from.")
]
Quiet = Annotated[bool, Option("-q", "--quiet", help="Log errors only, no progress.")]
Loop = Annotated[str, Argument(metavar="LOOP|FILE.toml", help="Name from `cosim list`, or a scenario file.")]
Set = Annotated[
    list[str] | None,
    Option(
        "--set",
        metavar="KEY=VALUE",
        help="Override `controller.<variable>`, `plant.<parameter>`, `loop.<key>`, "
        "`wire.<to>.<key>`, `signal.<to>.<key>`, `inject.<to>.<key>`, `metric.<name>.<key>` or "
        "`criterion.<id>.<key>`. May be given again.",
    ),
]


@app.command("list")
def list_scenarios(verbose: Verbose = False, quiet: Quiet = False) -> None:
    """List the scenarios by name and title."""
    configure_logging(verbose, quiet)
    from cosim.show import display

    entries = []
    for name, file in paths.list_scenarios():
        try:
            entries.append((name, str(layers.read(file).table.get("title", ""))))
        except CosimError as error:
            log.warning("%s", error.message)
    if not entries:
        raise CosimError(
            f"no scenario files in {paths.folders_text()}", f"set {paths.SCENARIOS_ENV} to your folder"
        )
    output().print(display.scenarios(entries))


@app.command()
def show(loop: Loop, set_: Set = None, verbose: Verbose = False, quiet: Quiet = False) -> None:
    """Show a loop: FMU variables and plant parameters with units, defaults and ranges; the wires."""
    configure_logging(verbose, quiet)
    from cosim.fmu import stale
    from cosim.loop.session import Session
    from cosim.scenario.load import load
    from cosim.show import display

    scenario = load(loop, set_ or ())
    with Session(scenario) as session:
        stale.warn(scenario.controller.fmu, session.file.path)
        output().print(display.scenario(scenario, session.file, session.plant))


@app.command()
def run(
    loop: Loop,
    set_: Set = None,
    seed: Annotated[int | None, Option(min=0, help="Seed of all noise, instead of the scenario's.")] = None,
    engine: Annotated[str, Option(help="reference (FMPy drives) or native (fast, same bits).")] = "reference",
    delay: Annotated[int | None, Option(help="Steps by which commands act later: 0 or 1.")] = None,
    duration: Annotated[float | None, Option(metavar="S", help="Simulated time in s.")] = None,
    json: Annotated[
        str | None, Option(metavar="FILE|-", help="Write the result as JSON; `-` is stdout.")
    ] = None,
    trace: Annotated[Path | None, Option(metavar="FILE.npz|.csv", help="Write the trace.")] = None,
    plot: Annotated[Path | None, Option(metavar="FILE.svg|.png", help="Plot the run.")] = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Run a scenario once and print its metrics and criteria."""
    configure_logging(verbose, quiet)
    from cosim.fmu import stale
    from cosim.loop.session import Session
    from cosim.scenario.load import load
    from cosim.show import display
    from cosim.show import plot as plots

    chosen = engines.checked(engine)
    options = {"loop.seed": seed, "loop.compute_delay": delay, "loop.duration": duration}
    given = [f"{key}={value!r}" for key, value in options.items() if value is not None]
    scenario = load(loop, [*(set_ or ()), *given])
    check_outputs(json, trace, plot)
    with Session(scenario, log_events=verbose, engine=chosen) as session:
        stale.warn(scenario.controller.fmu, session.file.path)
        if plot is not None:
            plots.check(scenario, session.columns, plot)
        with progress_bar(scenario.name, quiet) as progress:
            result = session.run(progress=progress)

    if trace is not None:
        result.save_trace(trace)
    if plot is not None:
        plots.save(scenario, result, plot)
    if json is not None and json != "-":
        result.save_json(Path(json))
    if json == "-":
        print(result.to_json(), end="", flush=True)
    else:
        output().print(display.result(result))
    raise typer.Exit(0 if result.passed else FAILED)


def check_outputs(json: str | None, trace: Path | None, plot: Path | None) -> None:
    """Check before a long run that its files can be written."""
    if trace is not None and trace.suffix not in (".npz", ".csv"):
        raise CosimError(f"cannot save a trace as `{trace}`", "the name must end in `.npz` or `.csv`")
    files = [Path(json) if json and json != "-" else None, trace, plot]
    for file in files:
        if file is not None and not file.absolute().parent.is_dir():
            raise CosimError(f"cannot write `{file}`: the folder `{file.absolute().parent}` does not exist")


@app.command()
def sweep(
    study: Annotated[Path, Argument(metavar="STUDY.toml", help="What is varied, and of which scenario.")],
    out: Annotated[
        Path | None, Option(metavar="FOLDER", help="Folder of the results, by default `STUDY.sweep`.")
    ] = None,
    workers: Annotated[int | None, Option(min=1, help="Worker processes, by default one per core.")] = None,
    cluster: Annotated[
        str, Option(metavar="ADDRESS|FILE.json", help="Run on the Dask scheduler at this address.")
    ] = "",
    engine: Annotated[str, Option(help="native (fast) or reference (FMPy drives, same bits).")] = "native",
    again: Annotated[bool, Option("--again", help="Do runs again that gave no result.")] = False,
    plots: Annotated[bool, Option(help="Whether to draw plots, if matplotlib is installed.")] = True,
    json: Annotated[bool, Option("--json", help="Print the summary as JSON.")] = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Run the cases of a study on many processes; what is done already is not done again."""
    configure_logging(verbose, quiet)
    from cosim.sweep import command

    folder = out or Path(f"{study.stem}.sweep")
    options = command.Options(study, folder, workers, cluster, engine, again, plots, quiet)
    found, tables = command.execute(options)
    if json:
        print(found.to_json(), end="", flush=True)
    else:
        output().print(tables)
    raise typer.Exit(0 if found.passed else FAILED)


@contextlib.contextmanager
def progress_bar(title: str, quiet: bool) -> Iterator[Progress | None]:
    """Progress bar on stderr; none if that is not a terminal."""
    with bar(quiet, "{task.percentage:>3.0f} %") as shown:
        if shown is None:
            yield None
            return
        task = shown.add_task(title)
        yield lambda done, total: shown.update(task, completed=done, total=total)


def output() -> Console:
    """Console on stdout; `NO_COLOR` and pipes get plain text."""
    console = Console(highlight=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        return Console(highlight=False, width=WIDTH_IN_FILES)
    return console


def configure_logging(verbose: bool, quiet: bool) -> None:
    """Log to stderr, one line a message."""
    level = logging.DEBUG if verbose else (logging.ERROR if quiet else logging.WARNING)
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("%(levelname)s: %(message)s"))
    for number, name in (
        (logging.DEBUG, "debug"),
        (logging.INFO, "info"),
        (logging.WARNING, "warning"),
        (logging.ERROR, "error"),
    ):
        logging.addLevelName(number, name)
    log.handlers[:] = [handler]
    log.setLevel(level)
    log.propagate = False


def report(message: str, hint: str = "") -> None:
    """Print an error and its hint on stderr, never wrapped."""
    print(f"error: {message}", file=sys.stderr)
    if hint:
        print(f"hint: {hint}", file=sys.stderr)


def main() -> NoReturn:
    """Run the command line and exit."""
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    sys.exit(status_of(app))


def status_of(command: Any) -> int:
    """Exit code of a command; every error a user can cause is one message without a traceback."""
    try:
        code = command(standalone_mode=False)
        if code == INTERRUPTED:
            report("interrupted")
        return code if isinstance(code, int) else 0
    except CosimError as error:
        log.debug("here:", exc_info=error)
        report(error.message, error.hint)
        return COULD_NOT_RUN
    except typer.exceptions.TyperException as error:
        report(error.format_message(), "`cosim --help` shows commands and options")
        return COULD_NOT_RUN
    except (KeyboardInterrupt, typer.Abort):
        report("interrupted")
        return INTERRUPTED
