"""`cosim report`: runs scenarios and studies and writes their results into one HTML file."""

from __future__ import annotations

import base64
import json
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.progress import MofNCompleteColumn

from cosim.acceptance import runner
from cosim.acceptance.job import RecordedJob
from cosim.errors import CosimError
from cosim.report import page, study_section
from cosim.report.job import SectionJob, VideoJob
from cosim.report.page import Section
from cosim.show.bar import bar
from cosim.writing import check_text, write

TITLE = "Closed-loop results"
"""Default title of a report."""
ENDINGS = (".html", ".htm")
MAX_VIDEO = 1_000_000
"""Maximum bytes of a video in a report."""
BEGINNING = re.compile(rb'\s*<!doctype html>.*<meta name="generator" content="cosim report">', re.DOTALL)
"""Start of a report file."""


@dataclass(frozen=True)
class Contents:
    """Content of a report: scenarios by name or file, files of studies and Markdown documents.

    All scenarios run, of a study only the missing runs. `videos` adds a video of the first successful
    scenario of each controller.
    """

    title: str
    scenarios: Sequence[str]
    studies: Sequence[Path] = ()
    documents: Sequence[Path] = ()
    videos: bool = True


def check(option: str, file: Path) -> None:
    """Check before long runs that the report can be made, and written to a file."""
    page.check()
    if file.suffix not in ENDINGS:
        raise CosimError(f"cannot write a report to `{file}`", "Use a name that ends in `.html`.")
    check_text(option, file, "an HTML report", BEGINNING)


def write_report(
    contents: Contents, options: runner.RunOptions, file: Path
) -> tuple[runner.Outcomes, list[bool | None]]:
    """Write a report of new runs; return the outcomes of the scenarios, and whether each study passed."""
    documents = [page.document(document) for document in contents.documents]
    for each in contents.studies:
        study_section.check(each)
    outcomes, scenarios = run_scenarios(contents, options)
    studies = [
        study_section.run(each, options.workers, options.engine, options.quiet) for each in contents.studies
    ]
    errors = [
        {"name": name, "message": outcome.message, "hint": outcome.hint}
        for name, outcome in outcomes.items()
        if isinstance(outcome, CosimError)
    ]
    write(page.text(contents.title, scenarios, errors, studies, documents), file)
    return outcomes, [study["passed"] for study in studies]


def run_scenarios(contents: Contents, options: runner.RunOptions) -> tuple[runner.Outcomes, list[Section]]:
    """Run the scenarios; return the outcomes, and the sections of the successful ones."""
    if not contents.scenarios:
        return {}, []
    with tempfile.TemporaryDirectory(prefix="cosim-report-") as scratch:
        jobs: dict[str, SectionJob] = {}

        def section_job(name: str, job: RecordedJob) -> RecordedJob:
            file = Path(scratch, f"{len(jobs)}.json")
            jobs[name] = SectionJob(**{**vars(job), "keep_trace": True}, section=file)
            return jobs[name]

        outcomes = runner.run(contents.scenarios, options, section_job)
        sections = {
            name: json.loads(jobs[name].section.read_text(encoding="utf-8"))
            for name, outcome in outcomes.items()
            if not isinstance(outcome, CosimError)
        }
        if contents.videos:
            first = {name.partition("/")[0]: name for name in reversed(sections)}.values()
            for name, video in make_videos({name: jobs[name] for name in first}, options):
                sections[name] |= video
        return outcomes, list(sections.values())


def make_videos(jobs: Mapping[str, SectionJob], options: runner.RunOptions) -> Iterator[tuple[str, Section]]:
    """Make videos of runs; yield the part of each section: the video, or the reason for its absence."""
    videos = {
        name: VideoJob(job.scenario, job.seed, job.engine, video=job.section.with_suffix(".mp4"))
        for name, job in jobs.items()
    }
    with bar(options.quiet, MofNCompleteColumn()) as progress:
        outcomes = runner.outcomes(videos, options)
        shown = progress.track(outcomes, len(videos), description="videos") if progress else outcomes
        for name, outcome in shown:
            if isinstance(outcome, CosimError):
                yield name, {"no_video": str(outcome)}
            else:
                yield name, encoded_video(videos[name].video)


def encoded_video(video: Path) -> Section:
    """Video and picture of a section; only the picture if the video is too large."""
    files = (video, video.with_suffix(".jpg"))
    encoded, picture = (base64.b64encode(file.read_bytes()).decode() for file in files)
    size = video.stat().st_size
    if size > MAX_VIDEO:
        reason = f"it has {size / 1e6:.2g} MB, the limit is {MAX_VIDEO / 1e6:g} MB"
        return {"picture": picture, "no_video": f"{reason}\nhint: Make it with `cosim video`."}
    return {"picture": picture, "video": encoded}
