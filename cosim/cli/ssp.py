"""`cosim ssp`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cosim.cli import tasks
from cosim.cli.options import InProcess, Loop, Seed, Set, Timeout, checked_limits, out_option
from cosim.errors import CosimError
from cosim.writing import check_folder


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
