"""Where a command does what runs foreign code: a worker process under supervision, or on demand its own."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

from cosim import interrupts
from cosim.pool.limits import Limits, isolates
from cosim.pool.supervisor import Worker

Do = Callable[..., Any]
"""Does a task, told the steps done if there is a watcher; the outcome is a `CosimError` if it could not."""
ahead: list[Worker] = []
"""The worker that was started before there is a place for it."""


@contextlib.contextmanager
def started_ahead() -> Iterator[None]:
    """Start the process of the first place that needs one, whose imports take as long as those of a command.

    One that no place took ends with the block.
    """
    with contextlib.ExitStack() as stack:
        # a place that finds none starts its own, and tells what hinders it
        with contextlib.suppress(OSError):
            if isolates():
                worker = stack.enter_context(Worker(Limits(), relay=True))
                worker.prepare()
                ahead.append(worker)
        try:
            yield
        finally:
            ahead.clear()


@contextlib.contextmanager
def place(limits: Limits | None) -> Iterator[Do]:
    """Place for one task after the other.

    Parameters
    ----------
    limits
        What each may take; None does them in this process, which nothing protects from them.
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
