"""Tasks that run foreign code: in a worker process, or with `--in-process` in this one."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim import interrupts
from cosim.show.console import Sheet, rendered

if TYPE_CHECKING:
    from cosim.check.checked import Checked
    from cosim.loop.engines import Engine
    from cosim.loop.result import Result
    from cosim.pool.job import WorkerContext
    from cosim.pool.limits import Limits
    from cosim.scenario.assignment import Assignment
    from cosim.scenario.model import Scenario


def place(limits: Limits | None) -> AbstractContextManager[Callable[..., Any]]:
    """Runner of tasks, see `single_task.executor`; imports its dependencies now."""
    with interrupts.handled_by(interrupts.quit_at_once):
        from cosim.pool import single_task
    return single_task.executor(limits)


@dataclass(frozen=True)
class Report:
    """Printable outcome of a run; printing it needs no further import.

    Parameters
    ----------
    table, json
        The result as a table and as JSON.
    result
        The result, if a plot or a trace that was not streamed is requested.
    scenario
        The scenario, if a plot is requested.
    """

    passed: bool | None
    table: str
    json: str
    result: Result | None
    scenario: Scenario | None


@dataclass(frozen=True)
class Single:
    """One run from the arguments of a command line.

    Parameters
    ----------
    loop, changes
        The scenario and its overrides, as for `cosim.load`.
    verbose
        Whether the FMU logs events.
    trace
        File of the trace or None.
    plot
        File of the plot or None; it is checked before the run.
    sheet
        Output device of the table.
    stream
        File that the run writes and that becomes the trace, if its format allows that.
    """

    loop: str
    changes: tuple[str | Assignment, ...]
    engine: Engine
    verbose: bool
    trace: Path | None
    plot: Path | None
    sheet: Sheet
    stream: Path | None = None

    def run(self, context: WorkerContext) -> Report:
        """Run once."""
        from cosim.fmu import stale
        from cosim.loop import time_series
        from cosim.scenario.load import load
        from cosim.show import display
        from cosim.trace import files

        scenario = load(self.loop, self.changes)
        session = context.session(scenario, self.engine, self.verbose)
        stale.warn_of(scenario.fmus, scenario.folder)
        if self.plot is not None:
            from cosim.show import figure

            figure.check(self.plot)
            session.check_drawn()
        if self.trace is not None:
            time_series.check_apart(scenario, "--trace", self.trace)
            files.check_rows(self.trace, scenario.loop.rows)
        result = session.run(progress=context.progress, stream=self.stream)
        return Report(
            passed=result.passed,
            table=rendered(display.result(result), self.sheet),
            json=result.to_json(),
            result=result if self.plot or (self.trace and not self.stream) else None,
            scenario=scenario if self.plot else None,
        )


@dataclass(frozen=True)
class Show:
    """The tables of a scenario for an output device."""

    loop: str
    changes: tuple[str, ...]
    parts: tuple[str, ...]
    sheet: Sheet

    def run(self, context: WorkerContext) -> str:
        """Open the scenario and describe it."""
        from cosim.fmu import stale
        from cosim.scenario.load import load
        from cosim.show import display

        scenario = load(self.loop, self.changes)
        session = context.session(scenario, "reference")
        stale.warn_of(scenario.fmus, scenario.folder)
        return rendered(display.scenario(scenario, session.fmus, session.plant, self.parts), self.sheet)


@dataclass(frozen=True)
class Schema:
    """JSON schema of scenarios with the FMUs and the plant of one scenario."""

    loop: str

    def run(self, context: WorkerContext) -> dict[str, Any]:
        """Describe their settings; the FMUs are only read."""
        from cosim.loop import fmus, plant
        from cosim.loop.place import Stage
        from cosim.loop.session import located
        from cosim.scenario.load import load
        from cosim.schema.filled import filled_schema, settable_variables

        scenario = load(self.loop)
        context.place.begin("", scenario.plant.name, 0, 0.0)
        with located(scenario):
            files = fmus.open_files(scenario)
            context.place.at(Stage.BUILD_PLANT)
            kind = plant.plant_class(scenario.plant.name, scenario.folder)
            plant.check_class(kind)
            context.place.at(Stage.NONE)
        found = {name: settable_variables(file.variables.values()) for name, file in files.items()}
        return filled_schema(scenario, found, kind.Parameters)


@dataclass(frozen=True)
class Check:
    """One file of any kind."""

    file: str

    def run(self, context: WorkerContext) -> Checked:
        """Check the file without a run."""
        from cosim.check.files import check

        return check(self.file, context.place)


@dataclass(frozen=True)
class DraftText:
    """Text of a new scenario, its number of wires, and of inputs and commands without a wire."""

    text: str
    wired: int
    left: int


@dataclass(frozen=True)
class New:
    """Draft of a scenario in `folder` for an FMU and an optional plant."""

    fmu: str
    plant: str
    folder: Path

    def run(self, context: WorkerContext) -> DraftText:
        """Open both and match them."""
        from cosim.new.draft import draft
        from cosim.new.write import text

        found = draft(self.fmu, self.plant, self.folder, context.place)
        wired = len(found.readings) + len(found.commands)
        return DraftText(text(found), wired, len(found.inputs) + len(found.commanded) - wired)
