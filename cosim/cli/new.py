"""`cosim new`."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from cosim import paths
from cosim.cli.options import InProcess, Quiet, Timeout, Verbose, checked_limits
from cosim.cli.tasks import DraftText, New, place
from cosim.errors import CosimError
from cosim.show.console import configure_logging
from cosim.writing import naming


def new(
    fmu: Annotated[str, Argument(metavar="FMU", help="An FMU file, or its name.")],
    plant: Annotated[
        str,
        Argument(metavar="[MJCF|PLANT]", help="An MJCF file, or the name of a plant; none runs it alone."),
    ] = "",
    out: Annotated[
        Path | None, Option(metavar="FILE.toml", help="The file to write, by default named as the FMU.")
    ] = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Write a scenario to start from: an FMU wired to a plant by names and units, the rest as comments."""
    configure_logging(verbose, quiet)
    limits = checked_limits(timeout, None, in_process)
    stem = Path(fmu).stem if fmu.endswith(".fmu") else Path(fmu).name
    # what has no name is no FMU, which is told later
    file = paths.expanded(str(out)) if out else Path(f"{stem or 'fmu'}.toml")
    if file.suffix != ".toml":
        raise CosimError(f"cannot write a scenario to `{file}`", "the name must end in `.toml`")
    # the description of an FMU is only read, a plant is code
    with place(limits if plant or timeout else None) as do:
        found: DraftText | CosimError = do(New(fmu, plant, file.parent))
    if isinstance(found, CosimError):
        raise found
    with naming(file):
        try:
            with file.open("x", encoding="utf-8") as stream:
                stream.write(found.text)
        except FileExistsError:
            raise CosimError(f"`{file}` is there already", "choose another name with `--out`") from None
    print(f"{file}: {found.wired} wires, {found.left} inputs and commands left as comments")
    print(f"next: cosim check {shlex.quote(str(file))}")
