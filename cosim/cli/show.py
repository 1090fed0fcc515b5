"""`cosim show`."""

from __future__ import annotations

from typing import Annotated

from typer import Argument

from cosim.cli import complete
from cosim.cli.options import InProcess, Loop, Quiet, Set, Timeout, Verbose, checked_limits
from cosim.cli.tasks import Show, place
from cosim.errors import CosimError
from cosim.show.console import configure_logging, stdout


def show(
    loop: Loop,
    parts: Annotated[
        list[str] | None,
        Argument(
            metavar="[PART]...",
            help="Only some parts, for example `plant`, `controller`, `parameters` or `wires`.",
            autocompletion=complete.parts,
        ),
    ] = None,
    set_: Set = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Show variables, parameters and wires.

    Variables and parameters have units, defaults and ranges.

    \b
        cosim show dob plant
        cosim show dob inputs outputs
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    configure_logging(verbose, quiet)
    with place(checked_limits(timeout, None, in_process)) as do:
        text: str | CosimError = do(Show(loop, tuple(set_ or ()), tuple(parts or ()), stdout()))
    if isinstance(text, CosimError):
        raise text
    print(text, end="", flush=True)
