"""`cosim video`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Option

from cosim.cli.media.tasks import Begin, End, Enlarge, Run, Seconds, TracedLoop, Video, size
from cosim.cli.options import InProcess, Quiet, Set, Timeout, Verbose, checked_limits
from cosim.cli.tasks import place
from cosim.errors import CosimError
from cosim.show.console import configure_logging, progress_bar
from cosim.writing import discard


def video(
    run: Run,
    loop: TracedLoop = "",
    out: Annotated[Path, Option("-o", "--out", metavar="FILE.mp4|.gif|.webp", help="The film.")] = Path(
        "run.mp4"
    ),
    seconds: Seconds = 8.0,
    begin: Begin = None,
    end: End = None,
    size_: Annotated[str, Option("--size", metavar="WIDTHxHEIGHT", help="Pixels.")] = "640x480",
    camera: Annotated[
        str,
        Option(
            help="Camera of the MJCF; by default `closeup` with `overview` in a corner, or one that sees all."
        ),
    ] = "",
    enlarge: Enlarge = None,
    set_: Set = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Film a run without a screen: the machine as MuJoCo draws it, with time, state and key numbers.

    The trace must hold MuJoCo's coordinates. Time-lapse or slow motion, and what
    is drawn larger than it is, are told in the picture. So:

        cosim run dob --set loop.record_qpos=true --trace dob.npz
        cosim video dob.npz -o dob.mp4

    or at once `cosim video dob -o dob.mp4`. It needs the extra `replay`.
    """
    configure_logging(verbose, quiet)
    from cosim.replay import video_file

    shot = video_file.Shot(size(size_), seconds, begin, end, camera, tuple(enlarge or ()))
    video_file.check(out, shot)
    task = Video(run, loop, tuple(set_ or ()), shot, out)
    try:
        with place(checked_limits(timeout, None, in_process)) as do, progress_bar("film", quiet) as progress:
            outcome: CosimError | None = do(task, progress)
    finally:
        discard(out)
    if outcome is not None:
        raise outcome
    print(f"wrote {out}")
