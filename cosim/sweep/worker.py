"""A worker process: takes jobs from a connection one after the other and answers each with its outcome."""

from __future__ import annotations

import dataclasses
import os
import queue
import threading
from dataclasses import dataclass
from multiprocessing.connection import Connection

from cosim.errors import CosimError, FmuError
from cosim.loop.engines import Engine
from cosim.loop.result import Result
from cosim.loop.session import Session
from cosim.scenario.model import Scenario

Outcome = Result | CosimError
"""What became of a run: its result, or why it could not be done."""
READY = "ready"
"""First message of a worker process: everything is imported."""
IDLE = 600.0
"""A worker process that got no job for so long ends, s; the next job starts another one."""


@dataclass(frozen=True)
class Job:
    """One run of a scenario with a seed, by the engine of that name, whose result may keep its trace.

    `fmu` is the SHA-256 that the FMU must have, as far as the name of its extracted folder goes; empty takes
    any.
    """

    scenario: Scenario
    seed: int
    engine: Engine = "native"
    keep_trace: bool = False
    fmu: str = ""


class JobRunner:
    """Runs jobs one after the other; FMU and plant stay open for jobs that share them."""

    def __init__(self) -> None:
        self.session: Session | None = None
        self.wanted: tuple[Scenario, Engine] | None = None

    def run(self, job: Job) -> Outcome:
        """Run one job; after an error the next one gets a fresh FMU and plant."""
        try:
            result = self.opened(job).run(job.seed)
        except CosimError as error:
            self.close()
            return error
        except Exception as error:  # whatever it is, it concerns only this run
            self.close()
            return CosimError(f"the run failed: {type(error).__name__}: {error}")
        return result if job.keep_trace else dataclasses.replace(result, trace=None)

    def opened(self, job: Job) -> Session:
        """Session of the job's scenario; what fits of the one before stays open."""
        if self.session is None or self.wanted != (job.scenario, job.engine):
            self.session = Session(job.scenario, engine=job.engine, previous=self.session)
            self.wanted = job.scenario, job.engine
        folder = self.session.file.folder
        if job.fmu and folder.name != job.fmu[: len(folder.name)]:
            path = self.session.file.path
            raise FmuError(
                f"the FMU `{path}` is not the one the sweep began with", "it was built or copied anew"
            )
        return self.session

    def close(self) -> None:
        """Free the FMU."""
        session, self.session = self.session, None
        if session is not None:
            session.close()


def main(descriptor: int) -> None:
    """Serve the connection until the other side closes it."""
    connection = Connection(descriptor)
    jobs: queue.SimpleQueue[Job] = queue.SimpleQueue()
    threading.Thread(target=listen, args=(connection, jobs), daemon=True).start()
    runner = JobRunner()
    connection.send(READY)
    while True:
        try:
            job = jobs.get(timeout=IDLE)
        except queue.Empty:
            return
        connection.send(runner.run(job))


def listen(connection: Connection, jobs: queue.SimpleQueue[Job]) -> None:
    """Take in jobs; when the other side is gone the process ends at once, even from within a run."""
    try:
        while True:
            jobs.put(connection.recv())
    finally:
        os._exit(0)
