"""The command `cosim sweep`, from the study file to the files in the folder of results."""

from __future__ import annotations

import contextlib
import functools
from collections import Counter
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
from cosim.study.store import TROUBLES, Row, Store, opened, study_of
from cosim.sweep import sensitivity_tables, study, summary_tables
from cosim.sweep.charts import check_charts
from cosim.sweep.export import save_csv, save_parquet
from cosim.sweep.plan import Plan, part_of
from cosim.sweep.runner import Observer, merge, merge_traces, pending, save_traces, sweep
from cosim.sweep.summary import Summary, summarize
from cosim.warned import once

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
        part = f".{first + 1}-of-{count}" if self.part else ""
        return f"{self.file.stem}{part}.sweep"


def execute(options: Options) -> tuple[Summary, RenderableType]:
    """Continue a study as `run_study`; return the summary and its tables."""
    return run_study(options, lambda plan, _, found: (found, summary_tables.of_study(plan, found)))


@once()
def run_study(options: Options, take: Callable[[Plan, Store, Summary], T]) -> T:
    """Continue a study and write its summary, also after Ctrl-C; return the result of `take`."""
    with progress_bar(f"{options.file.stem}, planning", options.quiet) as observe:
        loaded = study.load(paths.find_study(str(options.file)))
        plan = Plan(loaded, engines.checked(options.engine), observe, options.part)
    check_charts(plan)
    options = replace(options, plots=plots_requested(options.plots))
    with opened(loaded.file, options.out, options.default) as store:
        workers = min(options.workers or processors(), len(plan.numbers))
        pool = functools.partial(executor.outcomes, workers=workers, limits=loaded.limits.of_workers())
        try:
            if options.merged:
                merge(plan, store, options.merged)
            else:
                with progress(plan, store, options) as observe:
                    sweep(plan, store, pool, observe, options.again)
        finally:
            found = summarize(plan, store)
            write_summary(plan, found, store.folder, options.plots)
        merge_traces(plan, store.folder, found, options.merged)
        if options.traces:
            save_traces(plan, store, found, pool, options.plots)
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


@contextlib.contextmanager
def progress(plan: Plan, store: Store, options: Options) -> Iterator[Observer]:
    """Bar on stderr with rate and remaining time; periodic lines if that is not a terminal."""
    from rich.progress import MofNCompleteColumn

    with bar(options.quiet, MofNCompleteColumn(), "{task.fields[note]}") as shown:
        if options.quiet:
            yield lambda row: None
            return
        name, total = plan.study.name, len(plan.numbers)
        before = total - len(pending(plan, store, options.again))
        counts: Counter[str] = Counter()
        if shown is None:
            lines = ProgressLines(name)
            lines(before, total)
        else:
            task = shown.add_task(name, True, total, before, note="")

        def observe(row: Row) -> None:
            counts[row["status"]] += 1
            done, lost = before + counts.total(), sum(counts[status] for status in TROUBLES)
            note = f"{counts['failed']} failed, {lost} without result"
            if shown is None:
                lines(done, total, f"{done} of {total} runs, {note}")
            else:
                note += f", {shown.tasks[0].speed or 0.0:.3g} runs/s"
                shown.update(task, completed=done, note=note)

        yield observe
