"""`cosim run`, `cosim view` and `cosim video`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer
from typer import Argument, Option

from cosim.cli import options, tasks
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.scenario.assignment import Assignment
from cosim.show.console import progress_bar, report, stdout
from cosim.trace import endings
from cosim.writing import check_apart, check_folder, whole, whole_if

if TYPE_CHECKING:
    from cosim.pool.limits import Limits

TRACE = (
    f"Write the trace: {endings.listed(endings.WRITTEN)}. A Parquet file is written during the run, "
    "with little memory."
)
Run = Annotated[
    str,
    Argument(
        metavar="TRACE|SCENARIO|FILE.toml",
        help=f"A trace with coordinates ({endings.listed(endings.READ)}), or a scenario, which runs first.",
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


def run(
    loop: options.Loop,
    set_: options.Set = None,
    seed: options.Seed = None,
    seeds: Annotated[
        str | None,
        Option(metavar="FIRST..LAST|N,N", help="Run once with each seed and print the distributions."),
    ] = None,
    workers: options.Workers = None,
    engine: options.Engine = "native",
    delay: Annotated[
        int | None, Option(metavar="STEPS", help="Delay of the commands in steps: 0 or 1.")
    ] = None,
    duration: Annotated[float | None, Option(metavar="S", help="Simulated time in s.")] = None,
    json: options.Json = None,
    trace: Annotated[Path | None, Option(metavar="FILE.npz|.csv|...", help=TRACE)] = None,
    plot: Annotated[Path | None, Option(metavar="FILE.svg|.png|.pdf", help="Plot the run.")] = None,
    timeout: options.Timeout = None,
    memory: options.Memory = None,
    in_process: options.InProcess = False,
) -> None:
    """Run a scenario and evaluate its criteria.

    \b
        cosim run dob --set plant.mass=11.0 --plot dob.svg
        cosim run dob --seeds 1..20

    Exit code: 0 all criteria passed, 1 a criterion failed, 2 could not run.
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    assignments = (
        Assignment("--seed", "loop.seed", seed),
        Assignment("--delay", "loop.compute_delay", delay),
        Assignment("--duration", "loop.duration", duration),
    )
    changes = (*(set_ or ()), *(option for option in assignments if option.value is not None))
    limits = options.checked_limits(timeout, memory, in_process)
    if trace is not None:
        endings.check(trace)
    if plot is not None:
        check_folder(plot)
    check_apart({"--json": Path(json) if json and json != "-" else None, "--trace": trace, "--plot": plot})
    if seeds is not None:
        for option, given in (("--seed", seed), ("--trace", trace), ("--plot", plot)):
            if given is not None:
                hint = f"Repeat one run with `--seed` to get its {option[2:]}."
                if option == "--seed":
                    hint = "Use `--seed 7` for one run or `--seeds 1..20` for twenty."
                raise CosimError(f"`{option}` and `--seeds` cannot be given together", hint)
        run_seeds(loop, changes, seeds, engine, limits, workers, json)
    if workers is not None:
        raise CosimError("`--workers` applies to several runs only", "Add `--seeds`, or omit it.")
    stream = trace if trace is not None and endings.streams(trace) else None
    with whole_if(stream) as part:
        arguments = loop, changes, engine, trace, plot, stdout(), part
        with progress_bar(loop, options.quiet()) as progress:
            done = tasks.perform(limits, progress, tasks.single, *arguments)
    save(done, trace, plot)
    written = [f"wrote {file}" for file in (trace, plot) if file]
    options.emit(json, done.json, done.table.removesuffix("\n"), *written)
    raise typer.Exit(options.FAILED if done.passed is False else 0)


def save(report: tasks.Report, trace: Path | None, plot: Path | None) -> None:
    """Write the requested files."""
    if trace is not None and report.result is not None and not endings.streams(trace):
        report.result.save_trace(trace)
    if plot is not None and report.result is not None and report.scenario is not None:
        from cosim.show import plot as plots

        # the file that the run wrote has its name now
        streamed = replace(report.result, file=trace) if report.result.file else report.result
        plots.save(report.scenario, streamed, plot)


def run_seeds(
    loop: str,
    changes: Sequence[str | Assignment],
    text: str,
    engine: options.Engine,
    limits: Limits | None,
    workers: int | None,
    json: str | None,
) -> NoReturn:
    """Run a scenario with several seeds, print the distributions and exit."""
    from cosim.fmu import stale
    from cosim.scenario.load import load
    from cosim.sweep import seeds

    scenario = load(loop, changes)
    stale.warn_of(scenario.fmus, scenario.folder)
    chosen = seeds.parse(text)
    with progress_bar(f"{scenario.name}, {len(chosen)} seeds", options.quiet()) as progress:
        outcomes = seeds.run(scenario, chosen, engine, limits, progress, workers)
    found = seeds.summarize(chosen, outcomes)
    runs = [seeds.plain(seed, outcome) for seed, outcome in zip(chosen, outcomes, strict=True)]
    options.emit(json, strict.text(runs), seeds.tables(scenario, found))
    if found.results < found.runs:
        (_, reason), *_ = found.troubles
        report(f"{found.runs - found.results} of {found.runs} runs gave no result; the first: {reason}")
        raise typer.Exit(options.COULD_NOT_RUN)
    raise typer.Exit(options.FAILED if found.passed is False else 0)


def view(
    run: Run,
    loop: TracedLoop = "",
    seconds: Seconds = 8.0,
    begin: Begin = None,
    end: End = None,
    enlarge: Enlarge = None,
    set_: options.Set = None,
    in_process: options.InProcess = False,
) -> None:
    """Show a run in MuJoCo's viewer.

    The run repeats until the window is closed. The mouse turns and moves the camera.
    The trace must hold MuJoCo's coordinates, see `cosim video`, which needs no screen.
    Requires the extra `replay`.
    """
    from cosim.replay.playback import ReplayOptions, check_seconds

    check_seconds(seconds)
    shown = ReplayOptions(seconds=seconds, begin=begin, end=end, enlarge=tuple(enlarge or ()))
    limits = options.checked_limits(None, None, in_process)
    tasks.perform(limits, None, tasks.replay, run, loop, tuple(set_ or ()), shown)


def video(
    run: Run,
    loop: TracedLoop = "",
    out: Annotated[Path, options.out_option("FILE.mp4|.gif|.webp")] = Path("run.mp4"),
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
    set_: options.Set = None,
    timeout: options.Timeout = None,
    in_process: options.InProcess = False,
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
    shown = ReplayOptions(pixels, seconds, begin, end, camera, tuple(enlarge or ()))
    video_file.check(out, shown)
    limits = options.checked_limits(timeout, None, in_process)
    with whole(out) as part, progress_bar("video", options.quiet()) as progress:
        tasks.perform(limits, progress, tasks.replay, run, loop, tuple(set_ or ()), shown, part)
    print(f"wrote {out}")
