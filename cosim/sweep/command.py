"""What the command `cosim sweep` does, from the study file to the files in the folder of results."""

from __future__ import annotations

import contextlib
import functools
import logging
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import RenderableType

from cosim import paths
from cosim.loop import engines
from cosim.show.bar import bar
from cosim.sweep import cluster, cores, overview, study, supervisor
from cosim.sweep.plan import Plan
from cosim.sweep.runner import Observer, Pool, pending, save_traces, sweep, worst
from cosim.sweep.store import DONE, Row, Store
from cosim.sweep.supervisor import Limits
from cosim.sweep.survey import Survey, save_csv, save_parquet, survey

log = logging.getLogger("cosim")


@dataclass(frozen=True)
class Options:
    """Options of the command.

    Parameters
    ----------
    file
        The study.
    folder
        Folder of the results.
    workers
        Worker processes on this machine; None is one per core.
    cluster
        Address of a Dask scheduler; empty runs on this machine.
    engine
        `native` or `reference`.
    again
        Whether runs without a result are done again.
    plots
        Whether to draw plots, if matplotlib is installed.
    quiet
        No progress bar.
    """

    file: Path
    folder: Path
    workers: int | None = None
    cluster: str = ""
    engine: str = "native"
    again: bool = False
    plots: bool = True
    quiet: bool = False


def execute(options: Options) -> tuple[Survey, RenderableType]:
    """Do what is left of a study and write its summary; returns the survey and its tables.

    Raises
    ------
    CosimError
        The study is wrong, the folder cannot be written, or no worker can be had.
    KeyboardInterrupt
        After the summary of what was done has been written.
    """
    plan = Plan(study.load(paths.find_study(str(options.file))), engines.checked(options.engine))
    with Store(options.folder) as store:
        try:
            with progress(plan, store, options) as observe:
                sweep(plan, store, pool_of(plan, options), observe, options.again)
            save_traces(plan, store, pool_of(plan, options), options.plots)
        finally:
            found = survey(plan, store)
            summarise(plan, store, found, options.plots)
        return found, overview.tables(plan, store, found, worst(plan, store, plan.study.traces.worst))


def summarise(plan: Plan, store: Store, found: Survey, plots: bool) -> None:
    """Write tables and plots of the rows that are there."""
    save_csv(plan, store, store.folder / "summary.csv")
    save_parquet(plan, store, store.folder / "summary.parquet")
    if plots and found.results and overview.can_plot():
        overview.save_plots(plan, store, found, store.folder / "summary.svg")


def pool_of(plan: Plan, options: Options) -> Pool:
    """Where the runs are done."""
    memory = plan.study.limits.memory
    limits = Limits(plan.study.limits.timeout, None if memory is None else 1e6 * memory)
    if options.cluster:
        return functools.partial(cluster.outcomes, address=options.cluster, limits=limits)
    workers = options.workers or cores.available()
    return functools.partial(supervisor.outcomes, workers=min(workers, len(plan.runs)), limits=limits)


@contextlib.contextmanager
def progress(plan: Plan, store: Store, options: Options) -> Iterator[Observer]:
    """Bar on stderr with rate and time left; nothing if that is not a terminal."""
    from rich.progress import MofNCompleteColumn

    counted = "{task.fields[failed]} failed, {task.fields[lost]} without result, {task.fields[rate]}"
    with bar(options.quiet, MofNCompleteColumn(), counted) as shown:
        if shown is None:
            yield lambda row: None
            return
        left = len(pending(plan, store, options.again))
        total = len(plan.runs)
        task = shown.add_task(plan.study.name, True, total, total - left, failed=0, lost=0, rate="")
        counts: dict[str, Any] = {"failed": 0, "lost": 0}

        def observe(row: Row) -> None:
            counts["failed"] += row["status"] == "failed"
            counts["lost"] += row["status"] not in DONE
            speed = shown.tasks[0].speed
            shown.update(task, advance=1, rate=f"{speed:.3g} runs/s" if speed else "", **counts)

        yield observe
