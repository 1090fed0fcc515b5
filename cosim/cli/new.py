"""`cosim new` and `cosim ssp`."""

from __future__ import annotations

import logging
import shlex
from pathlib import Path
from typing import Annotated

from typer import Argument

from cosim import paths
from cosim.cli import tasks
from cosim.cli.options import InProcess, Loop, Seed, Set, Timeout, checked_limits, out_option
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.writing import JSON, check_folder, check_text, naming, write

log = logging.getLogger("cosim")


def new(
    fmu: Annotated[str, Argument(metavar="FMU", help="FMU file or name.")],
    plant: Annotated[
        str,
        Argument(metavar="[MJCF|PLANT]", help="MJCF file or name of a plant. Default: no plant."),
    ] = "",
    out: Annotated[Path | None, out_option("FILE.toml", "Output file; default: the name of the FMU.")] = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
) -> None:
    """Write a first scenario for an FMU.

    Wires follow from names and units; the other ports are listed as comments. The schema
    next to the scenario gives editors its keys, see `cosim schema`.
    """
    limits = checked_limits(timeout, None, in_process)
    stem = Path(fmu).stem if fmu.endswith(".fmu") else Path(fmu).name
    # an FMU without a name is reported later
    file = paths.expanded(str(out)) if out else Path(f"{stem or 'fmu'}.toml")
    if file.suffix != ".toml":
        raise CosimError(f"cannot write a scenario to `{file}`", "Use a name that ends in `.toml`.")
    check_folder(file)
    schema = file.with_suffix(".schema.json")
    # the description of an FMU is only read; a plant is code that runs
    with tasks.executor(limits if plant or timeout else None) as do:
        found = do(tasks.TaskCall(tasks.new, (fmu, plant, file.parent)))
        if isinstance(found, CosimError):
            raise found
        text, wired, left = found
        with naming(file):
            try:
                with file.open("x", encoding="utf-8") as stream:
                    stream.write(f"#:schema ./{schema.name}\n{text}")
            except FileExistsError:
                raise CosimError(f"`{file}` exists already", "Choose another name with `--out`.") from None
        described = do(tasks.TaskCall(tasks.schema, (str(file),)))
    # without its schema the scenario is still complete
    if isinstance(described, CosimError):
        log.warning("there is no schema: %s", described.message)
    else:
        check_text("the schema", schema, "JSON", JSON)
        write(strict.text(described), schema)
    print(f"{file}: {wired} wires, {left} inputs and commands left as comments")
    print(f"next: cosim check {shlex.quote(str(file))}")


def ssp(
    loop: Loop,
    out: Annotated[Path | None, out_option("FILE.ssp", "Output file; default `SCENARIO.ssp`.")] = None,
    seed: Seed = None,
    set_: Set = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
) -> None:
    """Write a scenario as an SSP 1.0 package.

    Plant, noise and signals become an FMU made with PythonFMU. It runs where this harness is
    installed. Use the communication step of the scenario. Requires the extra `ssp`.
    """
    file = out or Path(f"{loop.removesuffix('.toml').replace('/', '-')}.ssp")
    if file.suffix != ".ssp":
        raise CosimError(f"cannot write a package to `{file}`", "Use a name that ends in `.ssp`.")
    check_folder(file)
    limits = checked_limits(timeout, None, in_process)
    step = tasks.perform(limits, None, tasks.ssp, loop, tuple(set_ or ()), seed, file)
    print(f"wrote {file}: simulate it with a communication step of {step:g} s")
