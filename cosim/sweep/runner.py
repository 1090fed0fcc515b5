"""A sweep: executes the missing runs of a study in parallel and writes their rows into a folder."""

from __future__ import annotations

import contextlib
import logging
import math
import shutil
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from cosim import paths
from cosim.errors import CosimError
from cosim.loop.result import Result
from cosim.pool.job import Finished, Numbered, Outcome
from cosim.show import plot
from cosim.study.run import Run
from cosim.study.store import DONE, TROUBLES, Row, Store, existing, row_of
from cosim.sweep.plan import Plan
from cosim.sweep.summary import Summary
from cosim.writing import whole

log = logging.getLogger("cosim")
Pool = Callable[[Iterable[Numbered]], Generator[Finished]]
"""Runs jobs on worker processes and yields their outcomes in order of completion."""
TRACES, ENDINGS = "traces", (".npz", ".svg")
MAX_PLOTS = 3
"""Maximum plots of the worst runs: a plot takes longer than a run."""
Observer = Callable[[Row], None]
"""Called with every new row."""


def sweep(plan: Plan, store: Store, pool: Pool, observe: Observer, again: bool = False) -> None:
    """Execute the runs without a row; evaluate the others again if the criteria changed.

    After any interruption, such as Ctrl-C, the written rows remain and the next call continues from them.
    `again` also repeats runs without a result.
    """
    for number in plan.different():
        store.refresh(run := plan.runs[number], plan.criteria(run))
    for run, outcome in outcomes(plan, pending(plan, store, again), pool, keep_trace=False):
        row = row_of(run, outcome, plan.criteria(run))
        store.append(row)
        observe(row)


def pending(plan: Plan, store: Store, again: bool) -> list[int]:
    """List the numbers of the missing runs, each hash once."""
    done = DONE if again else (*DONE, *TROUBLES)
    return [number for number in plan.different() if store.status(plan.runs.hash(number)) not in done]


def outcomes(
    plan: Plan, numbers: Iterable[int], pool: Pool, keep_trace: bool
) -> Iterator[tuple[Run, Outcome]]:
    """Yield runs with their outcomes in order of completion; scenarios are built on demand."""
    jobs = ((number, plan.job(plan.runs[number], keep_trace)) for number in numbers)
    if not keep_trace:
        # an error in a criterion must not become the row of a run that does not depend on it
        jobs = ((number, replace(job, scenario=replace(job.scenario, criterion=()))) for number, job in jobs)
    with contextlib.closing(pool(jobs)) as done:
        for number, outcome in done:
            yield plan.runs[number], outcome


def save_traces(plan: Plan, store: Store, found: Summary, pool: Pool, plots: bool) -> None:
    """Repeat the failed and the worst runs, save their traces and plot the worst; existing files stay."""
    drawn = worst(plan, found)[:MAX_PLOTS] if plots else []
    files = trace_files(plan, store.folder, found)
    missing = [number for number, file in files.items() if not file.exists()]
    if not missing:
        return
    make(store.folder / TRACES)
    for run, outcome in outcomes(plan, missing, pool, keep_trace=True):
        before = store.row(run, ())
        if not isinstance(outcome, Result) or before is None:
            log.warning("run %d could not be repeated for its trace: %s", run.number, outcome)
            continue
        if row_of(run, outcome)["metrics"] != before["metrics"]:
            log.warning("run %d gives other results when it is repeated: it is not deterministic", run.number)
        file = files[run.number]
        outcome.save_trace(file)
        if run.number in drawn:
            try:
                plot.save(plan.job(run).scenario, outcome, file.with_suffix(".svg"))
            except CosimError as error:
                log.warning("run %d is not plotted: %s", run.number, error)


def merge(plan: Plan, store: Store, folders: Iterable[Path]) -> None:
    """Copy the rows of several folders, in the order of the runs; a result replaces a run without one."""
    with contextlib.ExitStack() as stack:
        parts = [stack.enter_context(existing(folder)) for folder in folders]
        for number in plan.different():
            run = plan.runs[number]
            rows = [row for part in parts if (row := part.row(run, plan.criteria(run)))]
            if rows and store.status(run.hash) not in DONE:
                store.append(min(rows, key=lambda row: row["status"] in TROUBLES))
    if not store.positions:
        problem = f"the folders hold no run of {plan.origin} as it is now"
        raise CosimError(problem, "Merge with the study, FMUs, plants and versions that made them.")


def merge_traces(plan: Plan, folder: Path, found: Summary, folders: Iterable[Path]) -> None:
    """Copy traces and plots that a sweep in one folder would have: the parts have at least these."""
    for name in (file.stem for file in trace_files(plan, folder, found).values()):
        for source in (part / TRACES / f"{name}{ending}" for part in folders for ending in ENDINGS):
            if source.is_file():
                make(folder / TRACES)
                with whole(folder / TRACES / source.name) as partial:
                    shutil.copyfile(source, partial)


def trace_files(plan: Plan, folder: Path, found: Summary) -> dict[int, Path]:
    """Files of the traces by the numbers of their runs: of the first that failed, and of the worst."""
    pairs = zip(found.columns["run"], found.columns["status"], strict=True)
    failed = [number for number, status in pairs if status == "failed"]
    chosen = dict.fromkeys([*failed[: plan.study.traces.failed], *worst(plan, found)])
    return {number: folder / TRACES / f"{number:06d}-{plan.runs.hash(number)[:8]}.npz" for number in chosen}


def make(folder: Path) -> None:
    """Make the folder of the traces."""
    try:
        folder.mkdir(exist_ok=True)
    except FileExistsError:
        raise CosimError(f"cannot write traces: `{paths.shown(folder)}` is not a folder") from None
    except OSError as error:
        problem = f"cannot write traces to `{paths.shown(folder)}`: {error.strerror or error}"
        raise CosimError(problem) from None


def worst(plan: Plan, found: Summary) -> list[int]:
    """Numbers of the worst runs by the metric of `traces`, the worst first; NaN is worse than anything."""
    traces = plan.study.traces
    if not traces.metric:
        return []
    sign = 1.0 if traces.direction == "large" else -1.0
    pairs = zip(found.columns["run"], found.columns[f"metric.{traces.metric}"], strict=True)
    values = {number: sign * value for number, value in pairs if value is not None}
    badness = {number: math.inf if math.isnan(value) else value for number, value in values.items()}
    return sorted(badness, key=lambda number: -badness[number])[: traces.worst]
