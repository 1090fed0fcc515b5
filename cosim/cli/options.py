"""Exit codes, arguments and options that several commands share."""

from __future__ import annotations

from typing import Annotated

from typer import Argument, Option

from cosim import interrupts
from cosim.errors import CosimError
from cosim.pool.limits import Limits, isolates, unkept
from cosim.scenario import complete

FAILED = 1
"""Exit code: a criterion failed."""
COULD_NOT_RUN = 2
"""Exit code: the run could not be done."""
INTERRUPTED = interrupts.INTERRUPTED
"""Exit code: Ctrl-C."""
READER_GONE = 141
"""Exit code: the reader of stdout is gone, as a shell reports SIGPIPE."""
MAX_SEED = 2**63 - 1
"""Largest seed: integers of scenarios have 64 bits."""

Timeout = Annotated[float | None, Option(metavar="S", help="Maximum wall time in s.")]
InProcess = Annotated[
    bool, Option("--in-process", help="Run in this process, for debuggers; a crash ends it.")
]
Json = Annotated[str | None, Option(metavar="FILE|-", help="Write the result as JSON; `-` is stdout.")]
Verbose = Annotated[bool, Option("-v", "--verbose", help="Log events of the FMU and the origin of errors.")]
Quiet = Annotated[bool, Option("-q", "--quiet", help="Log errors only, no progress.")]
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


def checked_limits(timeout: float | None, memory: float | None, in_process: bool) -> Limits | None:
    """Limits of a task in its own process; None if it runs in this process.

    Raises
    ------
    CosimError
        A limit that cannot be enforced, or there is no process that could enforce it.
    """
    limits = Limits(timeout, None if memory is None else 1e6 * memory, keys=("--timeout", "--memory"))
    for name, value in (("--timeout", timeout), ("--memory", memory)):
        if value is not None and in_process:
            raise CosimError(f"`{name}` needs a separate process", "Omit `--in-process`.")
    for option in unkept(limits):
        problem = f"{option} cannot be enforced: this system has no supervised worker processes"
        raise CosimError(problem, f"Omit {option}; the command then runs in its own process.")
    return None if in_process or not isolates() else limits
