"""The command line: all commands and their exit codes."""

from __future__ import annotations

import errno
import logging
import os
import sys
from collections.abc import Callable
from typing import Any

import typer
import typer.exceptions
from typer.core import TyperCommand, TyperGroup, TyperOption

from cosim import RENAMED, errors, interrupts
from cosim.cli.compare import compare, evaluate, plot
from cosim.cli.new import new, ssp
from cosim.cli.options import COULD_NOT_RUN, READER_GONE, options
from cosim.cli.run import run, video, view
from cosim.cli.show import cache, check, list_scenarios, schema, show
from cosim.cli.sweep import optimize, sweep
from cosim.cli.test import report_page, run_tests
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.interrupts import INTERRUPTED
from cosim.show.console import configure_logging, report
from cosim.warned import once
from cosim.writing import write

NO_ROOM = (errno.ENOSPC, errno.EFBIG, errno.EIO, getattr(errno, "EDQUOT", errno.ENOSPC))
"""Disk errors of a redirected stdout."""
log = logging.getLogger("cosim")


VERBOSITY = [
    TyperOption(param_decls=[short, long], is_flag=True, default=False, help=help_text)
    for short, long, help_text in (
        ("-v", "--verbose", "Log events of the FMU and the origin of errors."),
        ("-q", "--quiet", "Log errors only, no progress."),
    )
]
"""Options before or after any command."""


class Command(TyperCommand):
    """A command that prints its error as JSON, if JSON on stdout is requested; files keep their content."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.params += VERBOSITY

    def invoke(self, ctx: Any) -> Any:
        """Run the command."""
        configure_logging(**popped(ctx.params))
        try:
            return super().invoke(ctx)
        except CosimError as error:
            if ctx.params.get("json") == "-":
                write(strict.text(error.to_dict()), "-")
            raise


class Commands(TyperGroup):
    """All commands; the options before a command are the defaults of those after it."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.params += VERBOSITY

    def invoke(self, ctx: Any) -> Any:
        """Run the given command."""
        ctx.default_map = dict.fromkeys(self.commands, popped(ctx.params))
        return super().invoke(ctx)


def popped(parameters: dict[str, Any]) -> dict[str, bool]:
    """Remove `verbose` and `quiet` from parameters, and return them."""
    return {name: parameters.pop(name) for name in ("verbose", "quiet")}


app = typer.Typer(
    cls=Commands,
    pretty_exceptions_enable=False,
    # plain help: rich takes longer to import than everything else
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Run FMUs in closed loop with plants and check the results against criteria.",
    epilog="Exit code: 0 all criteria passed, 1 a criterion failed, 2 could not run.",
)
app.callback()(options)
COMMANDS: dict[str, Callable[..., None]] = {
    "list": list_scenarios, "show": show, "new": new, "check": check, "run": run, "test": run_tests,
    "report": report_page, "view": view, "video": video, "evaluate": evaluate, "compare": compare,
    "plot": plot, "sweep": sweep, "optimize": optimize, "schema": schema, "ssp": ssp, "cache": cache,
}  # fmt: skip
for name, command in COMMANDS.items():
    app.command(name, cls=Command)(command)


def status_of(command: Any) -> int:
    """Exit code of a command; an error prints one message, with a traceback only on request."""
    try:
        with interrupts.raising(), once():
            code = command(standalone_mode=False)
            sys.stdout.flush()
    except BaseException as error:
        return failed(error)
    if code == INTERRUPTED:
        report("interrupted")
    if code and about_completion():
        report("completion is not available for this shell", "Use bash, zsh, fish or PowerShell.")
        return COULD_NOT_RUN
    return code if isinstance(code, int) else 0


def failed(error: BaseException) -> int:
    """Report an error; return its exit code."""
    if isinstance(error, SystemExit):
        # typer ends silently when the reader of its output is gone; any other exit is unexpected
        if isinstance(error.__context__, BrokenPipeError):
            return READER_GONE
        # a shell that requests completions sets the variable; typer prints them and ends the process
        if "_COSIM_COMPLETE" in os.environ or about_completion():
            return 0
    if isinstance(error, typer.Abort) or is_interrupt(error):
        report("interrupted")
        return INTERRUPTED
    if isinstance(error, typer.exceptions.TyperException):
        context = getattr(error, "ctx", None)
        word = next((word for word in sys.argv[1:] if not word.startswith("-")), "")
        called = context.command_path if context else " ".join(["cosim", *filter(COMMANDS.get, [word])])
        hint = f"Show the arguments with `{called} --help`."
        # typer lists choices in lines of their own
        message = " ".join(error.format_message().split())
        report(message, f"Use `cosim {RENAMED[word]}`." if word in RENAMED else hint)
    elif isinstance(error, OSError) and error.filename is None and error.errno in NO_ROOM:
        report(f"cannot write the result: {error.strerror}")
    else:
        log.debug("here:", exc_info=error)
        failure = error if isinstance(error, CosimError) else errors.unforeseen(error)
        report(failure.message, failure.hint)
    return COULD_NOT_RUN


def about_completion() -> bool:
    """Whether the command line requests only shell completion, which typer handles."""
    return sys.argv[1:2] in (["--install-completion"], ["--show-completion"])


def is_interrupt(error: BaseException | None) -> bool:
    """Whether Ctrl-C caused an error: a module in C turns it into its own `ImportError`."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None
