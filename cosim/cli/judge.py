"""`cosim judge`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from cosim.cli.options import FAILED, Loop, Quiet, Set, Verbose
from cosim.show.console import configure_logging, output


def judge(
    trace: Annotated[Path, Argument(metavar="TRACE", help="What `cosim run --trace` wrote, .npz or .csv.")],
    loop: Loop,
    set_: Set = None,
    json: Annotated[
        str | None, Option(metavar="FILE|-", help="Write the result as JSON; `-` is stdout.")
    ] = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Judge a stored trace by the metrics and criteria of a scenario, without running it again.

    For a limit or a metric that changed after a long run: the numbers of the
    trace stay what they are, of the scenario only metrics and criteria count.
    The trace must hold every column that they name; an .npz file also holds the
    units of the columns, and the items of those that are enumerations. So:

        cosim run dob --trace dob.npz
        cosim judge dob.npz dob --set criterion.depth.maximum=4e-7

    Exit code: 0 all criteria hold, 1 some do not, 2 could not be judged.
    """
    configure_logging(verbose, quiet)
    from cosim.loop import stored
    from cosim.loop.judge import judge as judged
    from cosim.scenario.load import load
    from cosim.show import display

    result = judged(load(loop, set_ or ()), stored.read(trace))
    if json is not None and json != "-":
        result.save_json(Path(json))
    if json == "-":
        print(result.to_json(), end="", flush=True)
    else:
        output().print(display.result(result))
    raise typer.Exit(FAILED if result.passed is False else 0)
