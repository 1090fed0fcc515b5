"""`cosim show`."""

from __future__ import annotations

from cosim.cli.options import InProcess, Loop, Quiet, Set, Timeout, Verbose, checked_limits
from cosim.cli.tasks import Show, place
from cosim.errors import CosimError
from cosim.show import sheet
from cosim.show.console import configure_logging


def show(
    loop: Loop,
    set_: Set = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Show variables, parameters and wires of a scenario.

    Variables and parameters have units, defaults and ranges.
    """
    configure_logging(verbose, quiet)
    with place(checked_limits(timeout, None, in_process)) as do:
        text: str | CosimError = do(Show(loop, tuple(set_ or ()), sheet.stdout()))
    if isinstance(text, CosimError):
        raise text
    print(text, end="", flush=True)
