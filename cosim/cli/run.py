"""`cosim run`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Option

from cosim.cli.options import (
    FAILED,
    MAX_SEED,
    InProcess,
    Json,
    Loop,
    Quiet,
    Set,
    Timeout,
    Verbose,
    checked_limits,
)
from cosim.cli.seeds import check_options, run_seeds
from cosim.cli.tasks import Report, Single, place
from cosim.errors import CosimError
from cosim.loop import engines
from cosim.show import sheet
from cosim.show.console import configure_logging, progress_bar
from cosim.trace import endings
from cosim.writing import JSON, check_apart, check_folder, check_text, discard, write

TRACE = (
    f"Write the trace: {endings.listed(endings.WRITTEN)}. A Parquet file is written during the run, "
    "with little memory."
)


def run(
    loop: Loop,
    set_: Set = None,
    seed: Annotated[
        int | None,
        Option(min=0, max=MAX_SEED, metavar="N", help="Seed of all noise; default: that of the scenario."),
    ] = None,
    seeds: Annotated[
        str | None,
        Option(metavar="FIRST..LAST|N,N", help="Run once with each seed and print the distributions."),
    ] = None,
    engine: Annotated[
        str | None, Option(metavar="native|reference", help="reference (FMPy) or native (compiled).")
    ] = None,
    delay: Annotated[
        int | None, Option(metavar="STEPS", help="Delay of the commands in steps: 0 or 1.")
    ] = None,
    duration: Annotated[float | None, Option(metavar="S", help="Simulated time in s.")] = None,
    json: Json = None,
    trace: Annotated[Path | None, Option(metavar="FILE.npz|.csv|...", help=TRACE)] = None,
    plot: Annotated[Path | None, Option(metavar="FILE.svg|.png", help="Plot the run.")] = None,
    timeout: Timeout = None,
    memory: Annotated[float | None, Option(metavar="MB", help="Maximum memory of the run's process.")] = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Run a scenario and print its metrics and criteria.

    The engines give bit-identical results. Default: native with `--seeds`, otherwise reference.
    """
    configure_logging(verbose, quiet)
    chosen = engines.checked(engine or ("reference" if seeds is None else "native"))
    options = {"loop.seed": seed, "loop.compute_delay": delay, "loop.duration": duration}
    changes = (*(set_ or ()), *(f"{key}={value!r}" for key, value in options.items() if value is not None))
    limits = checked_limits(timeout, memory, in_process)
    check_outputs(json, trace, plot)
    if seeds is not None:
        check_options(seed, trace, plot)
        run_seeds(loop, changes, seeds, chosen, limits, json, quiet)
    task = Single(loop, changes, chosen, verbose, trace, plot, sheet.stdout())
    try:
        with place(limits) as do, progress_bar(loop, quiet) as progress:
            done: Report | CosimError = do(task, progress)
    finally:
        if trace is not None:
            discard(trace)
    if isinstance(done, CosimError):
        raise done
    save(done, json, trace, plot)
    print(done.json if json == "-" else done.table, end="", flush=True)
    if json != "-":
        for file in filter(None, (trace, plot)):
            print(f"wrote {file}")
    raise typer.Exit(FAILED if done.passed is False else 0)


def save(report: Report, json: str | None, trace: Path | None, plot: Path | None) -> None:
    """Write the requested files."""
    if trace is not None and report.result is not None and not endings.streams(trace):
        report.result.save_trace(trace)
    if plot is not None and report.result is not None and report.scenario is not None:
        from cosim.show import plot as plots

        plots.save(report.scenario, report.result, plot)
    if json is not None and json != "-":
        write(report.json, json)


def check_outputs(json: str | None, trace: Path | None, plot: Path | None) -> None:
    """Check before a long run that its files can be written without overwriting other files."""
    if trace is not None:
        endings.check(trace)
    if plot is not None:
        check_folder(plot)
    if json is not None:
        check_text("--json", json, "JSON", JSON)
    named = Path(json) if json is not None and json != "-" else None
    check_apart({"--json": named, "--trace": trace, "--plot": plot})
