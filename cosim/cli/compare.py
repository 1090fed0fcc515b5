"""`cosim evaluate`, `cosim compare` and `cosim plot`: stored traces and results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Argument, Option

from cosim.cli.options import FAILED, Engine, Json, Loop, Set, emit, out_option, quiet
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.show.console import progress_bar
from cosim.trace.endings import READ, listed

if TYPE_CHECKING:
    from cosim.scenario.model import Scenario


def limit(help_text: str) -> Any:
    """Option for a tolerance."""
    return Option(metavar="[PATTERN=]VALUE", help=f"{help_text} Default 0.")


def compare(
    reference: Annotated[
        str,
        Argument(
            metavar="REFERENCE|SCENARIO",
            help=f"Reference: a trace ({listed(READ)}), a result (`.json`) or the folder of a sweep.  "
            "Alone: a scenario, which runs and is compared with its baseline.",
        ),
    ],
    other: Annotated[
        str | None,
        Argument(metavar="OTHER", show_default=False, help="File or folder to compare, of the same kind."),
    ] = None,
    atol: Annotated[
        list[str] | None, limit("Absolute tolerance, in the unit of the column or metric.")
    ] = None,
    rtol: Annotated[list[str] | None, limit("Tolerance relative to the reference.")] = None,
    dt: Annotated[list[str] | None, limit("Permitted time shift of a column in s.")] = None,
    only: Annotated[
        list[str] | None, Option(metavar="PATTERN", help="Compare only matching names, such as `plant.*`.")
    ] = None,
    update: Annotated[
        bool, Option("--update", help="Run the scenario and store the trace as its baseline.")
    ] = False,
    set_: Set = None,
    engine: Engine = "native",
    plot: Annotated[
        Path | None,
        Option(metavar="FILE.svg|.png|.pdf", help="Plot the columns with the largest deviations."),
    ] = None,
    json: Json = None,
) -> None:
    """Compare traces, results or sweeps.

    Give the reference first:

    \b
        cosim compare before.npz after.npz --atol 'plant.*=1e-9' --dt 1e-4
        cosim compare before.json after.json --rtol 1e-6
        cosim compare old.sweep new.sweep --only depth --rtol 0.01

    A baseline is the trace of an accepted run, in the file
    SCENARIO.baseline.npz next to the scenario:

    \b
        cosim compare dob --update    (runs it and writes the baseline)
        cosim compare dob             (runs it and compares)

    --atol, --rtol, --dt and --only may be repeated. A limit applies to the
    columns or metrics that its pattern matches (`*` is any text), without a
    pattern to all; the last match is used. A value v at time t passes if,
    for some value r of the reference in t - dt .. t + dt,

    \b
        |v - r| <= atol + rtol |r|

    NaN on one side only is a difference at any tolerance.

    Exit code: 0 within tolerance, 1 not, 2 could not be compared.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    from cosim.compare import command, display, tolerance

    if update:
        limits = {"--atol": atol, "--rtol": rtol, "--dt": dt, "--only": only}
        for name, given in ({"OTHER": other, "--set": set_, "--plot": plot} | limits).items():
            if given:
                hint = "Update the baseline of an unchanged scenario."
                raise CosimError(f"`{name}` cannot be combined with `--update`", hint)
        scenario = loaded(reference, [])
        with progress_bar(scenario.name, quiet()) as progress:
            result = command.update_baseline(scenario, engine, progress)
        file = str(command.baseline_of(scenario))
        emit(json, strict.text({"baseline": file, **result.to_dict()}), f"wrote {file}")
        return
    allowed = tolerance.tolerances(atol or [], rtol or [], dt or [], only or [])
    if plot is not None:
        display.check_plot("trace" if other is None else command.kind_of(other), plot)
    if other is None:
        scenario = loaded(reference, set_ or [])
        with progress_bar(scenario.name, quiet()) as progress:
            found = command.compare_baseline(scenario, allowed, engine, progress)
    elif set_:
        hint = "Use it with a scenario and its baseline."
        raise CosimError("`--set` cannot be combined with two files", hint)
    else:
        found = command.compare(reference, other, allowed)
    if plot is not None:
        display.save_plot(found, plot)
    emit(json, found.to_json(), display.comparison(found))
    raise typer.Exit(0 if found.within else FAILED)


def loaded(loop: str, changes: list[str]) -> Scenario:
    """Load the scenario that has a baseline."""
    from cosim.scenario.load import load

    if loop.endswith((*READ, ".json")):
        hint = "Give a second file, or only a scenario."
        raise CosimError(f"`{loop}` needs a second file to compare", hint)
    return load(loop, changes)


def evaluate(
    trace: Annotated[Path, Argument(metavar="TRACE", help=f"File of `cosim run --trace`: {listed(READ)}.")],
    loop: Loop,
    set_: Set = None,
    json: Json = None,
) -> None:
    """Evaluate a stored trace without a run.

    Use it after a change of metrics or criteria of the scenario. The numbers of
    the trace do not change. The trace must hold every column that they name.
    All formats except `.csv` also hold the units and the items of enumerations.

    \b
        cosim run dob --trace dob.npz
        cosim evaluate dob.npz dob --set criterion.depth.maximum=4e-7

    Exit code: 0 all criteria passed, 1 a criterion failed, 2 could not be evaluated.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    if trace.suffix not in READ and Path(loop).suffix in READ:
        hint = f"Give the trace first: `cosim evaluate {loop} {trace}`."
        raise CosimError(f"`{trace}` is not a trace", hint)
    from cosim.loop.evaluate import evaluate as evaluated
    from cosim.scenario.load import load
    from cosim.show import display
    from cosim.trace import files

    result = evaluated(load(loop, set_ or ()), files.read(trace))
    emit(json, result.to_json(), display.result(result))
    raise typer.Exit(FAILED if result.passed is False else 0)


def plot(
    traces: Annotated[
        list[Path], Argument(metavar="TRACE...", help=f"Traces ({listed(READ)}); several are overlaid.")
    ],
    out: Annotated[Path, out_option("FILE.svg|.png|.pdf")] = Path("plot.svg"),
    column: Annotated[
        list[str] | None,
        Option(metavar="PATTERN", help="Plot matching columns, such as `plant.*`. May be repeated."),
    ] = None,
) -> None:
    """Plot columns of stored traces.

    One trace has a panel for each unit, several traces have one for each column.

    \b
        cosim plot dob.npz --column plant.depth --column 'controller.force.*'
        cosim plot before.npz after.npz -o difference.png

    Requires the extra `report`.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    from cosim.show import figure, overlay
    from cosim.trace.files import read

    figure.check(out)
    overlay.save([read(trace) for trace in traces], column or (), out)
    print(f"wrote {out}")
