"""Tasks that run foreign code: in a worker process, or with `--in-process` in this one."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, TypeVar

from cosim import interrupts, paths
from cosim.errors import CosimError
from cosim.show.console import Sheet, rendered
from cosim.trace.endings import READ, listed

if TYPE_CHECKING:
    from cosim.check.checked import Checked
    from cosim.loop.engines import Engine
    from cosim.loop.reference import Progress
    from cosim.loop.result import Result
    from cosim.pool.job import WorkerContext
    from cosim.pool.limits import Limits
    from cosim.replay.motion import Recorded
    from cosim.replay.playback import ReplayOptions
    from cosim.scenario.assignment import Assignment
    from cosim.scenario.model import Scenario

P = ParamSpec("P")
T = TypeVar("T")

log = logging.getLogger("cosim")


@dataclass(frozen=True)
class TaskCall:
    """A function of this module, and its arguments after the context."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]

    def run(self, context: WorkerContext) -> Any:
        """Call the function."""
        return self.function(context, *self.arguments)


def executor(limits: Limits | None) -> AbstractContextManager[Callable[..., Any]]:
    """Runner of tasks, see `single_task.executor`; imports its dependencies now."""
    with interrupts.handled_by(interrupts.quit_at_once):
        from cosim.pool import single_task
    return single_task.executor(limits)


def perform(
    limits: Limits | None,
    progress: Progress | None,
    function: Callable[Concatenate[WorkerContext, P], T],
    *arguments: P.args,
    **_: P.kwargs,
) -> T:
    """Return the outcome of one task; raise its error."""
    with executor(limits) as do:
        outcome: T | CosimError = do(TaskCall(function, arguments), progress)
    if isinstance(outcome, CosimError):
        raise outcome
    return outcome


@dataclass(frozen=True)
class Report:
    """Printable outcome of a run; printing it needs no further import.

    `result` is kept for a plot or a trace that was not streamed, `scenario` for a plot.
    """

    passed: bool | None
    table: str
    json: str
    result: Result | None
    scenario: Scenario | None


def single(
    context: WorkerContext,
    loop: str,
    changes: tuple[str | Assignment, ...],
    engine: Engine,
    trace: Path | None,
    plot: Path | None,
    sheet: Sheet,
    stream: Path | None,
) -> Report:
    """Run a scenario once.

    `stream` is the file that the run writes and that becomes the trace, if its format allows that. The plot
    is checked before the run.
    """
    from cosim.fmu import stale
    from cosim.loop import time_series
    from cosim.scenario.load import load
    from cosim.show import display
    from cosim.trace import files

    scenario = load(loop, changes)
    session = context.session(scenario, engine, log.isEnabledFor(logging.DEBUG))
    stale.warn_of(scenario.fmus, scenario.folder)
    if plot is not None:
        from cosim.show import figure

        figure.check(plot)
        session.check_drawn()
    if trace is not None:
        time_series.check_apart(scenario, "--trace", trace)
        files.check_rows(trace, scenario.loop.rows)
    result = session.run(progress=context.progress, stream=stream)
    return Report(
        passed=result.passed,
        table=rendered(display.result(result), sheet),
        json=result.to_json(),
        result=result if plot or (trace and not stream) else None,
        scenario=scenario if plot else None,
    )


def show(
    context: WorkerContext, loop: str, changes: tuple[str, ...], parts: tuple[str, ...], sheet: Sheet
) -> str:
    """Return the tables of a scenario for an output device."""
    from cosim.fmu import stale
    from cosim.scenario.load import load
    from cosim.show import display

    scenario = load(loop, changes)
    session = context.session(scenario, "reference")
    stale.warn_of(scenario.fmus, scenario.folder)
    return rendered(display.scenario(scenario, session.fmus, session.plant, parts), sheet)


def schema(context: WorkerContext, loop: str) -> dict[str, Any]:
    """Return the JSON schema of scenarios with the FMUs and the plant of one; the FMUs are only read."""
    from cosim.loop import fmus, plant
    from cosim.loop.session import located
    from cosim.pool.single_task import ImportPlant
    from cosim.scenario.load import load
    from cosim.schema.filled import filled_schema, settable_variables

    scenario = load(loop)
    with located(scenario):
        files = fmus.open_files(scenario)
        ImportPlant(scenario.plant.name, scenario.folder).run(context)
        kind = plant.plant_class(scenario.plant.name, scenario.folder)
        plant.check_class(kind)
    found = {name: settable_variables(file.variables.values()) for name, file in files.items()}
    return filled_schema(scenario, found, kind.Parameters)


def check(context: WorkerContext, file: str) -> Checked:
    """Check a file of any kind without a run."""
    from cosim.check.files import check

    return check(file, context.position)


def new(context: WorkerContext, fmu: str, plant: str, folder: Path) -> tuple[str, int, int]:
    """Text of a scenario in `folder`; its number of wires, and of inputs and commands without a wire."""
    from cosim.new.draft import draft
    from cosim.new.write import text

    found = draft(fmu, plant, folder, context.position)
    wired = sum(len(side.wires) for side in found.sides)
    return text(found), wired, sum(len(side.undriven) for side in found.sides)


def ssp(context: WorkerContext, loop: str, changes: tuple[str, ...], seed: int | None, file: Path) -> float:
    """Write a scenario as an SSP package; return the communication step in s."""
    from cosim.ssp.package import write

    return write(loop, changes, seed, file, context.position).loop.step


def recorded(context: WorkerContext, source: str, loop: str, changes: tuple[str, ...]) -> Recorded:
    """Read a run from its trace `source`, or run that scenario; `loop` is the scenario of the trace."""
    from cosim.replay.motion import RECORD, of_result, of_trace
    from cosim.scenario.load import load
    from cosim.trace import files

    if Path(source).suffix not in READ:
        if loop:
            raise CosimError(f"`{source}` is not a trace", f"Use a trace that ends in {listed(READ)}.")
        scenario = load(source, (*changes, RECORD))
        session = context.session(scenario, "native")
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


def replay(
    context: WorkerContext,
    source: str,
    loop: str,
    changes: tuple[str, ...],
    options: ReplayOptions,
    file: Path | None = None,
) -> None:
    """Make a video file of a run; without a file, show the run until the window is closed."""
    run = recorded(context, source, loop, changes)
    if file is not None:
        from cosim.replay import video_file

        video_file.save(run, options, file, context.progress)
    else:
        from cosim.replay import viewer

        viewer.show(run, options)
