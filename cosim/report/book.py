"""The HTML report: runs scenarios and studies and writes their results into one file."""

from __future__ import annotations

import base64
import json
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.progress import MofNCompleteColumn

from cosim.acceptance import runner
from cosim.acceptance.job import RecordedJob
from cosim.errors import CosimError
from cosim.report import page, sweeps
from cosim.report.job import ToldJob, VideoJob
from cosim.report.sections import Chapter
from cosim.show.bar import bar
from cosim.writing import check_text, whole

TITLE = "Closed-loop results"
"""Default title of a report."""
ENDINGS = (".html", ".htm")
MAX_VIDEO = 1_000_000
"""Maximum bytes of a video in a report."""
BEGINNING = re.compile(rb'\s*<!doctype html>.*<meta name="generator" content="cosim report">', re.DOTALL)
"""Start of a report file."""


@dataclass(frozen=True)
class Contents:
    """Content of a report.

    Parameters
    ----------
    title
        Its title.
    scenarios
        Names and files of scenarios to run.
    studies
        Files of studies; only missing runs are executed.
    documents
        Markdown files.
    videos
        Whether to make a video of the first successful scenario of each controller.
    """

    title: str
    scenarios: Sequence[str]
    studies: Sequence[Path] = ()
    documents: Sequence[Path] = ()
    videos: bool = True


def check(option: str, file: Path) -> None:
    """Check before long runs that the report can be made and written.

    Raises
    ------
    CosimError
        A package is missing, the folder does not exist, or the file is not a report.
    """
    page.check()
    if file.suffix not in ENDINGS:
        raise CosimError(f"cannot write a report to `{file}`", "Use a name that ends in `.html`.")
    check_text(option, file, "an HTML report", BEGINNING)


@dataclass(frozen=True)
class Written:
    """Outcomes of the scenarios of a report, and whether each study passed."""

    scenarios: runner.Outcomes
    studies: Sequence[bool | None]


def write(contents: Contents, options: runner.RunOptions, file: Path) -> Written:
    """Run the scenarios and studies of a report and write it.

    Raises
    ------
    CosimError
        As for `check`; a document or study cannot be read; no worker can be started.
    """
    documents = [page.document(document) for document in contents.documents]
    for each in contents.studies:
        sweeps.check(each)
    found, chapters = run_scenarios(contents, options)
    swept = [
        sweeps.section(each, options.workers, options.engine, options.quiet) for each in contents.studies
    ]
    errors = [
        {"name": name, "message": outcome.message, "hint": outcome.hint}
        for name, outcome in found.items()
        if isinstance(outcome, CosimError)
    ]
    content = page.text(contents.title, chapters, errors, swept, documents)
    with whole(file) as partial:
        partial.write_text(content, encoding="utf-8")
    return Written(found, [sweep["passed"] for sweep in swept])


def run_scenarios(contents: Contents, options: runner.RunOptions) -> tuple[runner.Outcomes, list[Chapter]]:
    """Run the scenarios; return the outcomes, and the chapters of the successful ones."""
    if not contents.scenarios:
        return {}, []
    with tempfile.TemporaryDirectory(prefix="cosim-report-") as scratch:
        jobs: dict[str, ToldJob] = {}

        def chapter_job(name: str, job: RecordedJob) -> RecordedJob:
            place = Path(scratch, f"{len(jobs)}.json")
            jobs[name] = ToldJob(**{**vars(job), "keep_trace": True}, chapter=place)
            return jobs[name]

        found = runner.run(contents.scenarios, options, chapter_job)
        chapters = {
            name: json.loads(jobs[name].chapter.read_text(encoding="utf-8"))
            for name, outcome in found.items()
            if not isinstance(outcome, CosimError)
        }
        if contents.videos:
            first = {loop(name): name for name in reversed(chapters)}.values()
            for name, video in videos_of({name: jobs[name] for name in first}, options):
                chapters[name] |= video
        return found, list(chapters.values())


def videos_of(jobs: Mapping[str, ToldJob], options: runner.RunOptions) -> Iterator[tuple[str, Chapter]]:
    """Make videos of runs; yield the part of each chapter: the video, or the reason for its absence."""
    videos = {
        name: VideoJob(job.scenario, job.seed, job.engine, video=job.chapter.with_suffix(".mp4"))
        for name, job in jobs.items()
    }
    with bar(options.quiet, MofNCompleteColumn()) as shown:
        task: Any = None if shown is None else shown.add_task("videos", total=len(videos))
        for name, outcome in runner.outcomes(videos, options):
            if shown is not None:
                shown.advance(task)
            if isinstance(outcome, CosimError):
                yield name, {"no_video": str(outcome)}
            else:
                yield name, shown_video(videos[name].video)


def shown_video(video: Path) -> Chapter:
    """Video and picture of a chapter; only the picture if the video is too large."""
    files = (video, video.with_suffix(".jpg"))
    encoded, still = (base64.b64encode(file.read_bytes()).decode() for file in files)
    size = video.stat().st_size
    if size > MAX_VIDEO:
        reason = f"it has {size / 1e6:.2g} MB, the limit is {MAX_VIDEO / 1e6:g} MB"
        return {"still": still, "no_video": f"{reason}\nhint: Make it with `cosim video`."}
    return {"still": still, "video": encoded}


def loop(name: str) -> str:
    """Name of the closed loop of a scenario."""
    return name.partition("/")[0]
