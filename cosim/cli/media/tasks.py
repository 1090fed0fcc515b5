"""What these commands do in a worker process: plants and FMUs are foreign code."""

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
    from cosim.pool.job import Bench
    from cosim.replay.motion import Recorded
    from cosim.replay.video_file import Shot
    from cosim.scenario.model import Scenario

Run = Annotated[
    str,
    Argument(
        metavar="TRACE|LOOP|FILE.toml",
        help=f"A trace with coordinates ({listed(READ)}), or a scenario, which is run first.",
    ),
]
TracedLoop = Annotated[
    str,
    Argument(metavar="[LOOP|FILE.toml]", help="Scenario of the trace, by default the one that it names."),
]
Seconds = Annotated[float, Option(metavar="S", help="Time that it takes to show it, s.")]
Begin = Annotated[float | None, Option("--from", metavar="S", help="Begin at this time of the run.")]
End = Annotated[float | None, Option("--to", metavar="S", help="End at this time of the run.")]
Enlarge = Annotated[
    list[str] | None,
    Option(
        metavar="COORDINATE=FACTOR",
        help="Draw a motion larger than it is, such as `ring_*=20`; without this what is too small to be "
        "seen is. May be given again.",
    ),
]


def recorded(source: str, loop: str, changes: tuple[str, ...], bench: Bench) -> Recorded:
    """Read a run from its trace, or make it."""
    from cosim.replay.motion import RECORD, of_result, of_trace
    from cosim.scenario.load import load
    from cosim.trace import files

    if Path(source).suffix not in READ:
        if loop:
            raise CosimError(f"`{source}` is no trace", f"a trace ends in {listed(READ)}")
        scenario: Scenario = load(source, (*changes, RECORD))
        session: Session = bench.session(scenario, "native")
        return of_result(scenario, session.run(progress=bench.progress))
    trace = files.read(source)
    name = loop or str(trace.about.get("scenario", ""))
    if not name:
        raise CosimError(f"`{source}` does not tell its scenario", "name it behind the trace")
    if not loop:
        try:
            paths.find_scenario(name)
        except CosimError as error:
            hint = "the file of the scenario may be named behind the trace"
            raise CosimError(f"the scenario of `{source}` is not found: {error.message}", hint) from None
    return of_trace(load(name, changes), trace)


@dataclass(frozen=True)
class View:
    """A run in the viewer.

    Parameters
    ----------
    source, loop, changes
        Trace or scenario, scenario of the trace, and overrides, as for `recorded`.
    shot
        How it is shown.
    """

    source: str
    loop: str
    changes: tuple[str, ...]
    shot: Shot

    def run(self, bench: Bench) -> None:
        """Find the run and show it until the window is closed."""
        from cosim.replay import viewer

        viewer.show(recorded(self.source, self.loop, self.changes, bench), self.shot)


@dataclass(frozen=True)
class Video(View):
    """A run in a film."""

    file: Path

    def run(self, bench: Bench) -> None:
        """Find the run and film it."""
        from cosim.replay import video_file

        found = recorded(self.source, self.loop, self.changes, bench)
        video_file.save(found, self.shot, self.file, bench.progress)


def size(text: str) -> tuple[int, int]:
    """Width and height from a text such as `640x480`."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise typer.BadParameter(f"`{text}` is no size such as `640x480`")
    return int(width), int(height)
