"""Runs that write parts of the report: the section of a scenario or a video."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from cosim.acceptance.job import RecordedJob
from cosim.formatting import strict
from cosim.loop.result import Result
from cosim.pool.job import Job, WorkerContext
from cosim.writing import write

VIDEO_SIZE = (800, 600)
"""Width and height of a video in the report, pixels."""
VIDEO_SECONDS = 5.0


@dataclass(frozen=True)
class SectionJob(RecordedJob):
    """A `Job` that writes a section of the report to a file, until the report is written."""

    section: Path = Path()

    @property
    def draws(self) -> bool:
        """Whether the run is plotted."""
        return True

    def leave(self, result: Result, context: WorkerContext) -> None:
        """Write the section of the run, and its files."""
        from cosim.report import scenario_section

        section = scenario_section.describe(self.scenario, result, self.session(context))
        write(strict.line(section), self.section)
        super().leave(result, context)


@dataclass(frozen=True)
class VideoJob(Job):
    """A run for a video, in addition to the evaluated one: its trace holds coordinates, and it may fail.

    The picture of the video is next to it, as `.jpg`.
    """

    video: Path = Path()

    def run(self, context: WorkerContext) -> Result:
        """Run the scenario again and make its video, after a check of the required packages."""
        from cosim.replay import motion, renderer, video_file
        from cosim.replay.playback import ReplayOptions

        loop = dataclasses.replace(self.scenario.loop, record_qpos=True)
        scenario = dataclasses.replace(self.scenario, loop=loop)
        session = context.session(scenario, self.engine)
        video_file.check_packages(self.video.suffix)
        renderer.graphics((16, 16)).free()
        result = session.run(self.seed)
        options = ReplayOptions(VIDEO_SIZE, VIDEO_SECONDS)
        video_file.save(motion.of_result(scenario, result), options, self.video)
        self.video.with_suffix(".jpg").write_bytes(video_file.middle_picture(self.video))
        return dataclasses.replace(result, trace=None)
