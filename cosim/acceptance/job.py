"""A run whose worker writes the result and the plot, so that the trace is not transferred."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from cosim.loop.result import Result
from cosim.pool.job import Job, WorkerContext


@dataclass(frozen=True)
class RecordedJob(Job):
    """A `Job` that writes its result and plot into files; None writes nothing."""

    json: Path | None = None
    plot: Path | None = None

    @property
    def draws(self) -> bool:
        """Whether the run is plotted."""
        return self.plot is not None

    def run(self, context: WorkerContext) -> Result:
        """Run the scenario once and write its files; return the result without its trace."""
        if self.draws:
            self.session(context).check_drawn()
        result = super().run(context)
        self.leave(result, context)
        return dataclasses.replace(result, trace=None)

    def leave(self, result: Result, context: WorkerContext) -> None:
        """Write the files of a run."""
        if self.plot is not None:
            from cosim.show import plot

            plot.save(self.scenario, result, self.plot)
        if self.json is not None:
            result.save_json(self.json)
