"""`cosim list`, `cosim show` and `cosim schema`."""

from __future__ import annotations

import logging
from typing import Annotated, Literal

from typer import Argument, Option

from cosim import paths
from cosim.cli import complete, tasks
from cosim.cli.options import InProcess, Loop, Set, Timeout, checked_limits
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.show import console
from cosim.show.console import output
from cosim.writing import write

log = logging.getLogger("cosim")


def list_scenarios(
    studies: Annotated[
        bool, Option("--studies", help="List the studies of `cosim sweep` and `optimize` instead.")
    ] = False,
) -> None:
    """List the scenarios by name and title."""
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
) -> None:
    """Show variables, parameters and wires.

    Variables and parameters have units, defaults and ranges.

    \b
        cosim show dob plant
        cosim show dob inputs outputs
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    limits = checked_limits(timeout, None, in_process)
    device = console.stdout()
    text = tasks.perform(limits, None, tasks.show, loop, tuple(set_ or ()), tuple(parts or ()), device)
    print(text, end="", flush=True)


def schema(
    file: Annotated[
        Literal["scenario", "study", "optimization"],
        Argument(metavar="[scenario|study|optimization]", help="Kind of the file."),
    ] = "scenario",
    for_: Annotated[
        str,
        Option(
            "--for",
            metavar="SCENARIO|FILE.toml",
            help="Add the FMU variables and plant parameters of this scenario.",
            autocompletion=complete.loops,
        ),
    ] = "",
) -> None:
    """Print the JSON schema of one kind of file.

    Editors with Taplo use it to complete and check files: VS Code with Even Better TOML,
    others with `taplo lsp`. `cosim new` writes it next to the scenario. For other files,
    store it and name it in the first line of the TOML, `#:schema ./my.schema.json`:

    \b
        cosim schema --for my.toml > my.schema.json
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    if for_ and file != "scenario":
        raise CosimError("`--for` works only for the schema of scenarios", f"Omit `--for` or `{file}`.")
    if for_:
        # the plant may be foreign code
        limits = checked_limits(None, None, in_process=False)
        write(strict.text(tasks.perform(limits, None, tasks.schema, for_)), "-")
        return
    from cosim.schema.files import SCHEMAS

    write(strict.text(SCHEMAS[file]()), "-")
