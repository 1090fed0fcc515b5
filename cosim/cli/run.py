"""`cosim run`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Option

from cosim.cli.console import configure_logging, output, progress_bar
from cosim.cli.options import FAILED, Loop, Quiet, Set, Verbose
from cosim.cli.seeds import check_options, run_seeds
from cosim.errors import CosimError
from cosim.loop import engines


def run(
    loop: Loop,
    set_: Set = None,
    seed: Annotated[int | None, Option(min=0, help="Seed of all noise, instead of the scenario's.")] = None,
    seeds: Annotated[
        str, Option(metavar="FIRST..LAST|N,N", help="Run once with each seed and print distributions.")
    ] = "",
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
    if seeds:
        check_options(seed, trace, plot)
        run_seeds(scenario, seeds, chosen, json, quiet)
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
