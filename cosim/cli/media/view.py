"""`cosim view`."""

from __future__ import annotations

from cosim.cli.media.tasks import Begin, End, Enlarge, Run, Seconds, TracedLoop, View
from cosim.cli.options import InProcess, Quiet, Set, Verbose, checked_limits
from cosim.cli.tasks import place
from cosim.errors import CosimError
from cosim.show.console import configure_logging


def view(
    run: Run,
    loop: TracedLoop = "",
    seconds: Seconds = 8.0,
    begin: Begin = None,
    end: End = None,
    enlarge: Enlarge = None,
    set_: Set = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Show a run in MuJoCo's viewer.

    The run repeats until the window is closed. The mouse turns and moves the camera.
    The trace must hold MuJoCo's coordinates, see `cosim video`, which needs no screen.
    Requires the extra `replay`.
    """
    configure_logging(verbose, quiet)
    from cosim.replay.playback import ReplayOptions, check_seconds

    check_seconds(seconds)
    options = ReplayOptions(seconds=seconds, begin=begin, end=end, enlarge=tuple(enlarge or ()))
    with place(checked_limits(None, None, in_process)) as do:
        outcome: CosimError | None = do(View(run, loop, tuple(set_ or ()), options))
    if outcome is not None:
        raise outcome
