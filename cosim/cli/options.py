"""Exit codes, arguments and options that several commands share."""

from __future__ import annotations

from typing import Annotated

from typer import Argument, Option

from cosim import interrupts
from cosim.scenario import complete

FAILED = 1
"""Exit code: a criterion does not hold."""
COULD_NOT_RUN = 2
"""Exit code: the run could not be done."""
INTERRUPTED = interrupts.INTERRUPTED
"""Exit code: Ctrl-C."""
READER_GONE = 141
"""Exit code: nobody reads stdout any more, as a shell tells it of SIGPIPE."""

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
