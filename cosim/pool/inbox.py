"""Queue of jobs for a running pool."""

from __future__ import annotations

import queue
from collections.abc import Iterator

from cosim.closing import Closing
from cosim.pool.job import Numbered


class Inbox(Closing):
    """Iterable that waits for jobs until it is closed."""

    def __init__(self) -> None:
        self.jobs: queue.SimpleQueue[Numbered | None] = queue.SimpleQueue()

    def put(self, job: Numbered) -> None:
        """Add an entry."""
        self.jobs.put(job)

    def __iter__(self) -> Iterator[Numbered]:
        return iter(self.jobs.get, None)

    def close(self) -> None:
        """End the iteration and wake all waiting threads."""
        self.jobs.put(None)
