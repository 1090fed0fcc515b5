"""Tasks of workers and their outcomes."""

from __future__ import annotations

import dataclasses
import logging
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from cosim.errors import CosimError, FmuError
from cosim.loop.repeats import Verdicts

if TYPE_CHECKING:
    from cosim.loop.engines import Engine
    from cosim.loop.position import Position
    from cosim.loop.reference import Progress
    from cosim.loop.result import Result
    from cosim.loop.session import Session
    from cosim.scenario.model import Scenario

# texts: a process that only waits for a worker imports nothing of what it runs
Outcome: TypeAlias = "Result | CosimError"
"""Outcome of a run: its result or its error."""
Numbered: TypeAlias = "tuple[int, Job]"
Finished: TypeAlias = "tuple[int, Outcome]"

EVENTS = logging.INFO
"""Log level of FMU events; a log at this level is not limited."""
log = logging.getLogger("cosim")


class WorkerError(CosimError):
    """A run that ended its worker process, with the status `crashed`, `timeout` or `memory`."""

    def __init__(self, status: str, message: str, hint: str = "") -> None:
        super().__init__(message, hint)
        self.status = status

    def __reduce__(self) -> tuple[Any, ...]:
        return WorkerError, (self.status, self.message, self.hint)


class WorkerContext(Protocol):
    """Environment of a task."""

    position: Position
    progress: Progress | None

    def session(self, scenario: Scenario, engine: Engine, log_events: bool = False) -> Session:
        """Session of a scenario; suitable open FMUs and plants are reused."""


class Task(Protocol):
    """A task that can be sent to a worker."""

    def run(self, context: WorkerContext, /) -> Any:
        """Execute the task; the return value is sent back."""


@dataclass(frozen=True)
class Request:
    """Message to a worker: a task, the log level, the maximum number of log lines, and known verdicts."""

    task: Task
    level: int
    lines: float
    verdicts: Verdicts


@dataclass(frozen=True)
class Job:
    """One run of a scenario with a seed and an engine; its result can keep the trace.

    `stream` is a Parquet file for the trace. `fmus` are the required SHA-256 of the FMUs, compared with the
    names of their extracted folders; empty accepts any.
    """

    scenario: Scenario
    seed: int
    engine: Engine = "native"
    keep_trace: bool = False
    fmus: tuple[str, ...] = ()
    stream: Path | None = None

    def run(self, context: WorkerContext) -> Result:
        """Run the scenario once."""
        session = self.session(context)
        for fmu, wanted in zip(session.fmus, self.fmus, strict=False):
            folder = fmu.file.folder
            if folder.name != wanted[: len(folder.name)]:
                problem = f"the FMU `{fmu.file.path}` is not the FMU with which the sweep started"
                raise FmuError(problem, "Start a new sweep after a rebuild of the FMU.")
        result = session.run(self.seed, context.progress, self.stream)
        return result if self.keep_trace else dataclasses.replace(result, trace=None)

    def session(self, context: WorkerContext) -> Session:
        """Session of the scenario, whose FMUs log events if the log level includes them."""
        return context.session(self.scenario, self.engine, log.isEnabledFor(EVENTS))


def name(number: int, job: Job) -> str:
    """Name of a run in the log."""
    return f"run {number}, seed {job.seed}"
