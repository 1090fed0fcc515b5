"""Single tasks with foreign code: in a supervised worker process, or in this process on request."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cosim import interrupts
from cosim.errors import CosimError
from cosim.loop.position import Stage
from cosim.pool.job import WorkerContext
from cosim.pool.limits import Limits
from cosim.pool.supervisor import Worker

Execute = Callable[..., Any]
"""Executes a task with optional progress; the outcome is a `CosimError` if it failed."""
ahead: list[Worker] = []
"""The worker that was started in advance."""


@contextlib.contextmanager
def started_ahead() -> Iterator[None]:
    """Start a worker process in advance, because its imports take as long as those of a command.

    An unused process ends with the block.
    """
    with contextlib.ExitStack() as stack:
        # an executor without it starts its own process and reports errors
        with contextlib.suppress(CosimError):
            worker = stack.enter_context(Worker(Limits(), relay=True))
            worker.prepare()
            ahead.append(worker)
        try:
            yield
        finally:
            ahead.clear()


@contextlib.contextmanager
def executor(limits: Limits | None) -> Iterator[Execute]:
    """Executor of consecutive tasks with limits of each; None executes them in this process, unprotected."""
    if limits is not None:
        with ahead.pop() if ahead else Worker(limits, relay=True) as worker:
            worker.limits = limits
            worker.prepare()
            yield worker.call
        return
    with interrupts.handled_by(interrupts.quit_at_once):
        from cosim.pool.worker import JobRunner

    with interrupts.second_ends_all(), JobRunner() as runner:
        yield runner.run


@dataclass(frozen=True)
class ImportPlant:
    """The import of a plant's class."""

    name: str
    folder: Path

    def run(self, context: WorkerContext) -> None:
        """Import it."""
        from cosim.loop import plant

        context.position.begin("", self.name, 0, 0.0)
        context.position.at(Stage.BUILD_PLANT)
        try:
            plant.plant_class(self.name, self.folder)
        except SystemExit as error:
            raise plant.exited(self.name, error) from error
        context.position.at(Stage.NONE)


def check_import(name: str, folder: Path) -> None:
    """Check in a separate process whether a plant's module can be imported; raises the error."""
    with executor(Limits()) as execute:
        outcome = execute(ImportPlant(name, folder))
    if isinstance(outcome, CosimError):
        raise outcome
