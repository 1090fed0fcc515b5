"""`cosim evaluate` and `cosim plot`: stored traces."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from cosim.cli.options import FAILED, Json, Loop, Set, emit, out_option
from cosim.errors import CosimError
from cosim.trace.endings import READ, listed


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
