"""Exit codes, arguments and options that several commands share."""

from __future__ import annotations

import logging
import platform
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Argument, Option

from cosim.cli import complete
from cosim.errors import CosimError
from cosim.extras import DISTRIBUTIONS, version
from cosim.loop import engines
from cosim.pool.limits import Limits
from cosim.show.console import output
from cosim.writing import JSON, check_text, write

if TYPE_CHECKING:
    from rich.console import RenderableType

FAILED = 1
"""Exit code: a criterion failed."""
COULD_NOT_RUN = 2
"""Exit code: the run could not be done."""
READER_GONE = 141
"""Exit code: the reader of stdout is gone, as a shell reports SIGPIPE."""

log = logging.getLogger("cosim")


def checked_json(file: str | None) -> str | None:
    """Check before a long run that a JSON file can be written without overwriting another file."""
    if file is not None:
        if not file:
            raise CosimError("`--json` is empty", "Give a file, or `-` for stdout.")
        check_text("--json", file, "JSON", JSON)
    return file


def show_version(wanted: bool) -> None:
    """Print the versions of the programs that compute the results, without importing them; then end."""
    if wanted:
        for name, distribution in DISTRIBUTIONS.items():
            print(name, version(distribution) or "not installed")
        print("Python", platform.python_version())
        raise typer.Exit


def out_option(metavar: str, help_text: str = "Output file.") -> Any:
    """Option `-o` of a command that writes a file or a folder."""
    return Option("-o", "--out", metavar=metavar, help=help_text)


Timeout = Annotated[float | None, Option(metavar="S", help="Maximum wall time in s.")]
Memory = Annotated[float | None, Option(metavar="MB", help="Maximum memory of a run's process in MB.")]
InProcess = Annotated[
    bool, Option("--in-process", help="Run in this process, for debuggers; a crash ends it.")
]
Seed = Annotated[int | None, Option(metavar="N", help="Seed of all noise; default: that of the scenario.")]
Workers = Annotated[int | None, Option(min=1, metavar="N", help="Worker processes; default: one per core.")]
Engine = Annotated[
    engines.Engine,
    Option(
        parser=engines.checked,
        metavar="native|reference",
        autocompletion=lambda incomplete: engines.ENGINES,
        help="`reference` (FMPy) checks `native`: the results are bit-identical.",
    ),
]
Again = Annotated[bool, Option("--again", help="Repeat runs that gave no result.")]
Plots = Annotated[bool, Option(help="Whether to make plots, if matplotlib is installed.")]
Json = Annotated[
    str | None,
    Option(metavar="FILE|-", callback=checked_json, help="Write the result as JSON; `-` is stdout."),
]
Loop = Annotated[
    str,
    Argument(
        metavar="SCENARIO|FILE.toml",
        help="Name from `cosim list`, or a scenario file.",
        autocompletion=complete.loops,
    ),
]
Set = Annotated[
    list[str] | None,
    Option(
        "--set",
        metavar="KEY=VALUE",
        autocompletion=complete.keys,
        help="Override `controller.<variable>`, `plant.<parameter>`, `loop.<key>`, "
        "`wire.<to>.<key>`, `signal.<to>.<key>`, `inject.<to>.<key>`, `metric.<name>.<key>` or "
        "`criterion.<id>.<key>`. May be repeated.",
    ),
]
Version = Annotated[
    bool,
    Option(
        "--version",
        callback=show_version,
        is_eager=True,
        help="Show the versions of cosim, FMPy, MuJoCo, numpy and Python.",
    ),
]


def options(version: Version = False) -> None:
    """Options before any command."""


def quiet() -> bool:
    """Whether `-q` is given."""
    return not log.isEnabledFor(logging.WARNING)


def checked_limits(timeout: float | None, memory: float | None, in_process: bool) -> Limits | None:
    """Limits of a task in its own process; None, which allows no limits, if it runs in this process."""
    limits = Limits(timeout, None if memory is None else 1e6 * memory, keys=("--timeout", "--memory"))
    for name, value in (("--timeout", timeout), ("--memory", memory)):
        if value is not None and in_process:
            raise CosimError(f"`{name}` needs a separate process", "Omit `--in-process`.")
    return None if in_process else limits


def emit(json: str | None, text: str, *parts: RenderableType) -> None:
    """Write a result as JSON if requested; print its tables and lines, unless stdout is for the JSON."""
    if json is not None:
        write(text, json)
    for part in () if json == "-" else parts:
        if isinstance(part, str):
            # not wrapped, so that it can be copied
            print(part, flush=True)
        else:
            output().print(part, crop=False)
