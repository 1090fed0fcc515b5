"""Work of these commands in a worker process: plants and FMUs are foreign code."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer import Argument, Option

from cosim import paths
from cosim.errors import CosimError
from cosim.trace.endings import READ, listed

if TYPE_CHECKING:
    from cosim.loop.session import Session
    from cosim.pool.job import WorkerContext
    from cosim.replay.motion import Recorded
    from cosim.replay.playback import ReplayOptions
    from cosim.scenario.model import Scenario

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


def recorded(source: str, loop: str, changes: tuple[str, ...], context: WorkerContext) -> Recorded:
    """Read a run from its trace, or run the scenario."""
    from cosim.replay.motion import RECORD, of_result, of_trace
    from cosim.scenario.load import load
    from cosim.trace import files

    if Path(source).suffix not in READ:
        if loop:
            raise CosimError(f"`{source}` is not a trace", f"Use a trace that ends in {listed(READ)}.")
        scenario: Scenario = load(source, (*changes, RECORD))
        session: Session = context.session(scenario, "native")
        return of_result(scenario, session.run(progress=context.progress))
    trace = files.read(source)
    name = loop or str(trace.about.get("scenario", ""))
    if not name:
        raise CosimError(f"`{source}` does not name its scenario", "Name the scenario after the trace.")
    if not loop:
        try:
            paths.find_scenario(name)
        except CosimError as error:
            hint = "Name the file of the scenario after the trace."
            raise CosimError(f"the scenario of `{source}` is not found: {error.message}", hint) from None
    return of_trace(load(name, changes), trace)


@dataclass(frozen=True)
class View:
    """A run in the viewer.

    Parameters
    ----------
    source, loop, changes
        Trace or scenario, scenario of the trace, and overrides, as for `recorded`.
    options
        Settings of the view.
    """

    source: str
    loop: str
    changes: tuple[str, ...]
    options: ReplayOptions

    def run(self, context: WorkerContext) -> None:
        """Find the run and show it until the window is closed."""
        from cosim.replay import viewer

        viewer.show(recorded(self.source, self.loop, self.changes, context), self.options)


@dataclass(frozen=True)
class Video(View):
    """A run in a video."""

    file: Path

    def run(self, context: WorkerContext) -> None:
        """Find the run and make its video."""
        from cosim.replay import video_file

        found = recorded(self.source, self.loop, self.changes, context)
        video_file.save(found, self.options, self.file, context.progress)


def size(text: str) -> tuple[int, int]:
    """Width and height from a text such as `640x480`."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise typer.BadParameter(f"`{text}` is not a size such as `640x480`")
    return int(width), int(height)
