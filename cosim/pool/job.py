"""What a worker is given to do, and what becomes of it."""

from __future__ import annotations

import dataclasses
import logging
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from cosim.errors import CosimError, FmuError
from cosim.pool.lines import EVENTS

if TYPE_CHECKING:
    from cosim.loop.engines import Engine
    from cosim.loop.place import Place
    from cosim.loop.reference import Progress
    from cosim.loop.result import Result
    from cosim.loop.session import Session
    from cosim.scenario.model import Scenario

# texts: who only waits for a worker imports nothing of what it runs
Outcome: TypeAlias = "Result | CosimError"
"""What became of a run: its result, or why it could not be done."""
Numbered: TypeAlias = "tuple[int, Job]"
Finished: TypeAlias = "tuple[int, Outcome]"

log = logging.getLogger("cosim")


class WorkerError(CosimError):
    """A run that took its worker process with it.

    Attributes
    ----------
    status
        `crashed`, `timeout`, `memory` or `lost`.
    """

    def __init__(self, status: str, message: str, hint: str = "") -> None:
        super().__init__(message, hint)
        self.status = status

    def __reduce__(self) -> tuple[Any, ...]:
        return WorkerError, (self.status, self.message, self.hint)


class Bench(Protocol):
    """What a task finds where it is done."""

    place: Place
    progress: Progress | None

    def session(self, scenario: Scenario, engine: Engine, log_events: bool = False) -> Session:
        """Session of a scenario; what fits of the one before stays open."""


class Task(Protocol):
    """Anything that can be sent to a worker."""

    def run(self, bench: Bench) -> Any:
        """Do it; the return value is sent back."""


@dataclass(frozen=True)
class Job:
    """One run of a scenario with a seed, by the engine of that name, whose result may keep its trace.

    `stream` is the Parquet file that takes the trace instead. Where the log takes events of FMUs, these are
    told to log them.

    `fmus` are the SHA-256 that the FMUs must have, as far as the names of their extracted folders go; none
    takes any.
    """

    scenario: Scenario
    seed: int
    engine: Engine = "native"
    keep_trace: bool = False
    fmus: tuple[str, ...] = ()
    stream: Path | None = None

    def run(self, bench: Bench) -> Result:
        """Run the scenario once."""
        session = self.session(bench)
        for fmu, wanted in zip(session.fmus, self.fmus, strict=False):
            folder = fmu.file.folder
            if folder.name != wanted[: len(folder.name)]:
                problem = f"the FMU `{fmu.file.path}` is not the one the sweep began with"
                raise FmuError(problem, "it was built or copied anew")
        result = session.run(self.seed, bench.progress, self.stream)
        return result if self.keep_trace else dataclasses.replace(result, trace=None)

    def session(self, bench: Bench) -> Session:
        """Session of the scenario, which tells events where the log takes them."""
        return bench.session(self.scenario, self.engine, log.isEnabledFor(EVENTS))


def name(number: int, job: Job) -> str:
    """Name of a run in the log."""
    return f"run {number}, seed {job.seed}"


@dataclass(frozen=True)
class Order:
    """What is sent to a worker: a task, the level of its log, and the lines of it that are wanted at most."""

    task: Task
    level: int
    lines: float
