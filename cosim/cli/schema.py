"""`cosim schema`."""

from __future__ import annotations

import enum
from typing import Annotated, Any

from typer import Argument, Option

from cosim.cli import complete
from cosim.cli.options import Quiet, Verbose, checked_limits
from cosim.cli.tasks import Schema, place
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.show.console import configure_logging
from cosim.writing import write


class File(enum.StrEnum):
    """Kinds of files."""

    SCENARIO = "scenario"
    STUDY = "study"
    OPTIMIZATION = "optimization"


def schema(
    file: Annotated[
        File, Argument(metavar="[scenario|study|optimization]", help="Kind of the file.")
    ] = File.SCENARIO,
    for_: Annotated[
        str,
        Option(
            "--for",
            metavar="SCENARIO|FILE.toml",
            help="Add the FMU variables and plant parameters of this scenario.",
            autocompletion=complete.loops,
        ),
    ] = "",
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Print the JSON schema of one kind of file.

    Editors with Taplo use it to complete and check files: VS Code with Even Better TOML,
    others with `taplo lsp`. `cosim new` writes it next to the scenario. For other files,
    store it and name it in the first line of the TOML, `#:schema ./my.schema.json`:

    \b
        cosim schema --for my.toml > my.schema.json
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    configure_logging(verbose, quiet)
    if for_:
        write(strict.text(filled(file, for_)), "-")
        return
    from cosim.schema.files import SCHEMAS

    write(strict.text(SCHEMAS[file]()), "-")


def filled(file: File, loop: str) -> dict[str, Any]:
    """Return the schema of scenarios with the settings of one scenario; its plant may be foreign code."""
    if file != File.SCENARIO:
        raise CosimError("`--for` works only for the schema of scenarios", f"Omit `--for` or `{file}`.")
    with place(checked_limits(None, None, in_process=False)) as do:
        found: dict[str, Any] | CosimError = do(Schema(loop))
    if isinstance(found, CosimError):
        raise found
    return found
