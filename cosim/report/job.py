"""Runs that leave parts of the page behind: a chapter, a film."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from cosim.acceptance.job import RecordedJob
from cosim.formatting import strict
from cosim.loop.result import Result
from cosim.pool.job import Bench, Job
from cosim.writing import write

VIDEO_SIZE = (800, 600)
"""Width and height of a film on the page, pixels."""
VIDEO_SECONDS = 5.0


@dataclass(frozen=True)
class ToldJob(RecordedJob):
    """A job whose run is told on a page.

    Parameters
    ----------
    chapter
        Where the chapter is written until the page is made.
    """

    chapter: Path = Path()

    @property
    def draws(self) -> bool:
        """Whether anything of the run is drawn."""
        return True

    def leave(self, result: Result, bench: Bench) -> None:
        """Write the chapter of the run, and its files."""
        from cosim.report import chapter

        write(strict.line(chapter.chapter(self.scenario, result, self.session(bench))), self.chapter)
        super().leave(result, bench)


@dataclass(frozen=True)
class VideoJob(Job):
    """A run that is filmed, apart from the one that is judged: its trace holds coordinates, and it may fail.

    Parameters
    ----------
    film
        Where the film is written, and a picture of it beside, as `.jpg`.
    """

    video: Path = Path()

    def run(self, bench: Bench) -> Result:
        """Run the scenario once more and film it; what a film needs is looked for before."""
        from cosim.replay import motion, renderer, video_file

        loop = dataclasses.replace(self.scenario.loop, record_qpos=True)
        scenario = dataclasses.replace(self.scenario, loop=loop)
        session = bench.session(scenario, self.engine)
        video_file.check_packages(self.video.suffix)
        renderer.graphics((16, 16)).free()
        result = session.run(self.seed)
        shot = video_file.Shot(VIDEO_SIZE, VIDEO_SECONDS)
        video_file.save(motion.of_result(scenario, result), shot, self.video)
        self.video.with_suffix(".jpg").write_bytes(video_file.still(self.video))
        return dataclasses.replace(result, trace=None)
