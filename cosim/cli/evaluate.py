"""`cosim judge`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument

from cosim.cli.options import FAILED, Json, Loop, Quiet, Set, Verbose
from cosim.cli.run import check_outputs
from cosim.errors import CosimError
from cosim.show.console import configure_logging, output
from cosim.trace.endings import READ, listed
from cosim.writing import write


def evaluate(
    trace: Annotated[
        Path, Argument(metavar="TRACE", help=f"What `cosim run --trace` wrote: {listed(READ)}.")
    ],
    loop: Loop,
    set_: Set = None,
    json: Json = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Judge a stored trace by the metrics and criteria of a scenario, without running it again.

    For a limit or a metric that changed after a long run: the numbers of the
    trace stay what they are, of the scenario only metrics and criteria count.
    The trace must hold every column that they name; all but .csv files also hold
    the units of the columns, and the items of those that are enumerations. So:

        cosim run dob --trace dob.npz
        cosim judge dob.npz dob --set criterion.depth.maximum=4e-7

    Exit code: 0 all criteria hold, 1 some do not, 2 could not be judged.
    """
    configure_logging(verbose, quiet)
    if trace.suffix not in READ and Path(loop).suffix in READ:
        raise CosimError(f"`{trace}` is no trace", f"the trace comes first: `cosim judge {loop} {trace}`")
    check_outputs(json, None, None)
    from cosim.loop.evaluate import evaluate as judged
    from cosim.scenario.load import load
    from cosim.show import display
    from cosim.trace import files

    result = judged(load(loop, set_ or ()), files.read(trace))
    if json is not None:
        write(result.to_json(), json)
    if json != "-":
        output().print(display.result(result))
    raise typer.Exit(FAILED if result.passed is False else 0)
