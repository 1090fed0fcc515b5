"""`cosim list`."""

from __future__ import annotations

import logging
from typing import Annotated

from typer import Option

from cosim import paths
from cosim.cli.options import Quiet, Verbose
from cosim.errors import CosimError
from cosim.show.console import configure_logging, output

log = logging.getLogger("cosim")


def list_scenarios(
    studies: Annotated[
        bool, Option("--studies", help="List the studies of `cosim sweep` and `optimize` instead.")
    ] = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """List the scenarios by name and title."""
    configure_logging(verbose, quiet)
    from cosim.scenario.overrides import title_of
    from cosim.show import listing

    entries = []
    for name, file in paths.list_studies().items() if studies else paths.list_scenarios():
        try:
            entries.append((name, title_of(file)))
        except CosimError as error:
            log.warning("%s", error.message)
    if not entries and not studies:
        raise CosimError(
            f"no scenario files in {paths.folders_text()}", f"Set {paths.SCENARIOS_ENV} to your folder."
        )
    output().print(listing.scenarios(entries))
