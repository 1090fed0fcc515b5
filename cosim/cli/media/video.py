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
from cosim.writing import whole


def video(
    run: Run,
    loop: TracedLoop = "",
    out: Annotated[Path, Option("-o", "--out", metavar="FILE.mp4|.gif|.webp", help="Output file.")] = Path(
        "run.mp4"
    ),
    seconds: Seconds = 8.0,
    begin: Begin = None,
    end: End = None,
    size_: Annotated[
        str, Option("--size", metavar="WIDTHxHEIGHT", help="Width and height in pixels.")
    ] = "640x480",
    camera: Annotated[
        str,
        Option(
            metavar="NAME",
            help="Camera of the MJCF. Default: `closeup` with `overview` in a corner, or an overall view.",
        ),
    ] = "",
    enlarge: Enlarge = None,
    set_: Set = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
    verbose: Verbose = False,
    quiet: Quiet = False,
) -> None:
    """Make a video of a run.

    No screen is needed. The video shows the machine, the time, the state, key numbers,
    the playback speed and enlarged motions. The trace must hold MuJoCo's coordinates.

    \b
        cosim run dob --set loop.record_qpos=true --trace dob.npz
        cosim video dob.npz -o dob.mp4

    The same in one step: `cosim video dob -o dob.mp4`. Requires the extra `replay`.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    configure_logging(verbose, quiet)
    from cosim.replay import video_file
    from cosim.replay.playback import ReplayOptions

    options = ReplayOptions(size(size_), seconds, begin, end, camera, tuple(enlarge or ()))
    video_file.check(out, options)
    with whole(out) as part:
        task = Video(run, loop, tuple(set_ or ()), options, part)
        with place(checked_limits(timeout, None, in_process)) as do, progress_bar("video", quiet) as progress:
            outcome: CosimError | None = do(task, progress)
        if outcome is not None:
            raise outcome
    print(f"wrote {out}")
