"""`cosim schema`."""

from __future__ import annotations

import enum
from typing import Annotated

from typer import Argument

from cosim.words import strict
from cosim.writing import write


class File(enum.StrEnum):
    """Kinds of files."""

    SCENARIO = "scenario"
    STUDY = "study"
    OPTIMIZATION = "optimization"


def schema(
    file: Annotated[File, Argument(help="Which kind of file.")] = File.SCENARIO,
) -> None:
    """Print the JSON schema of one kind of file, with which editors complete and check them.

    Write it to a file and name that in the first line of your TOML:
    `cosim schema > scenario.schema.json`, then `#:schema ./scenario.schema.json`.
    Editors with Taplo do the rest: Even Better TOML for VS Code, `taplo lsp` for others.
    """
    from cosim.optimize.problem import problem_schema
    from cosim.scenario.model import scenario_schema
    from cosim.sweep.study import study_schema

    schemas = {
        File.SCENARIO: scenario_schema,
        File.STUDY: study_schema,
        File.OPTIMIZATION: problem_schema,
    }
    write(strict.text(schemas[file]()), "-")
