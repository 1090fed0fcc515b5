"""`cosim schema`."""

from __future__ import annotations

import enum
from typing import Annotated, Any

from typer import Argument, Option

from cosim.cli.options import checked_limits
from cosim.cli.tasks import Schema, place
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.scenario import complete
from cosim.writing import write


class File(enum.StrEnum):
    """Kinds of files."""

    SCENARIO = "scenario"
    STUDY = "study"
    OPTIMIZATION = "optimization"


def schema(
    file: Annotated[File, Argument(help="Which kind of file.")] = File.SCENARIO,
    for_: Annotated[
        str,
        Option(
            "--for",
            metavar="LOOP|FILE.toml",
            help="A scenario: its FMUs' variables and its plant's parameters are in the schema, too.",
            autocompletion=complete.loops,
        ),
    ] = "",
) -> None:
    """Print the JSON schema of one kind of file, with which editors complete and check them.

    Write it to a file and name that in the first line of your TOML:
    `cosim schema --for my.toml > my.schema.json`, then `#:schema ./my.schema.json`.
    Editors with Taplo do the rest: Even Better TOML for VS Code, `taplo lsp` for others.
    """
    if for_:
        write(strict.text(filled(file, for_)), "-")
        return
    from cosim.optimize.problem import problem_schema
    from cosim.scenario.model import scenario_schema
    from cosim.sweep.study import study_schema

    schemas = {
        File.SCENARIO: scenario_schema,
        File.STUDY: study_schema,
        File.OPTIMIZATION: problem_schema,
    }
    write(strict.text(schemas[file]()), "-")


def filled(file: File, loop: str) -> dict[str, Any]:
    """Describe scenarios with what may be set in one of them; its plant may be foreign code."""
    if file != File.SCENARIO:
        raise CosimError("`--for` makes a schema of scenarios alone", f"leave it or `{file}` out")
    with place(checked_limits(None, None, in_process=False)) as do:
        found: dict[str, Any] | CosimError = do(Schema(loop))
    if isinstance(found, CosimError):
        raise found
    return found
