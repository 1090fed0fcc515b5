"""The runs of a search, on worker processes that are kept between batches, within the limits of the file."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from cosim.closing import Closing
from cosim.formatting.strict import plain
from cosim.loop.engines import Engine
from cosim.loop.result import Result
from cosim.optimize.objective import MISFIT, misfit
from cosim.optimize.variants import Variants
from cosim.pool import executor
from cosim.pool.job import Outcome
from cosim.pool.limits import processors
from cosim.study.run import Run
from cosim.study.store import TROUBLES, Row, Store, row_of


@dataclass(frozen=True)
class SearchOptions:
    """Options of a search: worker processes, engine, and repetition of runs without a result."""

    workers: int | None = None
    engine: Engine = "native"
    again: bool = False


class Runner(Closing):
    """Executes the runs of a search; starts processes with the first run."""

    def __init__(self, variants: Variants, options: SearchOptions) -> None:
        self.variants, self.options = variants, options
        most = variants.problem.search.batch * len(variants.seeds)
        count = min(options.workers or processors(), most)
        self.jobs = executor.JobQueue()
        self.outcomes = executor.outcomes(self.jobs, count, variants.problem.limits.of_workers())

    def do(self, runs: Sequence[Run], store: Store) -> None:
        """Execute the runs without a row, each once; a row is written at the end of each run."""
        redone = ("", *TROUBLES) if self.options.again else ("",)
        pending = list({run.hash: run for run in runs if store.status(run.hash) in redone}.values())
        for number, run in enumerate(pending):
            self.jobs.put((number, self.variants.job(run, self.options.engine)))
        for number, outcome in itertools.islice(self.outcomes, len(pending)):
            store.append(self.row(pending[number], outcome))

    def row(self, run: Run, outcome: Outcome) -> Row:
        """Row of a run; in a calibration with its distance from the measured trace."""
        row, target = row_of(run, outcome, self.variants.criteria), self.variants.target
        if isinstance(outcome, Result) and target is not None:
            distance = misfit(outcome, target, self.variants.problem.objective.columns)
            row["metrics"] = {**row["metrics"], MISFIT: plain(distance)}
            row["units"] = {**row["units"], MISFIT: "1"}
        return row

    def close(self) -> None:
        """End the worker processes."""
        self.outcomes.close()
