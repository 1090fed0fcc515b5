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
    """Show a loop: FMU variables and plant parameters with units, defaults and ranges; the wires."""
    configure_logging(verbose, quiet)
    with place(checked_limits(timeout, None, in_process)) as do:
        told: str | CosimError = do(Show(loop, tuple(set_ or ()), sheet.stdout()))
    if isinstance(told, CosimError):
        raise told
    print(told, end="", flush=True)
