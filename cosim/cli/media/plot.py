"""`cosim plot`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from cosim.cli.options import Quiet, Verbose
from cosim.show.console import configure_logging
from cosim.trace.endings import READ, listed


def plot(
    traces: Annotated[
        list[Path], Argument(metavar="TRACE...", help=f"Traces ({listed(READ)}); several are overlaid.")
    ],
    out: Annotated[Path, Option("-o", "--out", metavar="FILE.svg|.png|.pdf", help="Output file.")] = Path(
        "plot.svg"
    ),
    column: Annotated[
        list[str] | None,
        Option(metavar="PATTERN", help="Plot matching columns, such as `plant.*`. May be repeated."),
    ] = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Plot columns of stored traces.

    One trace has a panel for each unit, several traces have one for each column.

    \b
        cosim plot dob.npz --column plant.depth --column 'controller.force.*'
        cosim plot before.npz after.npz -o difference.png

    Requires the extra `report`.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    configure_logging(verbose, quiet)
    from cosim.show import figure, overlay
    from cosim.trace.files import read

    figure.check(out)
    overlay.save([read(trace) for trace in traces], column or (), out)
    print(f"wrote {out}")
