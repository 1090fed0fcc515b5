"""What `cosim run` does in its worker process, or with `--in-process` in its own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cosim.loop.engines import Engine
    from cosim.loop.result import Result
    from cosim.pool.job import Bench
    from cosim.scenario.model import Scenario


@dataclass(frozen=True)
class Single:
    """One run from the words of a command line.

    Parameters
    ----------
    loop, changes
        The scenario and its overrides, as for `cosim.load`.
    verbose
        Whether the FMU shall log events.
    trace
        Whether the trace is wanted.
    plot
        Plot that will be made of the run, None is none; it is checked before the run.
    """

    loop: str
    changes: tuple[str, ...]
    engine: Engine
    verbose: bool
    trace: bool
    plot: Path | None

    def run(self, bench: Bench) -> tuple[Result, Scenario | None]:
        """Run; returns the result, and the scenario where there is something to plot."""
        from cosim.fmu import stale
        from cosim.scenario.load import load

        scenario = load(self.loop, self.changes)
        session = bench.session(scenario, self.engine, self.verbose)
        stale.warn(scenario.controller.fmu, session.file.path)
        if self.plot is not None:
            from cosim.show import plot

            plot.check(scenario, session.columns, self.plot)
        result = session.run(progress=bench.progress)
        if self.plot is not None:
            return result, scenario
        # what is not shown does not travel
        return replace(result, displays={}, trace=result.trace if self.trace else None), None
