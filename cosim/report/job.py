"""A run that leaves a chapter of the page behind."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from cosim.acceptance.job import RecordedJob
from cosim.errors import CosimError
from cosim.loop.result import Result
from cosim.pool.job import Bench
from cosim.words import strict
from cosim.writing import write


@dataclass(frozen=True)
class ToldJob(RecordedJob):
    """A job whose run is told on a page.

    Parameters
    ----------
    chapter
        Where the chapter is written until the page is made.
    film
        Whether it is filmed, in a run of its own: coordinates are no part of the trace that is judged.
    """

    chapter: Path = Path()
    film: bool = False

    def leave(self, result: Result, bench: Bench) -> None:
        """Write the files of the run, and its chapter."""
        super().leave(result, bench)
        from cosim.report import chapter

        told = chapter.chapter(self.scenario, result, bench.session(self.scenario, self.engine))
        if self.film:
            told |= self.filmed(bench)
        write(strict.line(told), self.chapter)

    def filmed(self, bench: Bench) -> dict[str, object]:
        """Film of the run, or why there is none."""
        from cosim.report import chapter

        loop = dataclasses.replace(self.scenario.loop, record_qpos=True)
        scenario = dataclasses.replace(self.scenario, loop=loop)
        try:
            again = bench.session(scenario, self.engine).run(self.seed)
        except CosimError as error:
            return {"no_film": str(error)}
        return chapter.filmed(scenario, again)
