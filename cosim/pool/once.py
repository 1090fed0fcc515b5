"""Execution of foreign code by a command: in a supervised worker process, or in its own on request."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

from cosim import interrupts
from cosim.errors import CosimError
from cosim.pool.limits import Limits
from cosim.pool.supervisor import Worker

Do = Callable[..., Any]
"""Executes a task with optional progress; the outcome is a `CosimError` if it failed."""
ahead: list[Worker] = []
"""The worker that was started in advance."""


@contextlib.contextmanager
def started_ahead() -> Iterator[None]:
    """Start a worker process in advance, because its imports take as long as those of a command.

    An unused process ends with the block.
    """
    with contextlib.ExitStack() as stack:
        # a runner without it starts its own process and reports errors
        with contextlib.suppress(CosimError):
            worker = stack.enter_context(Worker(Limits(), relay=True))
            worker.prepare()
            ahead.append(worker)
        try:
            yield
        finally:
            ahead.clear()


@contextlib.contextmanager
def place(limits: Limits | None) -> Iterator[Do]:
    """Runner for consecutive tasks.

    Parameters
    ----------
    limits
        Limits of each task; None executes them in this process, without protection.
    """
    if limits is not None:
        with ahead.pop() if ahead else Worker(limits, relay=True) as worker:
            worker.limits = limits
            worker.prepare()
            yield worker.call
        return
    with interrupts.handled_by(interrupts.quit_at_once):
        from cosim.pool.worker import JobRunner

    with interrupts.second_ends_all(), JobRunner() as runner:
        yield runner.call
