"""`cosim new`."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from cosim.cli.options import Quiet, Verbose
from cosim.errors import CosimError
from cosim.show.console import configure_logging


def new(
    fmu: Annotated[str, Argument(metavar="FMU", help="An FMU file, or its name.")],
    plant: Annotated[
        str,
        Argument(metavar="[MJCF|PLANT]", help="An MJCF file, or the name of a plant; none runs it alone."),
    ] = "",
    out: Annotated[
        Path | None, Option(metavar="FILE.toml", help="The file to write, by default named as the FMU.")
    ] = None,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Write a scenario to start from: an FMU wired to a plant by names and units, the rest as comments."""
    configure_logging(verbose, quiet)
    from cosim.new.draft import draft
    from cosim.new.write import text

    file = out or Path(f"{Path(fmu).stem if fmu.endswith('.fmu') else Path(fmu).name}.toml")
    if file.suffix != ".toml":
        raise CosimError(f"cannot write a scenario to `{file}`", "the name must end in `.toml`")
    found = draft(fmu, plant, file.parent)
    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(text(found))
    except FileExistsError:
        raise CosimError(f"`{file}` is there already", "choose another name with `--out`") from None
    except OSError as error:
        raise CosimError(f"cannot write `{file}`: {error.strerror or error}") from None
    open_ends = len(found.inputs) - len(found.readings) + len(found.commanded) - len(found.commands)
    wired = len(found.readings) + len(found.commands)
    print(f"{file}: {wired} wires, {open_ends} inputs and commands left as comments")
    print(f"next: cosim check {shlex.quote(str(file))}")
