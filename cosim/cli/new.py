"""`cosim new`."""

from __future__ import annotations

import logging
import shlex
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from cosim import paths
from cosim.cli.options import InProcess, Quiet, Timeout, Verbose, checked_limits
from cosim.cli.tasks import DraftText, New, Schema, place
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.show.console import configure_logging
from cosim.writing import JSON, check_text, naming, write

log = logging.getLogger("cosim")


def new(
    fmu: Annotated[str, Argument(metavar="FMU", help="FMU file or name.")],
    plant: Annotated[
        str,
        Argument(metavar="[MJCF|PLANT]", help="MJCF file or name of a plant. Default: no plant."),
    ] = "",
    out: Annotated[
        Path | None,
        Option("-o", "--out", metavar="FILE.toml", help="Output file; default: the name of the FMU."),
    ] = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Write a first scenario for an FMU.

    Wires follow from names and units; the other ports are listed as comments. The schema
    next to the scenario gives editors its keys, see `cosim schema`.
    """
    configure_logging(verbose, quiet)
    limits = checked_limits(timeout, None, in_process)
    stem = Path(fmu).stem if fmu.endswith(".fmu") else Path(fmu).name
    # an FMU without a name is reported later
    file = paths.expanded(str(out)) if out else Path(f"{stem or 'fmu'}.toml")
    if file.suffix != ".toml":
        raise CosimError(f"cannot write a scenario to `{file}`", "Use a name that ends in `.toml`.")
    # the description of an FMU is only read; a plant is code that runs
    with place(limits if plant or timeout else None) as do:
        found: DraftText | CosimError = do(New(fmu, plant, file.parent))
        if isinstance(found, CosimError):
            raise found
        schema = file.with_suffix(".schema.json")
        with naming(file):
            try:
                with file.open("x", encoding="utf-8") as stream:
                    stream.write(f"#:schema ./{schema.name}\n{found.text}")
            except FileExistsError:
                raise CosimError(f"`{file}` exists already", "Choose another name with `--out`.") from None
        write_schema(schema, do(Schema(str(file))))
    print(f"{file}: {found.wired} wires, {found.left} inputs and commands left as comments")
    print(f"next: cosim check {shlex.quote(str(file))}")


def write_schema(file: Path, found: dict[str, Any] | CosimError) -> None:
    """Write the schema of a new scenario; without it the scenario is still complete."""
    if isinstance(found, CosimError):
        log.warning("there is no schema: %s", found.message)
        return
    check_text("the schema", file, "JSON", JSON)
    write(strict.text(found), file)
