"""`cosim view` and `cosim video`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from cosim.cli import tasks
from cosim.cli.options import InProcess, Set, Timeout, checked_limits, out_option, quiet
from cosim.errors import CosimError
from cosim.show.console import progress_bar
from cosim.trace.endings import READ, listed
from cosim.writing import whole

Run = Annotated[
    str,
    Argument(
        metavar="TRACE|SCENARIO|FILE.toml",
        help=f"A trace with coordinates ({listed(READ)}), or a scenario, which runs first.",
    ),
]
TracedLoop = Annotated[
    str,
    Argument(metavar="[SCENARIO|FILE.toml]", help="Scenario of the trace; default: the one named in it."),
]
Seconds = Annotated[float, Option(metavar="S", help="Duration of the video or the view, s.")]
Begin = Annotated[float | None, Option("--from", metavar="S", help="Start at this time of the run, s.")]
End = Annotated[float | None, Option("--to", metavar="S", help="End at this time of the run, s.")]
Enlarge = Annotated[
    list[str] | None,
    Option(
        metavar="COORDINATE=FACTOR",
        help="Enlarge a motion, for example `ring_*=20`. Default: motions that are too small to see "
        "are enlarged. May be repeated.",
    ),
]


def view(
    run: Run,
    loop: TracedLoop = "",
    seconds: Seconds = 8.0,
    begin: Begin = None,
    end: End = None,
    enlarge: Enlarge = None,
    set_: Set = None,
    in_process: InProcess = False,
) -> None:
    """Show a run in MuJoCo's viewer.

    The run repeats until the window is closed. The mouse turns and moves the camera.
    The trace must hold MuJoCo's coordinates, see `cosim video`, which needs no screen.
    Requires the extra `replay`.
    """
    from cosim.replay.playback import ReplayOptions, check_seconds

    check_seconds(seconds)
    options = ReplayOptions(seconds=seconds, begin=begin, end=end, enlarge=tuple(enlarge or ()))
    limits = checked_limits(None, None, in_process)
    tasks.perform(limits, None, tasks.replay, run, loop, tuple(set_ or ()), options)


def video(
    run: Run,
    loop: TracedLoop = "",
    out: Annotated[Path, out_option("FILE.mp4|.gif|.webp")] = Path("run.mp4"),
    seconds: Seconds = 8.0,
    begin: Begin = None,
    end: End = None,
    size: Annotated[str, Option(metavar="WIDTHxHEIGHT", help="Width and height in pixels.")] = "640x480",
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
) -> None:
    """Make a video of a run.

    No screen is needed. The video shows the machine, the time, the state, key numbers,
    the playback speed and enlarged motions. The trace must hold MuJoCo's coordinates.

    \b
        cosim run dob --set loop.record_qpos=true --trace dob.npz
        cosim video dob.npz -o dob.mp4

    The same in one step: `cosim video dob -o dob.mp4`. Requires the extra `replay`.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    from cosim.replay import video_file
    from cosim.replay.playback import ReplayOptions

    width, _, height = size.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise CosimError(f"`--size` is `{size}`", "Give width and height in pixels, for example `640x480`.")
    pixels = int(width), int(height)
    options = ReplayOptions(pixels, seconds, begin, end, camera, tuple(enlarge or ()))
    video_file.check(out, options)
    limits = checked_limits(timeout, None, in_process)
    with whole(out) as part, progress_bar("video", quiet()) as progress:
        tasks.perform(limits, progress, tasks.replay, run, loop, tuple(set_ or ()), options, part)
    print(f"wrote {out}")
