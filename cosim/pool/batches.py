"""Batches of runs for remote workers, and their outcomes: complete, partial or lost."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator, Sequence

from cosim.pool.job import Finished, Numbered, Outcome, WorkerError

BATCH_TIME = 1.0
"""Time after which an unfinished batch is returned, s; long compared with the cost of sending one."""
MAX_RUNS = 100
"""Maximum runs of a batch."""
Batch = tuple[Numbered, ...]


class Batches:
    """Jobs with their numbers in batches that take about `BATCH_TIME`; no job is lost or done twice.

    A batch can be returned unchanged (`put_back`), in part (`finish`), or be lost with its worker (`lose`).
    The run that ended the worker is then unknown, so each is repeated in a batch of its own.
    """

    def __init__(self, jobs: Iterator[Numbered]) -> None:
        self.jobs = jobs
        self.waiting: deque[Numbered] = deque()
        self.suspects: deque[Numbered] = deque()
        self.suspected: set[int] = set()
        self.size = 1
        self.finished = 0

    def take(self) -> Batch:
        """Next batch; empty if there is none."""
        if self.suspects:
            return (self.suspects.popleft(),)
        returned = (self.waiting.popleft() for _ in range(len(self.waiting)))
        return tuple(itertools.islice(itertools.chain(returned, self.jobs), self.size))

    def finish(self, batch: Batch, outcomes: Sequence[Outcome]) -> list[Finished]:
        """Pair the outcomes of the first runs of a batch with their numbers; queue the others again."""
        rest = batch[len(outcomes) :]
        self.waiting.extendleft(reversed(rest))
        if rest:
            self.size = max(1, len(outcomes))
        elif len(batch) == self.size:
            self.size = min(2 * self.size, MAX_RUNS)
        self.finished += len(outcomes)
        return [(number, outcome) for (number, _), outcome in zip(batch, outcomes, strict=False)]

    def put_back(self, batch: Batch) -> None:
        """Queue a batch with unknown state again."""
        for job in reversed(batch):
            (self.suspects if job[0] in self.suspected else self.waiting).appendleft(job)

    def lose(self, batch: Batch, worker: str) -> list[Finished]:
        """Queue a batch of a lost worker again; a run that lost two workers is not repeated."""
        given_up: list[Finished] = []
        for number, job in batch:
            if number in self.suspected:
                text = f"the Dask worker `{worker}` was lost during the run, as was the worker before"
                given_up.append((number, WorkerError("lost", text, "Repeat it with `--again`.")))
            else:
                self.suspected.add(number)
                self.suspects.append((number, job))
        self.finished += len(given_up)
        return given_up
