"""`cosim show`."""

from __future__ import annotations

from cosim.cli.options import Loop, Quiet, Set, Verbose
from cosim.show.console import configure_logging, output


def show(loop: Loop, set_: Set = None, verbose: Verbose = False, quiet: Quiet = False) -> None:
    """Show a loop: FMU variables and plant parameters with units, defaults and ranges; the wires."""
    configure_logging(verbose, quiet)
    from cosim.fmu import stale
    from cosim.loop.session import Session
    from cosim.scenario.load import load
    from cosim.show import display

    scenario = load(loop, set_ or ())
    with Session(scenario) as session:
        stale.warn_of(scenario)
        output().print(display.scenario(scenario, session.fmus, session.plant))
