"""`cosim ssp`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Option

from cosim.cli.options import InProcess, Loop, Quiet, Set, Timeout, Verbose, checked_limits
from cosim.cli.tasks import place
from cosim.errors import CosimError
from cosim.show.console import configure_logging

if TYPE_CHECKING:
    from cosim.pool.job import WorkerContext


@dataclass(frozen=True)
class Export:
    """A scenario as an SSP package, see `cosim.ssp.package.write`."""

    loop: str
    changes: tuple[str, ...]
    seed: int | None
    file: Path

    def run(self, context: WorkerContext) -> float:
        """Write the package; return the communication step in s."""
        from cosim.ssp.package import write

        return write(self.loop, self.changes, self.seed, self.file, context.place).loop.step


def ssp(
    loop: Loop,
    out: Annotated[
        Path | None, Option("-o", "--out", metavar="FILE.ssp", help="Output file; default `SCENARIO.ssp`.")
    ] = None,
    seed: Annotated[
        int | None,
        Option(min=0, max=2**31 - 1, metavar="N", help="Seed of all noise; default: that of the scenario."),
    ] = None,
    set_: Set = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Write a scenario as an SSP 1.0 package.

    Plant, noise and signals become an FMU made with PythonFMU. It runs where this harness is
    installed. Use the communication step of the scenario. Requires the extra `ssp`.
    """
    configure_logging(verbose, quiet)
    file = out or Path(f"{loop.removesuffix('.toml').replace('/', '-')}.ssp")
    if file.suffix != ".ssp":
        raise CosimError(f"cannot write a package to `{file}`", "Use a name that ends in `.ssp`.")
    with place(checked_limits(timeout, None, in_process)) as do:
        step: float | CosimError = do(Export(loop, tuple(set_ or ()), seed, file))
    if isinstance(step, CosimError):
        raise step
    print(f"wrote {file}: simulate it with a communication step of {step:g} s")
