"""Exit codes, arguments and options that several commands share."""

from __future__ import annotations

from typing import Annotated

from typer import Argument, Option

from cosim import interrupts
from cosim.errors import CosimError
from cosim.pool.limits import Limits, isolates, unkept
from cosim.scenario import complete

FAILED = 1
"""Exit code: a criterion does not hold."""
COULD_NOT_RUN = 2
"""Exit code: the run could not be done."""
INTERRUPTED = interrupts.INTERRUPTED
"""Exit code: Ctrl-C."""
READER_GONE = 141
"""Exit code: nobody reads stdout any more, as a shell tells it of SIGPIPE."""
MAX_SEED = 2**63 - 1
"""Largest seed: integers of scenarios have 64 bits."""

Timeout = Annotated[float | None, Option(metavar="S", help="Most wall time in s.")]
InProcess = Annotated[
    bool, Option("--in-process", help="Work in this process, for debuggers; a crash ends it.")
]
Json = Annotated[str | None, Option(metavar="FILE|-", help="Write the result as JSON; `-` is stdout.")]
Verbose = Annotated[
    bool, Option("-v", "--verbose", help="Log what the FMU reports, and where an error came from.")
]
Quiet = Annotated[bool, Option("-q", "--quiet", help="Log errors only, no progress.")]
Loop = Annotated[
    str,
    Argument(
        metavar="LOOP|FILE.toml",
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
        "`criterion.<id>.<key>`. May be given again.",
    ),
]


def checked_limits(timeout: float | None, memory: float | None, in_process: bool) -> Limits | None:
    """Limits of what is done in a process of its own, None where it is done in this one.

    Raises
    ------
    CosimError
        A limit that nothing can be held to, or there is no process that could keep it.
    """
    limits = Limits(timeout, None if memory is None else 1e6 * memory, keys=("--timeout", "--memory"))
    for name, value in (("--timeout", timeout), ("--memory", memory)):
        if value is not None and in_process:
            raise CosimError(f"`{name}` needs a process of its own", "leave `--in-process` out")
    for option in unkept(limits):
        problem = f"{option} cannot be kept: this system has no supervised worker processes"
        raise CosimError(problem, f"leave {option} out; then all is done in the process of the command")
    return None if in_process or not isolates() else limits
