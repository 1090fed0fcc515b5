"""The command `cosim sweep`, from the study file to the files in the folder of results."""

from __future__ import annotations

import contextlib
import functools
import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from rich.console import RenderableType

from cosim import paths
from cosim.errors import CosimError
from cosim.loop import engines
from cosim.loop.reference import Progress
from cosim.pool import cluster, local
from cosim.pool.limits import processors
from cosim.show.bar import bar
from cosim.show.console import ProgressLines
from cosim.show.figure import plots_requested
from cosim.sweep import influence, study, summary_tables
from cosim.sweep.check import check_charts
from cosim.sweep.export import save_csv, save_parquet
from cosim.sweep.plan import Plan, part_of
from cosim.sweep.runner import Observer, Pool, merge, merge_traces, pending, save_traces, sweep, worst
from cosim.sweep.store import DONE, Row, Store, opened, study_of
from cosim.sweep.summary import Summary, summarize
from cosim.warned import once

log = logging.getLogger("cosim")
T = TypeVar("T")


@dataclass(frozen=True)
class Options:
    """Options of the command, as in `cosim.sweep`; `merged` are folders of parts, whose runs are complete."""

    file: Path
    out: str | Path | None = None
    workers: int | None = None
    cluster: str | None = None
    engine: str = "native"
    again: bool = False
    plots: bool = True
    quiet: bool = False
    traces: bool = True
    part: str = ""
    merged: tuple[Path, ...] = ()

    def __post_init__(self) -> None:
        """Reject an empty address: the runs would be executed here."""
        if self.cluster == "":
            raise CosimError("`--cluster` is empty", "Omit it to run on this machine.")

    @property
    def default(self) -> str:
        """Default folder; parts that run at the same time have one each."""
        first, count = part_of(self.part)
        return f"{self.file.stem}.{first + 1}-of-{count}.sweep" if self.part else f"{self.file.stem}.sweep"


def execute(options: Options) -> tuple[Summary, RenderableType]:
    """Continue a study as `run_study`; return the summary and its tables."""

    def tables(plan: Plan, store: Store, found: Summary) -> tuple[Summary, RenderableType]:
        return found, summary_tables.tables(plan, found, worst(plan, found))

    return run_study(options, tables)


@once()
def run_study(options: Options, take: Callable[[Plan, Store, Summary], T]) -> T:
    """Continue a study and write its summary; return the result of `take`.

    Raises
    ------
    CosimError
        The study is wrong, the folder cannot be written, no worker can be started, or plots fail.
    KeyboardInterrupt
        After the summary of the completed runs was written.
    """
    with planning(options) as observe:
        loaded = study.load(paths.find_study(str(options.file)))
        plan = Plan(loaded, engines.checked(options.engine), observe, options.part)
    check_charts(plan)
    options = replace(options, plots=plots_requested(options.plots))
    with opened(loaded.file, options.out, options.default) as store:
        try:
            if options.merged:
                merge(plan, store, options.merged)
            else:
                with progress(plan, store, options) as observe:
                    sweep(plan, store, pool_of(plan, options), observe, options.again)
        finally:
            found = summarize(plan, store)
            write_summary(plan, found, store.folder, options.plots)
        merge_traces(plan, store.folder, found, options.merged)
        if options.traces:
            save_traces(plan, store, found, pool_of(plan, options), options.plots)
        return take(plan, store, found)


def of_parts(folders: Sequence[Path]) -> Path:
    """Study of the folders of its parts.

    Raises
    ------
    CosimError
        There is no folder, one does not name its study, or two have different studies.
    """
    found: dict[Path, str] = {}
    for folder in folders:
        file = study_of(folder)
        if file is None or not paths.is_file(file):
            problem = f"`{paths.shown(folder)}` is not the folder of a sweep, or its study is not there"
            raise CosimError(problem, "Put it where it was written, relative to the study.")
        found.setdefault(paths.resolved(file), f"`{paths.shown(folder)}` holds `{paths.shown(file)}`")
    if len(found) != 1:
        problem = "the folders have several studies: " + ", ".join(found.values())
        raise CosimError(problem if found else "`merge` has no folder", "Give the folders of one study.")
    return next(iter(found))


def write_summary(plan: Plan, found: Summary, folder: Path, plots: bool) -> None:
    """Write tables and plots of the existing rows."""
    save_csv(found.columns, folder / "summary.csv")
    save_parquet(found.columns, folder / "summary.parquet")
    if plots and found.results:
        summary_tables.save_plots(plan, found, folder / "summary.svg")
    if plots and found.influences:
        influence.save_plots(
            found.influences, plan.study.title or plan.study.name, folder / "sensitivity.svg"
        )


def pool_of(plan: Plan, options: Options) -> Pool:
    """Pool of the runs."""
    limits = plan.study.limits.of_workers()
    if options.cluster is not None:
        return functools.partial(cluster.outcomes, address=options.cluster, limits=limits)
    workers = options.workers or processors()
    return functools.partial(local.outcomes, workers=min(workers, len(plan.numbers)), limits=limits)


@contextlib.contextmanager
def planning(options: Options) -> Iterator[Progress | None]:
    """Progress of the checks before the first run."""
    title = f"{options.file.stem}, planning"
    with bar(options.quiet, "{task.percentage:>3.0f} %") as shown:
        if shown is None:
            yield None if options.quiet else ProgressLines(title)
            return
        task = shown.add_task(title)
        yield lambda done, total: shown.update(task, completed=done, total=total)


@contextlib.contextmanager
def progress(plan: Plan, store: Store, options: Options) -> Iterator[Observer]:
    """Bar on stderr with rate and remaining time; periodic lines if that is not a terminal."""
    from rich.progress import MofNCompleteColumn

    counted = "{task.fields[failed]} failed, {task.fields[lost]} without result, {task.fields[rate]}"
    with bar(options.quiet, MofNCompleteColumn(), counted) as shown:
        if options.quiet:
            yield lambda row: None
            return
        total = len(plan.numbers)
        done = total - len(pending(plan, store, options.again))
        counts = {"done": done, "failed": 0, "lost": 0}
        if shown is None:
            lines = ProgressLines(plan.study.name)
            lines(done, total)
        else:
            task = shown.add_task(plan.study.name, True, total, done, failed=0, lost=0, rate="")

        def observe(row: Row) -> None:
            counts["done"] += 1
            counts["failed"] += row["status"] == "failed"
            counts["lost"] += row["status"] not in DONE
            if shown is None:
                note = f"{counts['failed']} failed, {counts['lost']} without result"
                lines(counts["done"], total, f"{counts['done']} of {total} runs, {note}")
                return
            speed = shown.tasks[0].speed
            rate = f"{speed:.3g} runs/s" if speed else ""
            shown.update(
                task, completed=counts["done"], rate=rate, failed=counts["failed"], lost=counts["lost"]
            )

        yield observe
