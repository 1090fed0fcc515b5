"""The commands together, and the exit code of each."""

from __future__ import annotations

import logging
import sys
from typing import Any, NoReturn

import typer
import typer.exceptions

from cosim.cli.compare import compare
from cosim.cli.console import report
from cosim.cli.judge import judge
from cosim.cli.listing import list_scenarios
from cosim.cli.optimize import optimize
from cosim.cli.options import COULD_NOT_RUN, INTERRUPTED
from cosim.cli.run import run
from cosim.cli.show import show
from cosim.cli.sweep import sweep
from cosim.errors import CosimError

log = logging.getLogger("cosim")
app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Run FMI 2.0 FMUs in closed loop with plants and hold criteria against the results.",
    epilog="Exit code: 0 all criteria hold, 1 some do not, 2 could not run.",
)
app.command("list")(list_scenarios)
app.command()(show)
app.command()(run)
app.command()(sweep)
app.command()(compare)
app.command()(judge)
app.command()(optimize)


def main() -> NoReturn:
    """Run the command line and exit."""
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    sys.exit(status_of(app))


def status_of(command: Any) -> int:
    """Exit code of a command; every error a user can cause is one message without a traceback."""
    try:
        code = command(standalone_mode=False)
        if code == INTERRUPTED:
            report("interrupted")
        return code if isinstance(code, int) else 0
    except CosimError as error:
        log.debug("here:", exc_info=error)
        report(error.message, error.hint)
        return COULD_NOT_RUN
    except typer.exceptions.TyperException as error:
        report(error.format_message(), "`cosim --help` shows commands and options")
        return COULD_NOT_RUN
    except (KeyboardInterrupt, typer.Abort):
        report("interrupted")
        return INTERRUPTED
