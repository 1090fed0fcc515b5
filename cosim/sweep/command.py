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
from cosim.pool import executor
from cosim.pool.limits import processors
from cosim.show.bar import bar
from cosim.show.console import ProgressLines, progress_bar
from cosim.show.figure import plots_requested
from cosim.study.store import DONE, Row, Store, opened, study_of
from cosim.sweep import sensitivity_tables, study, summary_tables
from cosim.sweep.charts import check_charts
from cosim.sweep.export import save_csv, save_parquet
from cosim.sweep.plan import Plan, part_of
from cosim.sweep.runner import Observer, Pool, merge, merge_traces, pending, save_traces, sweep, worst
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
    engine: str = "native"
    again: bool = False
    plots: bool = True
    quiet: bool = False
    traces: bool = True
    part: str = ""
    merged: tuple[Path, ...] = ()

    @property
    def default(self) -> str:
        """Default folder; parts that run at the same time have one each."""
        first, count = part_of(self.part)
        return f"{self.file.stem}.{first + 1}-of-{count}.sweep" if self.part else f"{self.file.stem}.sweep"


def execute(options: Options) -> tuple[Summary, RenderableType]:
    """Continue a study as `run_study`; return the summary and its tables."""

    def tables(plan: Plan, store: Store, found: Summary) -> tuple[Summary, RenderableType]:
        return found, summary_tables.of_study(plan, found, worst(plan, found))

    return run_study(options, tables)


@once()
def run_study(options: Options, take: Callable[[Plan, Store, Summary], T]) -> T:
    """Continue a study and write its summary, also after Ctrl-C; return the result of `take`."""
    with progress_bar(f"{options.file.stem}, planning", options.quiet) as observe:
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
    """Study of the folders of its parts, which must be the same."""
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
    if plots and found.sensitivities:
        sensitivity_tables.save_plots(found.sensitivities, plan.study.full_title, folder / "sensitivity.svg")


def pool_of(plan: Plan, options: Options) -> Pool:
    """Pool of the runs."""
    limits = plan.study.limits.of_workers()
    workers = options.workers or processors()
    return functools.partial(executor.outcomes, workers=min(workers, len(plan.numbers)), limits=limits)


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
            done, failed, lost = counts.values()
            if shown is None:
                lines(done, total, f"{done} of {total} runs, {failed} failed, {lost} without result")
                return
            speed = shown.tasks[0].speed
            rate = f"{speed:.3g} runs/s" if speed else ""
            shown.update(task, completed=done, rate=rate, failed=failed, lost=lost)

        yield observe
